//! Runs one case, from reset to the small move after the fault.

use posicast_blocks::axis::{SupervisorState, WATCH_CLOCKS};
use posicast_blocks::segments::Entry;
use posicast_machine::motion::{TickLimits, plan_move};

use super::CampaignError;
use super::case::Case;
use super::expectation::{Due, Reaction};
use super::injection::{begin, end, last_entry};
use super::judge::{self, Figures, Seen};
use super::kind::FaultKind;
use super::machine::{Bed, FILTER_CLOCKS, TICK_CLOCKS};
use super::observation::Observation;
use super::positions::Positions;
use crate::stage_bench::{StageBench, state};
use posicast_testbench::Error;
use posicast_testbench::lockstep::Device;

/// Number of clocks after the fault, and after a change, that are observed one by one.
const CLOSE_CLOCKS: u64 = 48;
/// Number of clocks before and after each tick that are observed one by one.
const ABOUT_TICK_CLOCKS: [u64; 2] = [2, 24];
/// Largest number of ticks from the end of the move to the end of a case.
const PATIENCE_TICKS: u64 = 400;
/// Number of ticks after the end in which nothing may change.
const STAY_TICKS: u64 = 3;
/// Clocks until a load that was stopped at once no longer rings: four time constants of the slower mode.
const RINGING_CLOCKS: u64 = 225_000;
/// Number of clocks in which lines and encoders settle after a fault.
const SETTLE_CLOCKS: u64 = 200;
/// Clocks in which an absolute encoder that was lost places its axis again: a reading, and the tick after it.
const PLACING_CLOCKS: u64 = 3 * TICK_CLOCKS;
/// Clocks that an encoder's line takes through synchroniser and filter, and a few more.
const STILL_CLOCKS: u64 = FILTER_CLOCKS + 4;
/// Largest number of clocks until the brake is open, or a small move is over.
const PATIENCE_CLOCKS: u64 = 300_000;
/// Number of ticks in which the loop settles to a constant command.
const LOOP_TICKS: u64 = 20;
/// Counts that come within filter and synchroniser if a filter lets no more pass.
const FAST_COUNTS_ON_THEIR_WAY: u64 = (FILTER_CLOCKS + 4).div_ceil(FILTER_CLOCKS.div_ceil(2));
/// Distance of the move after the fault in counts.
const SMALL_MOVE: i64 = 30;
/// Mask of both axes.
const BOTH: u32 = 3;
/// Mask of `stopping` and `faulted` of both axes in the interrupt registers.
const INTERRUPTS: u32 = 0b11_0000 | 0b11_0000 << 7;

/// Result of a case.
#[derive(Debug, Clone)]
pub struct FaultOutcome {
    /// The case.
    pub case: Case,
    /// Figures of the axes that were hit.
    pub figures: Figures,
    /// Descriptions of what did not meet the expectation.
    pub failures: Vec<String>,
}

/// Runs a case; with a device, every clock is compared with it.
///
/// # Errors
/// [`CampaignError`] if it cannot be run. Unmet expectations are in the outcome.
pub fn run_case(bed: &Bed, case: &Case, device: Option<Box<dyn Device>>) -> Result<FaultOutcome, CampaignError> {
    let bench = bed.bench(device, case.number)?;
    let mut running = Running {
        bed,
        case,
        bench,
        lifted: false,
        positions: None,
        failures: Vec::new(),
        figures: Figures::default(),
    };
    running.all().map_err(|error| CampaignError::Case {
        case: case.number,
        kind: case.row.name,
        error,
    })?;
    Ok(FaultOutcome {
        case: *case,
        figures: running.figures,
        failures: running.failures,
    })
}

struct Running<'a> {
    bed: &'a Bed,
    case: &'a Case,
    bench: StageBench,
    /// Whether the fault has already been removed.
    lifted: bool,
    /// Compare and capture of the case.
    positions: Option<Positions>,
    failures: Vec<String>,
    figures: Figures,
}

