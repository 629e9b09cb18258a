//! The move that all axes make at the same time.

use posicast_blocks::segments::Entry;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::motion::{AxisMove, TickLimits, plan_move, settle_s};
use posicast_machine::plan::TableFamily;

use super::figures::{self, AxisFigures};
use super::host::{Host, Trouble};
use super::{Shaping, StageRun, StageRunError};
use crate::stage_bench::{AxisSample, LineChange};

/// Largest number of clocks in which model and RTL are compared: a minute of Verilator.
pub(crate) const COMPARED_CLOCKS: u64 = 24_000_000;
/// Longest time for which a machine is simulated after the end of its shaped command, s.
const LONGEST_SETTLE_S: f64 = 2.0;
/// A move counts as over this many ticks after the end of plan and shapers.
const SPARE_TICKS: u64 = 1000;
/// Number of ticks at the end in which nothing moves any more.
pub(crate) const STANDSTILL_TICKS: u64 = 20;
/// Fraction bits of a command word and of an exact position.
pub(crate) const WORD_FRACTION: u32 = 8;
const EXACT_FRACTION: u32 = 32;

/// Result of a move.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Figures of each axis; empty if the stage never moved.
    pub axes: Vec<AxisFigures>,
    /// Samples of each axis at every tick from the start on: of motion, then of standstill.
    pub samples: Vec<Vec<AxisSample>>,
    /// Each axis's step lines in the tick with most steps; empty on axes without steps.
    pub lines: Vec<Vec<LineChange>>,
    /// Number of handovers between tap tables, for axes whose modes move with their position.
    pub handovers: u64,
    /// Of each axis with steps, those that its motor lost, and those that came while its drive was off; 0 on other axes.
    pub lost_steps: Vec<u64>,
    /// Set if the stage did not do what it should.
    pub trouble: Option<Trouble>,
}

impl Moved {
    /// Vibration of an axis's load about its rest position, in m or rad, at each tick from the end of the shaped
    /// command on.
    pub fn ringing(&self, axis: usize) -> Vec<f64> {
        let samples = self.samples.get(axis).map_or(&[][..], Vec::as_slice);
        figures::ringing(samples).0
    }
}

/// Entries of an axis with their duration in ticks.
struct Plan {
    entries: Vec<Entry>,
    ticks: u64,
}

/// Plans the move of an axis from `start` (Q24.8 counts) on: its entries, and its end. A `harsh` move has no jerk
/// limit.
pub(crate) fn plan_axis(
    machine: &Machine,
    axis: &AxisSection,
    of: &AxisMove,
    harsh: bool,
    start: i32,
) -> Result<(Vec<Entry>, i32), StageRunError> {
    let mut limits = TickLimits::of_move(axis, &machine.clock, of);
    if harsh {
        limits.jerk = limits.acceleration;
    }
    let words = of.distance * axis.loop_counts_per_unit() * f64::from(1u32 << WORD_FRACTION);
    // A distance beyond the words ends at the last word; with such fine counts the axis is refused as a plant.
    let end = start.saturating_add(words.round() as i32);
    let exact = i64::from(start) << (EXACT_FRACTION - WORD_FRACTION);
    let entries = plan_move(exact, end, &limits).map_err(|source| StageRunError::Plan {
        axis: axis.name.clone(),
        source,
    });
    Ok((entries?, end))
}

/// The move of each axis, from where it stands.
fn plan(run: &StageRun<'_>, host: &mut Host<'_>) -> Result<Vec<Plan>, StageRunError> {
    let mut plans = Vec::new();
    for (index, axis) in run.machine.axes.iter().enumerate() {
        let start = host.command(index)?;
        let (entries, _) = plan_axis(run.machine, axis, &run.moves[index], run.harsh[index], start)?;
        let ticks = entries.iter().map(|entry| u64::from(entry.ticks)).sum();
        plans.push(Plan { entries, ticks });
    }
    Ok(plans)
}

