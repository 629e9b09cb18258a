//! Expected figures of the move, computed from the machine file alone: the designed tap table, the law in floating
//! point, and the sampled loop ([`SampledLoop`]). They do not use the stage, its fixed-point words or the simulated
//! pins, so that the two check each other. `docs/closed-loop.md` derives the bounds.

use posicast_blocks::segments::{Entry, Integrator};
use posicast_machine::control::Derived;
use posicast_machine::control::sampled::{FollowLimits, SampledLoop};
use posicast_machine::hardware::{self, TimedLoop};
use posicast_machine::machine_file::{AxisSection, DriveMode, FamilySection, Machine, PwmMode};
use posicast_machine::plan::{TableFamily, design_machine};
use posicast_taps::TapTable;

use super::figures::{self, AxisFigures};
use super::{Shaping, StageRun, StageRunError};
use super::{moves, stepped};
use crate::stage_bench::AxisSample;

/// The stage may differ by this fraction of an expected figure, because of the drive's limits, the clocks of the
/// schedule and the fixed-point arithmetic.
const MODEL_PART: f64 = 0.1;
/// An error may exceed the expected one by this many counts of the encoder: half a count is not resolved, and the
/// measured velocity moves the command by a count.
const TRACKING_COUNTS: f64 = 2.0;
/// The load's ringing may exceed the expected one by this many counts: the driven coordinate rests within half a count
/// of its target, and a mode overshoots such a step by up to its size.
const RINGING_COUNTS: f64 = 1.0;
/// Largest allowed error as a fraction of the move.
const MOVE_PART: f64 = 0.5;
/// A move exercises a shaper if, without the shaper, it would ring at least this many times as much as is allowed.
const EXERCISED: f64 = 1.5;
/// If the ringing without a shaper is not at least this many times as much as is allowed, the move is made harsher.
const CLEARLY: f64 = 4.0;
/// Smallest move in counts; below it, the encoder's steps dominate.
const LEAST_COUNTS: f64 = 100.0;

/// Expected figures of a move of an axis. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Distance of the move.
    pub distance: f64,
    /// Distance in counts of the loop.
    pub counts: f64,
    /// Error and ringing of the floating-point loop.
    pub figures: AxisFigures,
    /// Error that the whole Coulomb friction, and what the bridge loses to dead time and minimum pulse, cause as a
    /// step.
    pub friction: f64,
    /// Largest vibration that the handovers between tap tables add, for an axis whose modes move with its position.
    pub handover: f64,
    /// Length of a count of the loop.
    pub count: f64,
}

impl Expected {
    /// Largest allowed error of the loop: the expected error, friction and the encoder's steps, but at most half of
    /// the move.
    pub fn tracking_allowed(&self) -> f64 {
        let expected = (1.0 + MODEL_PART) * self.figures.tracking.peak + self.friction + self.handover;
        (expected + TRACKING_COUNTS * self.count).min(MOVE_PART * self.distance.abs())
    }

    /// Largest allowed ringing of the load.
    pub fn ringing_allowed(&self) -> f64 {
        (1.0 + MODEL_PART) * self.figures.residual.peak + self.friction + self.handover + RINGING_COUNTS * self.count
    }

    /// Whether the move is long enough to be significant.
    pub fn moves(&self) -> bool {
        self.counts.abs() >= LEAST_COUNTS
    }

    /// Whether the move exercises the shaper: without it (`unshaped`) the load would ring clearly more than is
    /// allowed with it.
    pub fn exercises(&self, unshaped: &Self) -> bool {
        self.times_allowed(unshaped) >= EXERCISED
    }

    fn times_allowed(&self, unshaped: &Self) -> f64 {
        unshaped.figures.residual.peak / self.ringing_allowed()
    }
}