impl Running<'_> {
    fn demand(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.failures.push(what());
        }
    }

    fn all(&mut self) -> Result<(), Error> {
        Positions::record(&mut self.bench, self.case)?;
        if !self.bench.switch_on(PATIENCE_CLOCKS)? {
            self.failures.push("the axes did not come to HOLD".to_owned());
            return Ok(());
        }
        for name in self.bench.axes().to_vec() {
            self.bench
                .write(&format!("{name}_watchdog"), u32::from(self.case.off_causes) << 16)?;
        }
        self.positions = Positions::begin(&mut self.bench, self.bed, self.case)?;
        self.bench.write("interrupt_enable", INTERRUPTS)?;
        let plan = if self.case.row.expects.in_hold {
            Plan::default()
        } else {
            let plan = self.plan()?;
            self.load(&plan.entries)?;
            if !self.start()? {
                return Ok(());
            }
            plan
        };
        self.bench.write("interrupt_state", u32::MAX)?;
        let axes = self.run_run_to_fault(plan.ticks)?;
        let observed = self.observe(axes, plan.ticks)?;
        judge::stopped(
            &Seen {
                bed: self.bed,
                case: self.case,
                start: observed.start,
                due: observed.due,
                targets: plan.targets,
            },
            &mut self.bench,
            &observed.axes,
            &mut self.figures,
            &mut self.failures,
        )?;
        if let Some(positions) = &mut self.positions {
            positions.read(&mut self.bench)?;
        }
        self.recover()?;
        if let Some(positions) = &self.positions {
            let failures = positions.judge(&mut self.bench)?;
            self.failures.extend(failures);
        }
        self.forever();
        Ok(())
    }

    /// Plans the move of both axes; a fault that is an entry replaces its end.
    fn plan(&mut self) -> Result<Plan, Error> {
        let mut plan = Plan::default();
        for axis in 0..2 {
            let (entries, target) = self.entries(axis, self.case.counts[axis])?;
            plan.targets[axis] = target;
            plan.ticks = entries.iter().map(|entry| u64::from(entry.ticks)).sum();
            plan.entries[axis] = entries;
        }
        for axis in self.case.hit_axes() {
            if let Some(last) = last_entry(self.case, axis) {
                let cut = plan.ticks * self.case.when / 10_000;
                let mut ticks = 0;
                plan.entries[axis].retain(|entry| {
                    ticks += u64::from(entry.ticks);
                    ticks <= cut
                });
                plan.entries[axis].push(last);
            }
        }
        Ok(plan)
    }

    /// A move by this many counts from the present command, and its end in counts of the counter.
    fn entries(&mut self, axis: usize, counts: i64) -> Result<(Vec<Entry>, i64), Error> {
        let name = self.bench.axes()[axis].clone();
        let at = i64::from(self.bench.read(&format!("{name}_command_position"))? as i32);
        let end = at + 256 * counts;
        let limits = TickLimits::of_axis(&self.bed.machine.axes[axis], &self.bed.machine.clock);
        let entries = plan_move(at << 24, end as i32, &limits);
        let entries = entries.map_err(|error| Error::Unlike(format!("no move of {counts} counts: {error}")))?;
        Ok((entries, end.div_euclid(256)))
    }

    fn load(&mut self, entries: &[Vec<Entry>; 2]) -> Result<(), Error> {
        for (axis, entries) in entries.iter().enumerate() {
            let name = self.bench.axes()[axis].clone();
            for entry in entries {
                self.bench.segment(&name, entry)?;
            }
        }
        Ok(())
    }

    /// Starts both axes; they are in RUN at the next tick.
    fn start(&mut self) -> Result<bool, Error> {
        self.bench.write("start", BOTH)?;
        let mut runs = false;
        // A start that comes too late for a tick waits for the next one.
        for _ in 0..2 {
            self.next_tick()?;
            self.bench.clocks(1)?;
            runs = true;
            for name in self.bench.axes().to_vec() {
                runs &= self.bench.net(&format!("{name}_state"))? == u64::from(state::RUN);
            }
            if runs {
                break;
            }
        }
        self.demand(runs, || "the axes did not start".to_owned());
        Ok(runs)
    }

    /// Simulates to the clock after the next tick.
    fn next_tick(&mut self) -> Result<(), Error> {
        for _ in 0..=TICK_CLOCKS + 3 {
            self.bench.clocks(1)?;
            if self.bench.output("tick")? != 0 {
                break;
            }
        }
        Ok(())
    }

    /// Simulates to the clock of the fault; the last two ticks before it are simulated one by one, to know the
    /// commands' velocities.
    fn run_run_to_fault(&mut self, ticks: u64) -> Result<Vec<Observation>, Error> {
        let mut axes = Vec::new();
        let from = if self.case.row.expects.in_hold {
            SupervisorState::Hold
        } else {
            SupervisorState::Run
        };
        for axis in 0..2 {
            let watched = &self.bed.stage.config.axes[axis].supervision;
            axes.push(Observation::new(&self.bench, axis, watched, from)?);
        }
        let is_entry = matches!(
            self.case.row.kind,
            FaultKind::Overflow | FaultKind::OutOfRange | FaultKind::TooFast
        );
        let whole = if is_entry { 0 } else { ticks * self.case.when / 10_000 };
        if let Some(positions) = &mut self.positions {
            let fault = self.bench.now() + whole * TICK_CLOCKS + self.case.clock_of_tick;
            positions.schedule(&mut self.bench, fault)?;
        }
        if is_entry {
            return Ok(axes);
        }
        let close = whole.min(2);
        self.bench
            .clocks((whole - close) * TICK_CLOCKS + self.case.clock_of_tick)?;
        axes.iter_mut().for_each(|axis| axis.follow_command(&self.bench));
        for _ in 0..close {
            self.bench.clocks(TICK_CLOCKS)?;
            axes.iter_mut().for_each(|axis| axis.follow_command(&self.bench));
        }
        if let FaultKind::EncoderIllegal | FaultKind::ScaleIllegal = self.case.row.kind {
            self.wait_for_still_encoders()?;
        }
        Ok(axes)
    }

    /// Waits until the filters show the encoders' lines: while a step is on its way through them, inverting both
    /// lines would look like another step to the counter.
    fn wait_for_still_encoders(&mut self) -> Result<(), Error> {
        let (mut lines, mut still) = (Vec::new(), 0);
        for _ in 0..2 * TICK_CLOCKS {
            let found: Vec<_> = self
                .case
                .hit_axes()
                .map(|axis| (self.bench.plant(axis).encoder(), self.bench.plant(axis).scale()))
                .collect();
            still = if found == lines { still + 1 } else { 0 };
            lines = found;
            if still > STILL_CLOCKS {
                break;
            }
            self.bench.clocks(1)?;
        }
        Ok(())
    }

    /// Injects the fault, and simulates until the axes have ended.
    fn observe(&mut self, mut axes: Vec<Observation>, move_ticks: u64) -> Result<Observed, Error> {
        let is_theirs = match &mut self.positions {
            Some(positions) => positions.inject(&mut self.bench, self.case)?,
            None => false,
        };
        if !is_theirs {
            begin(&mut self.bench, self.case)?;
        }
        let start = self.bench.now();
        let lifted = self.case.lasts.map(|clocks| start + clocks);
        let latest = start + (move_ticks + PATIENCE_TICKS) * TICK_CLOCKS;
        let mut due = self.first_due(start);
        let tick_net = self.bench.probe("tick")?;
        let (mut ticks, mut last_tick, mut ended) = (0, None, None);
        while self.bench.now() < latest {
            let now = self.bench.now();
            if lifted == Some(now) {
                end(&mut self.bench, self.case, false)?;
                self.lifted = true;
            }
            let tick = self.bench.at(tick_net) != 0;
            axes.iter_mut().for_each(|axis| axis.before(&self.bench, tick));
            if ended.is_none() && axes.iter().enumerate().all(|(at, axis)| self.has_ended(at, axis)) {
                ended = Some(now);
            }
            if ended.is_some_and(|ended| now > ended + STAY_TICKS * TICK_CLOCKS) {
                break;
            }
            let mut step = self.step(start, &axes, last_tick);
            if let Some(lifted) = lifted.filter(|lifted| *lifted > now) {
                step = step.min(lifted - now);
            }
            if let Due::Seen(seen) = self.case.row.expects.due {
                axes.iter_mut().for_each(|axis| axis.look_for(&self.bench, seen, tick));
            }
            self.bench.clocks(step)?;
            axes.iter_mut().for_each(|axis| axis.after(&self.bench));
            if tick {
                last_tick = Some(now);
                if let Due::Ticks { clocks, ticks: wanted } = self.case.row.expects.due {
                    ticks += u64::from(now >= start + clocks);
                    if ticks == wanted && due.is_none() {
                        due = Some(now + u64::from(WATCH_CLOCKS));
                    }
                }
            }
        }
        let states: Vec<u64> = axes.iter().map(|axis| axis.state(&self.bench)).collect();
        self.demand(ended.is_some(), || {
            format!("the axes did not end where they should: states {states:?}")
        });
        Ok(Observed { axes, start, due })
    }

    /// Clock by which the state must have changed, if that is known from the start.
    fn first_due(&self, start: u64) -> Option<u64> {
        match self.case.row.expects.due {
            Due::Clocks(clocks) => Some(start + clocks),
            Due::Ticks { .. } | Due::Seen(_) => None,
        }
    }

    /// Number of clocks until the next one that is observed.
    fn step(&self, start: u64, axes: &[Observation], last_tick: Option<u64>) -> u64 {
        let now = self.bench.now();
        let close = |clock: u64| now < clock + CLOSE_CLOCKS;
        let changes = axes
            .iter()
            .flat_map(|axis| [axis.change.map(|change| change.clock), axis.stood]);
        let Some(last_tick) = last_tick else {
            return 1;
        };
        // A reading fails between two ticks, and one axis may stop the other before its own reading does.
        let is_between = matches!(self.case.row.kind, FaultKind::AbsoluteBit | FaultKind::AbsoluteStuck);
        let is_awaited = is_between && axes.iter().any(|axis| axis.change.is_none());
        if is_awaited || close(start) || changes.flatten().any(close) {
            return 1;
        }
        let [before, after] = ABOUT_TICK_CLOCKS;
        let phase = (now - last_tick) % TICK_CLOCKS;
        if (after..TICK_CLOCKS - before).contains(&phase) {
            TICK_CLOCKS - before - phase
        } else {
            1
        }
    }

    fn has_ended(&self, axis: usize, seen: &Observation) -> bool {
        let state = seen.state(&self.bench) as u32;
        let holds = state == state::HOLD && seen.settled(&self.bench);
        if !self.case.hits(axis) {
            return holds;
        }
        match self.case.row.expects.reaction {
            Reaction::Nothing | Reaction::Halt => holds,
            Reaction::Fault => state == state::FAULT && seen.drive_off.is_some(),
            Reaction::Disable => state == state::READY,
            Reaction::Reset => state == state::OFF,
        }
    }

    /// Removes the fault, clears, switches on what is off, and moves both axes back a little.
    fn recover(&mut self) -> Result<(), Error> {
        if !self.lifted {
            end(&mut self.bench, self.case, self.case.lasts.is_none())?;
        }
        self.bench.clocks(RINGING_CLOCKS)?;
        let known = self.case.row.expects.position_known && self.case.row.expects.reaction != Reaction::Reset;
        if !known {
            // Counts of the encoder's lines while they were corrupted are accepted; from here on none may be lost.
            self.bench.rebase();
        }
        let names = self.bench.axes().to_vec();
        for name in &names {
            let state = self.bench.net(&format!("{name}_state"))? as u32;
            if state != state::HOLD {
                self.bench.write(&format!("{name}_control"), 0)?;
                self.bench.write(&format!("{name}_clear_faults"), 0)?;
            }
        }
        let lost = (0..names.len()).any(|axis| self.bench.plant(axis).is_absolute()) && !known;
        self.bench.clocks(if lost { PLACING_CLOCKS } else { SETTLE_CLOCKS })?;
        // Only now no axis wants a group stop any more, so that those that stopped for it can be cleared.
        for name in &names {
            self.bench.write(&format!("{name}_clear_faults"), 0)?;
        }
        self.bench.clocks(SETTLE_CLOCKS)?;
        for name in &names {
            let state = self.bench.net(&format!("{name}_state"))? as u32;
            let waits = state == state::READY || state == state::HOLD;
            self.demand(waits, || format!("{name} is in state {state} after clear_faults"));
            self.bench.write(&format!("{name}_control"), 1)?;
        }
        for name in &names {
            let can_start = format!("{name}_can_start");
            let end = self.bench.now() + PATIENCE_CLOCKS;
            while self.bench.net(&can_start)? == 0 && self.bench.now() < end {
                self.bench.clocks(TICK_CLOCKS)?;
            }
        }
        self.small_move()
    }

    fn small_move(&mut self) -> Result<(), Error> {
        let (mut entries, mut targets) = <([Vec<Entry>; 2], [i64; 2])>::default();
        for axis in 0..2 {
            let back = -SMALL_MOVE * self.case.counts[axis].signum();
            (entries[axis], targets[axis]) = self.entries(axis, back)?;
        }
        self.load(&entries)?;
        if !self.start()? {
            return Ok(());
        }
        for name in self.bench.axes().to_vec() {
            let arrived = self.bench.wait(&name, state::HOLD, PATIENCE_CLOCKS)?;
            self.demand(arrived, || format!("{name} does not end its move after the fault"));
        }
        let settle = self
            .bed
            .stage
            .config
            .axes
            .iter()
            .map(|axis| axis.supervision.settle_ticks);
        let settle = u64::from(settle.max().unwrap_or(0)) + LOOP_TICKS;
        self.bench.clocks(settle * TICK_CLOCKS)?;
        for (axis, target) in targets.into_iter().enumerate() {
            let name = self.bench.axes()[axis].clone();
            let count = i64::from(self.bench.net(&format!("{name}_count"))? as u32 as i32);
            let at = self.bench.plant(axis).count() - self.bench.watched(axis).origin;
            self.demand((count - target).abs() <= judge::ON_TARGET, || {
                format!("{name} is at {count} instead of {target} after the fault")
            });
            self.demand((count - at).abs() <= 1, || {
                format!("{name} has lost its position: {count} counted, {at} moved")
            });
            let causes = self.bench.net(&format!("{name}_causes"))?;
            self.demand(causes == 0, || format!("{name} has causes {causes:#x} after the fault"));
        }
        Ok(())
    }

    /// Counts that are still in synchroniser and filter, at most.
    fn on_their_way(&self) -> u64 {
        match self.case.row.kind {
            FaultKind::CompareFast => FAST_COUNTS_ON_THEIR_WAY,
            _ => 1,
        }
    }

    /// Checks what must never happen in any clock.
    fn forever(&mut self) {
        for axis in 0..2 {
            let name = self.bench.axes()[axis].clone();
            let (watched, shorted) = (*self.bench.watched(axis), self.bench.plant(axis).shorted_clocks());
            let never = [
                ("both gates of a leg on", shorted),
                ("a gate on with the drive disabled", watched.gates_while_disabled),
                (
                    "the brake released with the drive disabled",
                    watched.released_while_disabled,
                ),
            ];
            for (what, clocks) in never {
                self.demand(clocks == 0, || format!("{name}: {what} in {clocks} clocks"));
            }
            let (lost, on_their_way) = (watched.largest_count_error, self.on_their_way());
            self.demand(lost <= on_their_way, || {
                format!("{name}: the counter was away by {lost} counts")
            });
        }
        let (mismatches, first) = self.bench.mismatches();
        self.demand(mismatches == 0, || {
            let first = first.map_or_else(String::new, |first| first.to_string());
            format!("RTL and model differ {mismatches} times: {first}")
        });
    }
}

#[derive(Default)]
struct Plan {
    entries: [Vec<Entry>; 2],
    targets: [i64; 2],
    ticks: u64,
}

struct Observed {
    axes: Vec<Observation>,
    start: u64,
    due: Option<u64>,
}
