//! A machine under a contour: its tap tables, its modes, and how far its load is from the path.

use super::ContourError;
use super::plan::{Contour, ContourSample, plane};
use super::stroke::PlanePoint;
use crate::design::MachineDesign;
use crate::machine_file::Machine;
use crate::motion::settle_s;
use crate::plant::axis::ErrorFigures;
use crate::plant::{Plant, SampledPlant};
use crate::taps::TapTable;

/// Longest time in which a machine is watched after its command has come to its end, s.
const LONGEST_SETTLE_S: f64 = 2.0;
/// Part of the largest speed from which on the path counts as driven at speed.
const AT_SPEED: f64 = 0.999;

/// A machine that has followed a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedContour {
    /// Distance of the load from the path, along its normal, over the whole way and the settling after it: m.
    pub error: ErrorFigures,
    /// The same while the path is driven at its full speed, for as long as the shapers and modes take to settle before.
    pub steady: Option<ErrorFigures>,
    /// The load in each sample.
    pub load: Vec<PlanePoint>,
    /// Its distance from the path in each sample: positive to the left of the direction of travel.
    pub distance: Vec<f64>,
}

/// The command of a contour for a machine: with time to settle after it.
///
/// # Errors
/// [`ContourError::TooLong`].
pub fn command(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
) -> Result<Vec<ContourSample>, ContourError> {
    contour.samples(machine.clock.sample_period_s(), settling_s(machine, design))
}

/// What shapers and modes of the plane take to settle.
fn settling_s(machine: &Machine, design: &MachineDesign) -> f64 {
    let longest = design
        .axes
        .iter()
        .take(2)
        .map(|tables| tables.table.longest_delay_samples());
    let shaper_s = f64::from(longest.max().unwrap_or(0)) / machine.clock.sample_hz;
    let modes = machine.axes.iter().take(2).flat_map(|axis| &axis.modes);
    settle_s(shaper_s, modes.map(|mode| mode.mode)).min(shaper_s + LONGEST_SETTLE_S)
}

/// The first two axes of a machine whose modes are at `frequency_factor` times their frequencies, each through its table,
/// under a command that settles at its end.
///
/// # Errors
/// [`ContourError::Axes`] where the machine has no such plane or its modes have no shares.
pub fn follow(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
    frequency_factor: f64,
) -> Result<FollowedContour, ContourError> {
    let samples = command(machine, design, contour)?;
    let sample_s = machine.clock.sample_period_s();
    let mut loads: Vec<Vec<f64>> = Vec::with_capacity(2);
    for ((index, axis), tables) in plane(machine)?.into_iter().enumerate().zip(&design.axes) {
        let plant = Plant::of_axis(axis).map_err(|error| ContourError::Axes(format!("axis {}: {error}", axis.name)))?;
        let command: Vec<f64> = samples.iter().map(|sample| sample.at[index]).collect();
        let references = through(&tables.table, &command);
        let start = references.first().copied().unwrap_or(0.0);
        let mut plant = SampledPlant::new(&plant.scaled(frequency_factor), sample_s, start);
        loads.push(references.iter().map(|reference| plant.step(*reference)).collect());
    }
    let load: Vec<PlanePoint> = (0..samples.len())
        .map(|sample| [loads[0][sample], loads[1][sample]])
        .collect();
    Ok(judged(machine, design, contour, &samples, load))
}

/// How far a load went from a contour whose command in each sample is `samples`, and the load `load`.
pub fn judged(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
    samples: &[ContourSample],
    load: Vec<PlanePoint>,
) -> FollowedContour {
    // The load is behind the command by the shapers and the modes; what is farther back along the path is not what it is at.
    let settling = (settling_s(machine, design) * machine.clock.sample_hz).ceil() as usize;
    let distances = load.iter().zip(samples).enumerate().map(|(sample, (place, now))| {
        let back = samples[sample.saturating_sub(settling)].along;
        contour.distance(*place, back, now.along)
    });
    let distance: Vec<f64> = distances.collect();
    let fastest = samples
        .iter()
        .fold(0.0, |fastest: f64, sample| fastest.max(sample.speed));
    let mut lasted = 0;
    let steady = samples.iter().zip(&distance).filter_map(|(sample, distance)| {
        lasted = if sample.speed >= AT_SPEED * fastest {
            lasted + 1
        } else {
            0
        };
        (lasted > settling).then_some(*distance)
    });
    let steady: Vec<f64> = steady.collect();
    FollowedContour {
        error: ErrorFigures::of(distance.iter().copied()),
        steady: (!steady.is_empty()).then(|| ErrorFigures::of(steady)),
        load,
        distance,
    }
}

/// A command through a tap table; before its beginning it stood where it begins.
fn through(table: &TapTable, command: &[f64]) -> Vec<f64> {
    let one = f64::from(table.coefficient_fraction()).exp2();
    let taps: Vec<(usize, f64)> = table
        .taps()
        .iter()
        .map(|tap| (tap.delay_samples as usize, f64::from(tap.coefficient) / one))
        .collect();
    let at = |sample: usize| {
        taps.iter()
            .map(|(delay, weight)| weight * command[sample.saturating_sub(*delay)])
            .sum()
    };
    (0..command.len()).map(at).collect()
}