/// Expected figures of the move, by axis, on a machine whose modes are at `frequency_factor` times their frequencies.
pub(super) fn of_move(
    run: &StageRun<'_>,
    shaping: Shaping,
    frequency_factor: f64,
) -> Result<Vec<Expected>, StageRunError> {
    let machine = run.machine;
    let design = design_machine(machine).map_err(|error| StageRunError::Design(Box::new(error)))?;
    let Some(stage) = hardware::stage(machine, &design)? else {
        return Ok(Vec::new());
    };
    let ticks = moves::settle_ticks_of(run);
    let axes = machine.axes.iter().enumerate().zip(&design.axes);
    let moves = run.moves.iter().zip(&run.harsh);
    let mut expectations = Vec::new();
    for ((((index, axis), tables), timed), (of, harsh)) in axes.zip(&stage.loops).zip(moves) {
        let planned = moves::plan_axis(machine, axis, of, *harsh, 0)?;
        let commands = commands(&planned, ticks);
        // For a mode that moves with the position, the end of the move determines mode and table.
        let family = run.families.iter().find(|family| family.axis == index);
        let along = family.filter(|_| axis.family.as_ref().is_some_and(FamilySection::is_position));
        let handed =
            along.map(|family| handed_over(family, axis, &commands, machine.clock.sample_hz, frequency_factor));
        let (at_end, table, handover) = match (&handed, shaping) {
            (Some(handed), Shaping::Shaped) => (Some(axis.at_value(handed.end)), handed.table, handed.most),
            (Some(handed), Shaping::Unshaped) => (Some(axis.at_value(handed.end)), &tables.table, 0.0),
            (None, _) => (None, &tables.table, 0.0),
        };
        let table = match shaping {
            Shaping::Shaped => table.clone(),
            Shaping::Unshaped => TapTable::bypass(table.coefficient_fraction())
                .map_err(|error| StageRunError::Design(Box::new(error)))?,
        };
        let at_end = at_end.as_ref().unwrap_or(axis);
        let expected = match timed {
            None => stepped_move(at_end, machine.clock.sample_hz, &commands, &table, frequency_factor)?,
            Some(TimedLoop { derived, lag_s }) => {
                let sampled = SampledLoop::new(at_end, machine.clock, *lag_s, frequency_factor);
                let sampled = sampled.unwrap_or_else(|| derived.sampled.clone());
                expected(machine, axis, derived, &sampled, &table, &commands, planned.1)
            }
        };
        expectations.push(Expected { handover, ..expected });
    }
    Ok(expectations)
}

/// Expected figures of an axis with steps, whose [`commands`] pass through a tap table.
pub(crate) fn stepped_move(
    axis: &AxisSection,
    sample_hz: f64,
    commands: &[[f64; 3]],
    table: &TapTable,
    frequency_factor: f64,
) -> Result<Expected, StageRunError> {
    let references = shaped(commands, table, scales(axis, sample_hz));
    stepped::expected(axis, sample_hz, &references, frequency_factor)
}

/// Whether, by axis, the move would not exercise the shaper clearly.
pub(super) fn too_smooth(run: &StageRun<'_>) -> Result<Vec<bool>, StageRunError> {
    let (shaped, unshaped) = (
        of_move(run, Shaping::Shaped, 1.0)?,
        of_move(run, Shaping::Unshaped, 1.0)?,
    );
    let axes = shaped.iter().zip(&unshaped);
    Ok(axes
        .map(|(shaped, unshaped)| shaped.times_allowed(unshaped) < CLEARLY)
        .collect())
}

/// Tables of an axis during a move.
struct HandedOver<'a> {
    /// End of the move.
    end: f64,
    /// Table in use at the end.
    table: &'a TapTable,
    /// Largest vibration that remains from the start, with the first table, and from the handovers
    /// ([`posicast_machine::plan::family`]).
    most: f64,
}

/// The tables during a move of the axis, by its command.
fn handed_over<'a>(
    family: &'a TableFamily,
    axis: &AxisSection,
    commands: &[[f64; 3]],
    sample_hz: f64,
    frequency_factor: f64,
) -> HandedOver<'a> {
    let scales = scales(axis, sample_hz);
    let modes = |value: f64| {
        let modes = axis.modes.iter();
        modes.map(move |mode| mode.at(value).scaled(frequency_factor))
    };
    let (mut now, mut most) = (family.choose(family.nominal, 0.0), 0.0);
    for command in commands {
        let value = command[0] / scales[0];
        let next = family.choose(now, value);
        let pairs = if now < next { now..next } else { next..now };
        let velocity = (command[1] / scales[1]).abs();
        let added = pairs
            .flat_map(|pair| modes(value).map(move |mode| family.handover_bound_s(pair, pair + 1, &mode, sample_hz)));
        most += velocity * added.sum::<f64>();
        now = next;
    }
    let end = commands.last().map_or(0.0, |last| last[0] / scales[0]);
    HandedOver {
        end,
        table: &family.members[now].tables.table,
        most,
    }
}