/// Switches on, loads the moves and starts them; returns their duration in ticks.
fn begin(run: &StageRun<'_>, host: &mut Host<'_>, shaping: Shaping) -> Result<Result<u64, Trouble>, StageRunError> {
    if let Some(trouble) = host.switch_on()? {
        return Ok(Err(trouble));
    }
    if let Some(trouble) = host.shape(shaping)? {
        return Ok(Err(trouble));
    }
    let plans = plan(run, host)?;
    for (axis, plan) in run.machine.axes.iter().zip(&plans) {
        for entry in &plan.entries {
            host.bench.segment(&axis.name, entry)?;
        }
    }
    let all: Vec<usize> = (0..plans.len()).collect();
    host.bench.record();
    Ok(match host.start(&all)? {
        Some(trouble) => Err(trouble),
        None => Ok(plans.iter().map(|plan| plan.ticks).max().unwrap_or(0)),
    })
}

/// Duration of the longest shaper in ticks.
fn shaper_ticks(run: &StageRun<'_>) -> u64 {
    let own = run
        .config
        .axes
        .iter()
        .map(|axis| axis.shaper.table().longest_delay_samples());
    let families = run.families.iter().map(TableFamily::longest_delay_samples);
    own.chain(families).max().unwrap_or(0).into()
}

/// The ticks that the machine of a run is simulated after the end of its commands.
pub(super) fn settle_ticks_of(run: &StageRun<'_>) -> u64 {
    settle_ticks(run.machine, shaper_ticks(run))
}

/// Returns the ticks that a machine is simulated after the end of its commands: the shapers' tail, and settling.
pub(crate) fn settle_ticks(machine: &Machine, shaper_ticks: u64) -> u64 {
    let clock = &machine.clock;
    let modes = machine.axes.iter().flat_map(|axis| &axis.modes);
    let shaper_s = shaper_ticks as f64 / clock.sample_hz;
    let settle_s = settle_s(shaper_s, modes.map(|mode| mode.mode)).min(shaper_s + LONGEST_SETTLE_S);
    (settle_s * clock.sample_hz).ceil() as u64 + STANDSTILL_TICKS
}

/// Makes the move with a device beside the model; returns whether it ended within the clocks that are compared.
pub(super) fn compare(run: &StageRun<'_>, host: &mut Host<'_>) -> Result<(Option<Trouble>, bool), StageRunError> {
    let ticks = match begin(run, host, Shaping::Shaped)? {
        Ok(ticks) => ticks,
        Err(trouble) => return Ok((Some(trouble), false)),
    };
    let rest = ticks + shaper_ticks(run) + STANDSTILL_TICKS;
    let affordable = COMPARED_CLOCKS.saturating_sub(host.bench.now()) / host.tick_clocks();
    if rest > affordable {
        host.pass(affordable * host.tick_clocks())?;
        return Ok((None, false));
    }
    let mut trouble = host.arrive(ticks + SPARE_TICKS)?;
    if trouble.is_none() {
        trouble = host.rest(shaper_ticks(run) + STANDSTILL_TICKS)?;
    }
    let whole = trouble.is_none();
    Ok((trouble, whole))
}

/// Makes the move in the model, until the machine has come to rest.
pub(super) fn measure(run: &StageRun<'_>, mut host: Host<'_>, shaping: Shaping) -> Result<Moved, StageRunError> {
    let mut trouble = match begin(run, &mut host, shaping)? {
        Ok(ticks) => host.arrive(ticks + SPARE_TICKS)?,
        Err(trouble) => Some(trouble),
    };
    if trouble.is_none() {
        trouble = host.rest(settle_ticks_of(run))?;
    }
    let samples = run.recorded(&mut host);
    let axes = samples.iter().zip(&run.machine.axes);
    Ok(Moved {
        axes: axes
            .map(|(samples, axis)| figures::of_move(samples, axis.loop_counts_per_unit()))
            .collect(),
        lines: host.bench.recorded_lines(),
        handovers: host.handovers,
        lost_steps: (0..run.machine.axes.len())
            .map(|axis| host.bench.plant(axis))
            .map(|plant| plant.lost_steps().unsigned_abs() + plant.ignored_steps())
            .collect(),
        samples,
        trouble,
    })
}
