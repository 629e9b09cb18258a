//! Simulates a machine on a contour: its tap tables, its modes, and the distance of its load from the path.

use super::ContourError;
use super::plan::{Contour, ContourSample, plane};
use super::stroke::PlanePoint;
use crate::design::MachineDesign;
use crate::machine_file::Machine;
use crate::motion::settle_s;
use crate::plant::axis::ErrorFigures;
use crate::plant::{Plant, SampledPlant};
use crate::taps::TapTable;

/// Longest time for which a machine is simulated after the end of its command, s.
const LONGEST_SETTLE_S: f64 = 2.0;
/// Fraction of the largest speed from which on the path counts as driven at full speed.
const AT_SPEED: f64 = 0.999;

/// Result of a machine following a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedContour {
    /// Distance of the load from the path, along its normal, over the whole path and the settling after it, in m.
    pub error: ErrorFigures,
    /// Distance while the path is driven at full speed, counted once the shapers and modes have settled to it.
    pub steady: Option<ErrorFigures>,
    /// Position of the load in each sample.
    pub load: Vec<PlanePoint>,
    /// Distance of the load from the path in each sample: positive to the left of the direction of travel.
    pub distance: Vec<f64>,
}

/// The command of a contour for a machine, with time to settle after it.
///
/// # Errors
/// [`ContourError::TooLong`] for more samples than are simulated.
pub fn command(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
) -> Result<Vec<ContourSample>, ContourError> {
    contour.samples(machine.clock.sample_period_s(), settling_s(machine, design))
}

/// Time that shapers and modes of the plane take to settle, in s.
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

/// Simulates the first two axes of a machine whose modes are at `frequency_factor` times their frequencies. Each
/// passes the command, which settles at its end, through its table.
///
/// [`ContourError::Axes`] where the machine has no such plane or its modes have no participation.
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

/// Distance of a load from the path of a contour; `samples` has the command and `load` the load's position in each
/// sample.
pub fn judged(
    machine: &Machine,
    design: &MachineDesign,
    contour: &Contour,
    samples: &[ContourSample],
    load: Vec<PlanePoint>,
) -> FollowedContour {
    // The load lags the command by the shapers and the modes. Parts of the path further back are not compared with
    // it.
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

/// Passes a command through a tap table; before its start it had its first value.
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