/// Words of position, velocity and acceleration per m or rad, and s.
fn scales(axis: &AxisSection, sample_hz: f64) -> [f64; 3] {
    let unit = axis.loop_counts_per_unit();
    [
        256.0 * unit,
        65_536.0 * unit / sample_hz,
        16_777_216.0 * unit / sample_hz.powi(2),
    ]
}

/// The command words of a move in every tick, and at standstill after it.
pub(crate) fn commands((entries, end): &(Vec<Entry>, i32), settle_ticks: u64) -> Vec<[f64; 3]> {
    let mut at = Integrator::default();
    let mut commands = Vec::new();
    for entry in entries {
        for tick in 0..entry.ticks {
            // What does not fit is a plan that the stage refuses.
            let _ = at.play(&entry.motion, tick == 0);
            commands.push(at.rounded().map(f64::from));
        }
    }
    let last = [f64::from(*end), 0.0, 0.0];
    commands.extend((0..settle_ticks).map(|_| last));
    commands
}

fn expected(
    machine: &Machine,
    axis: &AxisSection,
    derived: &Derived,
    sampled: &SampledLoop,
    table: &TapTable,
    commands: &[[f64; 3]],
    end: i32,
) -> Expected {
    let unit = axis.loop_counts_per_unit();
    let scales = scales(axis, machine.clock.sample_hz);
    let references = shaped(commands, table, scales);
    let (input, push) = pushes(machine, axis);
    let free = FollowLimits {
        input,
        disturbance: 0.0,
    };
    let samples: Vec<AxisSample> = sampled
        .follow(&derived.linear, &free, &references)
        .into_iter()
        .map(|at| AxisSample {
            command: at.reference * unit,
            shaped: at.reference * unit,
            count: (at.reference - at.error) * unit,
            error: at.error * unit,
            motor: at.load,
            load: at.load,
        })
        .collect();
    let friction = if push > 0.0 {
        let pushed = FollowLimits {
            input: f64::INFINITY,
            disturbance: push,
        };
        let still = vec![[0.0; 3]; references.len()];
        let errors = sampled.follow(&derived.linear, &pushed, &still);
        errors.iter().fold(0.0f64, |peak, at| peak.max(at.error.abs()))
    } else {
        0.0
    };
    Expected {
        distance: f64::from(end) / scales[0],
        counts: f64::from(end) / 256.0,
        figures: figures::of_move(&samples, unit),
        friction,
        handover: 0.0,
        count: 1.0 / unit,
    }
}

/// Largest input of the loop's plant, and the part of it that friction and the bridge take.
fn pushes(machine: &Machine, axis: &AxisSection) -> (f64, f64) {
    let (Some(drive), Some(pwm)) = (axis.drive, axis.pwm) else {
        return (f64::INFINITY, 0.0);
    };
    // Both legs lose a dead time per period, and pulses below the minimum are left out; with locked antiphase the
    // duty is near half at 0.
    let lost_clocks = match pwm.mode {
        PwmMode::LockedAntiphase => 0,
        _ => 2 * pwm.dead_time_clocks(&machine.clock) + pwm.minimum_pulse_clocks(&machine.clock),
    };
    let lost = f64::from(lost_clocks) / f64::from(pwm.period_clocks(&machine.clock).max(1));
    match drive.mode {
        DriveMode::Torque {
            equivalent_mass,
            force_constant,
            current_limit_a,
            full_scale_a,
        } => {
            let per_a = force_constant / equivalent_mass;
            let friction = drive.coulomb / equivalent_mass;
            (per_a * current_limit_a, friction + lost * full_scale_a * per_a)
        }
        DriveMode::Velocity { full_scale_velocity } => (full_scale_velocity, lost * full_scale_velocity),
    }
}

/// Passes commands through a tap table, in units and s.
fn shaped(commands: &[[f64; 3]], table: &TapTable, scales: [f64; 3]) -> Vec<[f64; 3]> {
    let one = f64::from(1u32 << table.coefficient_fraction());
    let at = |tick: usize, channel: usize| {
        let taps = table.taps().iter().map(|tap| {
            let before = tick.checked_sub(tap.delay_samples as usize);
            before.map_or(0.0, |before| f64::from(tap.coefficient) * commands[before][channel])
        });
        taps.sum::<f64>() / one / scales[channel]
    };
    (0..commands.len())
        .map(|tick| [at(tick, 0), at(tick, 1), at(tick, 2)])
        .collect()
}
