//! The delays of a stage's axes, for people and for programs.

use super::together::{Together, TogetherReport};
use crate::text::Table;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::{AxisDelay, MachineDesign, StageDelay};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::show_seconds;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// The parts of each axis's delay, and the remaining mismatch; empty without `[stage]`.
pub(super) fn text(machine: &Machine, design: &MachineDesign) -> String {
    let Some(stage) = &design.stage else {
        return String::new();
    };
    let headings = [
        "axis",
        ">shaper ms",
        ">mode lag ms",
        ">added samples",
        ">total ms",
        ">rounding ns",
    ];
    let mut table = Table::new(&headings);
    for axis in &design.axes {
        let delay = &axis.delay;
        table.row([
            axis.design.name.clone(),
            format!("{:.6}", delay.shaper_s * 1e3),
            format!("{:.6}", delay.mode_lag_s * 1e3),
            format!("{:.4}", delay.added_samples),
            format!("{:.6}", delay.total_s() * 1e3),
            format!("{:.2}", delay.rounding_s * 1e9),
        ]);
    }
    let mut text = format!(
        "\nstage: every axis {:.6} ms late\n{}",
        stage.total_s * 1e3,
        table.text("  ")
    );
    let unit = machine.axes.first().map_or(AxisUnit::default(), |axis| axis.unit);
    let mismatch = show_seconds(stage.mismatch_s, 3);
    let _ = match stage.contour_speed {
        Some(speed) => writeln!(
            text,
            "  mismatch {mismatch}, {} at {}",
            unit.show(stage.mismatch_s * speed, 3),
            unit.show_round(speed, "/s")
        ),
        None => writeln!(text, "  mismatch {mismatch}"),
    };
    text
}

/// `stage` in `design --json` and `report.json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct EqualDelays {
    /// Total delay of every axis, before the coefficients are rounded.
    total_delay_s: f64,
    /// Largest difference between two axes, after rounding.
    mismatch_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    contour_speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mismatch_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    together: Option<Together>,
}

impl EqualDelays {
    pub(super) fn new(stage: &StageDelay, design: &MachineDesign) -> Self {
        Self {
            total_delay_s: stage.total_s,
            mismatch_s: stage.mismatch_s,
            contour_speed: stage.contour_speed,
            mismatch_um: stage.mismatch_um(),
            together: TogetherReport::new(design).map(|together| together.json()),
        }
    }
}

/// `delay` of an axis there: its parts and their sum.
#[derive(Serialize, JsonSchema)]
pub(super) struct Delay {
    shaper_s: f64,
    mode_lag_s: f64,
    added_samples: f64,
    rounding_s: f64,
    total_s: f64,
}

impl Delay {
    pub(super) fn new(delay: &AxisDelay) -> Self {
        Self {
            shaper_s: delay.shaper_s,
            mode_lag_s: delay.mode_lag_s,
            added_samples: delay.added_samples,
            rounding_s: delay.rounding_s,
            total_s: delay.total_s(),
        }
    }
}
