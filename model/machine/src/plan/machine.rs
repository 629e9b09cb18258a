//! Designs all axes of a machine: from the machine file to tap tables with one common `F`.

use crate::machine_file::{AxisSection, Machine};
use crate::plan::family::{self, TableFamily};
use crate::plan::matching::{self, AxisDelay, StageDelay};
use posicast_shaper::analysis::{
    Insensitivity, insensitivity, residual_vibration, residual_vibration_at, tap_impulses,
};
use posicast_shaper::design::optimal::TogetherDesign;
use posicast_shaper::design::{AxisDesign, DesignError, design_axis, optimal};
use posicast_shaper::digitise::{Digitised, digitise, quantising_error};
use posicast_shaper::mode::Mode;
use posicast_taps::TapTable;

/// The shapers of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineDesign {
    /// Sample rate of the tables in Hz.
    pub sample_hz: f64,
    /// Fraction bits `F` of all coefficients.
    pub coefficient_fraction: u32,
    /// One entry per axis, in the order of the file.
    pub axes: Vec<AxisTables>,
    /// The table families of the axes whose modes move. The nominal table of a family is that of the axis.
    pub families: Vec<TableFamily>,
    /// Remaining difference between the axes' delays, where the file has `[stage]`.
    pub stage: Option<StageDelay>,
    /// The joint design, where the file asks for one.
    pub together: Option<TogetherDesign>,
}

/// The shaper of one axis at its three stages: continuous impulses, real taps, integer taps.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisTables {
    /// The design: impulses in continuous time.
    pub design: AxisDesign,
    /// Real taps of the floating-point design. If the file has `[stage]`, they are delayed like the other axes'.
    pub digitised: Digitised,
    /// Integer taps for the hardware, rounded from the real ones.
    pub table: TapTable,
    /// The parts of the axis's delay.
    pub delay: AxisDelay,
}

/// Residual vibration and insensitivity of an axis's shaper at one of its modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeFigures {
    /// The mode.
    pub mode: Mode,
    /// Tolerance at which `insensitivity` is measured.
    pub tolerance: f64,
    /// Residual vibration of the impulses.
    pub residual: f64,
    /// Insensitivity of the impulses; `None` if `residual` exceeds the tolerance.
    pub insensitivity: Option<Insensitivity>,
    /// Residual vibration of the real taps, referred to the time of the last integer tap: where the last real tap
    /// rounds to zero, the two could not be compared otherwise.
    pub residual_digitised: f64,
    /// Residual vibration of the integer taps: the figure that is guaranteed.
    pub residual_quantised: f64,
}

