//! The error table of an axis.

use crate::warning::Warning;
use posicast_blocks::stage::StageErrorTable;
use posicast_machine::hardware::{self, Hardware};
use posicast_machine::machine_file::{AxisSection, Machine};
use schemars::JsonSchema;
use serde::Serialize;

/// The table that the hardware makes from the points measured on an axis.
pub(super) struct ErrorTableReport<'a> {
    axis: &'a AxisSection,
    built: StageErrorTable,
}

/// The same in JSON.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "ErrorTable")]
pub struct DesignErrorTable {
    /// What the table corrects: `feedback`, the measured position, or `reference`, the command of the loop.
    pub apply: &'static str,
    /// Number of points of the machine file.
    pub points: usize,
    /// Number of entries of the table.
    pub entries: usize,
    /// Position of the first entry.
    pub first_counts: i32,
    /// Distance of two entries.
    pub spacing_counts: u32,
    /// Largest error of the points.
    pub largest_error_counts: f64,
    /// Largest distance between the table and the points.
    pub departure_counts: f64,
    /// Counts per m or rad.
    #[serde(skip)]
    pub counts_per_si: f64,
}

impl<'a> ErrorTableReport<'a> {
    /// Returns the table of the axis with this index; `None` if it has no table, or there is no stage that could
    /// contain one.
    pub(super) fn new(hardware: &Hardware<'_>, axis: &'a AxisSection, place: usize) -> Option<Self> {
        let stage = hardware.stage().ok().flatten()?;
        let built = stage.of_machine.config.axes.get(place)?.error_table.clone()?;
        Some(Self { axis, built })
    }

    pub(super) fn json(&self) -> DesignErrorTable {
        let (table, counts) = (&self.built.table, self.axis.loop_counts_per_unit());
        let points = self
            .axis
            .error_table
            .as_ref()
            .map_or(&[][..], |section| section.points.as_slice());
        let largest = points
            .iter()
            .fold(0.0, |largest: f64, (_, error)| largest.max(error.abs()));
        DesignErrorTable {
            apply: if self.built.on_measured {
                "feedback"
            } else {
                "reference"
            },
            points: points.len(),
            entries: table.entries().len(),
            first_counts: table.format().first_counts,
            spacing_counts: 1 << table.format().spacing_bits,
            largest_error_counts: largest * counts,
            departure_counts: hardware::error_table_departure_counts(self.axis, table),
            counts_per_si: counts,
        }
    }
}

/// Warns about an error table that is not built because there is no stage.
pub(super) fn not_built(machine: &Machine, hardware: &Hardware<'_>) -> Option<Warning> {
    let has_stage = !matches!(hardware.stage(), Ok(None));
    let mut axes = machine.axes.iter().enumerate();
    let (index, axis) = axes.find(|(_, axis)| axis.error_table.is_some() && !has_stage)?;
    let text = format!(
        "axis {}: its error table is not built, because it is a part of the stage, which needs encoder, PWM, drive and controller on \
         every axis",
        axis.name
    );
    Some(Warning::new(index, "axis.error_table", text))
}