/// Designs, digitises and quantises the shapers of all axes; with `[stage]` their delays are made equal in between.
///
/// # Errors
/// [`DesignError`] names the axis, what was found, what is allowed and what to do. A shaper that no hardware holds is
/// refused before anything large is allocated.
pub fn design_machine(machine: &Machine) -> Result<MachineDesign, DesignError> {
    let sample_hz = machine.clock.sample_hz;
    let how = machine.fixed_point.digitise;
    let mut designs = Vec::with_capacity(machine.axes.len());
    let mut families = Vec::with_capacity(machine.axes.len());
    let mut made: Vec<AxisDesign> = Vec::with_capacity(machine.axes.len());
    for axis in &machine.axes {
        made.push(design_axis(axis.shaped(), sample_hz)?);
    }
    let together = if machine.stage.is_some_and(|stage| stage.arrive_together) {
        let lags_s: Vec<f64> = machine.axes.iter().map(matching::mode_lag_s).collect();
        optimal::arrive_together(&lags_s, &mut made, sample_hz)?
    } else {
        None
    };
    for (axis, design) in machine.axes.iter().zip(made) {
        let digitised = digitise(&design, how, sample_hz)?;
        designs.push((axis, design, digitised));
        families.push(family::candidates(axis, how, sample_hz)?);
    }
    // The tables of the axes come first, then those of the families: all have one F and one delay.
    let members = families.iter().flat_map(|(candidates, _)| candidates);
    let members = members.map(|candidate| (&candidate.section, &candidate.design, &candidate.digitised));
    let all: Vec<_> = designs
        .iter()
        .map(|(axis, design, digitised)| (*axis, design, digitised))
        .chain(members)
        .collect();
    let digitised: Vec<_> = all.iter().map(|(axis, _, digitised)| (*axis, *digitised)).collect();
    let matched = matching::matched(machine, &digitised)?;
    let shapers = all
        .iter()
        .zip(&matched)
        .map(|((_, design, _), (taps, _))| (*design, taps));
    let rounded = optimal::tables(&shapers.collect::<Vec<_>>(), machine.fixed_point.coefficient_fraction)?;
    let coefficient_fraction = rounded.first().map_or(0, TapTable::coefficient_fraction);
    let tables = all.into_iter().zip(matched).zip(rounded);
    let mut tables = tables.map(|(((_, design, _), (digitised, delay)), table)| AxisTables {
        delay: delay.of_table(&digitised, &table, sample_hz),
        design: design.clone(),
        digitised,
        table,
    });
    let axes: Vec<AxisTables> = tables.by_ref().take(machine.axes.len()).collect();
    let mut made = Vec::new();
    for ((index, axis), (candidates, needed)) in machine.axes.iter().enumerate().zip(&families) {
        let members = candidates.iter().map(|candidate| candidate.value).zip(tables.by_ref());
        let members: Vec<(f64, AxisTables)> = members.collect();
        if let Some(family) = &axis.family {
            made.push(family::of_tables(index, axis, family, members, *needed, sample_hz)?);
        }
    }
    let delays: Vec<AxisDelay> = axes.iter().map(|axis| axis.delay).collect();
    Ok(MachineDesign {
        sample_hz,
        coefficient_fraction,
        stage: StageDelay::of_machine(machine, &delays),
        axes,
        families: made,
        together,
    })
}

impl MachineDesign {
    /// The table family of an axis; `None` where its modes do not move.
    pub fn family_of(&self, axis: usize) -> Option<&TableFamily> {
        self.families.iter().find(|family| family.axis == axis)
    }
}

impl AxisTables {
    /// Sum of the rounding errors of the coefficients, `Σ |c_i/2^F − a_i|`.
    pub fn quantising_error(&self) -> f64 {
        quantising_error(&self.digitised, &self.table)
    }

    /// Largest distance, in LSB, between the hardware's output and [`Digitised::shape`] for these command words,
    /// saturation excluded: `(max x − min x) · Σ |c_i/2^F − a_i| + ½`.
    pub fn output_bound_lsb(&self, command: &[i64]) -> f64 {
        let highest = command.iter().max().map_or(0.0, |word| *word as f64);
        let lowest = command.iter().min().map_or(0.0, |word| *word as f64);
        (highest - lowest) * self.quantising_error() + 0.5
    }

    /// The figures at every mode of `axis`, which must be the one that was designed, in the order of the file.
    pub fn mode_figures(&self, axis: &AxisSection, sample_hz: f64) -> Vec<ModeFigures> {
        let continuous = self.design.impulses.impulses();
        let real = self.digitised.impulses(sample_hz);
        let integer = tap_impulses(&self.table, sample_hz);
        let last_s = f64::from(self.table.longest_delay_samples()) / sample_hz;
        let modes = axis.modes.iter();
        modes
            .map(|axis_mode| {
                let mode = axis_mode.mode;
                let tolerance = axis.shaped().tolerance_of(axis_mode);
                ModeFigures {
                    mode,
                    tolerance,
                    residual: residual_vibration(continuous, &mode),
                    insensitivity: insensitivity(continuous, &mode, tolerance),
                    residual_digitised: residual_vibration_at(&real, &mode, last_s),
                    residual_quantised: residual_vibration(&integer, &mode),
                }
            })
            .collect()
    }
}
