//! Compares the observations from the fault to the end with the expectation.

use posicast_blocks::axis::{Cause, SupervisorState, switching_off};
use posicast_blocks::stage::axis_interrupt_bit;

use super::case::Case;
use super::expectation::{Due, Others, Reaction};
use super::machine::{BRAKE_APPLY_TICKS, Bed, TICK_CLOCKS};
use super::observation::{Change, Observation};
use crate::stage_bench::StageBench;
use posicast_testbench::Error;

/// Largest distance in counts of an axis from its target: half a count of the encoder, and the loop's remaining
/// error.
pub(super) const ON_TARGET: i64 = 2;
/// Clocks from the state to drive and brake: the register of the drive command.
const PINS_CLOCKS: u64 = 1;
/// Clocks from the state to the gates: that register, and the gates' own.
const GATES_CLOCKS: u64 = 2;
/// Clocks from the state of one axis to QUICK_STOP of another: the group's register and the state.
const GROUP_CLOCKS: u64 = 2;
/// Ticks of a quick stop in addition to slowing down and settling: three at its start, in which the command still
/// gains speed, one for the state, and two that have begun.
const STOP_TICKS: u64 = 6;

/// A case that is being judged.
pub(super) struct Seen<'a> {
    pub(super) bed: &'a Bed,
    pub(super) case: &'a Case,
    /// The clock after the last write of the fault.
    pub(super) start: u64,
    /// The clock by which the state must have changed.
    pub(super) due: Option<u64>,
    /// Ends of the moves in counts.
    pub(super) targets: [i64; 2],
}

/// Times of the axes that were hit, in clocks and ticks; the largest of each.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Figures {
    /// Clocks from the fault, or from its detection, to another state.
    pub state_clocks: Option<u64>,
    /// Clocks until all gates are off and the drive is disabled, without a quick stop.
    pub off_clocks: Option<u64>,
    /// Ticks from QUICK_STOP to its end.
    pub stop_ticks: Option<u64>,
}

fn larger(figure: &mut Option<u64>, value: u64) {
    *figure = Some(figure.map_or(value, |figure| figure.max(value)));
}

struct Judge<'a> {
    seen: &'a Seen<'a>,
    failures: &'a mut Vec<String>,
    figures: &'a mut Figures,
    name: String,
    axis: usize,
}

/// Judges all axes.
pub(super) fn stopped(
    seen: &Seen<'_>,
    bench: &mut StageBench,
    axes: &[Observation],
    figures: &mut Figures,
    failures: &mut Vec<String>,
) -> Result<(), Error> {
    let first_stop = axes.iter().enumerate().filter(|(axis, _)| seen.case.hits(*axis));
    let first_stop = first_stop
        .filter_map(|(_, axis)| axis.change.map(|change| change.clock))
        .min();
    let interrupts = bench.read("interrupt_state")?;
    for (axis, observed) in axes.iter().enumerate() {
        let mut judge = Judge {
            seen,
            failures,
            figures,
            name: bench.axes()[axis].clone(),
            axis,
        };
        let quick = match judge.reaction() {
            Some(reaction) => judge.hit(bench, observed, reaction),
            None => judge.other(bench, observed, first_stop),
        };
        let faulted = observed.state(bench) == SupervisorState::Fault as u64;
        judge.interrupts(interrupts, quick, faulted);
        if let (true, Some((register, field))) = (seen.case.hits(axis), seen.case.row.expects.flag) {
            let name = judge.name.clone();
            let is = bench.field(&name, register, field)?;
            let flagged = is != 0;
            failures.extend((!flagged).then(|| format!("{name}: `{field}` is not set")));
        }
    }
    Ok(())
}

impl Judge<'_> {
    fn demand(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.failures.push(format!("{}: {}", self.name, what()));
        }
    }

    /// Expected reaction of this axis, if it is hit.
    fn reaction(&self) -> Option<Reaction> {
        self.seen
            .case
            .hits(self.axis)
            .then_some(self.seen.case.row.expects.reaction)
    }

    /// Judges an axis that is hit; returns whether it went through QUICK_STOP.
    fn hit(&mut self, bench: &StageBench, observed: &Observation, reaction: Reaction) -> bool {
        match reaction {
            Reaction::Nothing => {
                self.goes_on(bench, observed);
                false
            }
            Reaction::Fault => self.fault(bench, observed),
            Reaction::Reset => {
                self.in_time(observed, SupervisorState::Off as u64);
                self.off(observed, None);
                self.causes(observed.causes(bench), 0);
                false
            }
            Reaction::Halt | Reaction::Disable => {
                let change = self.in_time(observed, SupervisorState::QuickStop as u64);
                self.stands(observed, change);
                self.causes(observed.causes(bench), 0);
                true
            }
        }
    }

    /// Checks that the move ends on target and nothing is reported.
    fn goes_on(&mut self, bench: &StageBench, observed: &Observation) {
        let target = self.seen.targets[self.axis];
        let at = bench.plant(self.axis).count();
        self.demand((at - target).abs() <= ON_TARGET, || {
            format!("at {at} instead of {target}")
        });
        let causes = observed.causes(bench);
        self.demand(causes == 0, || format!("causes {causes:#x}"));
        let change = observed.change.map(|change| change.state);
        let ended = change == Some(SupervisorState::Hold as u64);
        self.demand(ended, || format!("RUN ended in state {change:?}"));
        self.demand(observed.drive_off.is_none(), || "the drive was disabled".to_owned());
    }

    /// Checks for the group stop, which leaves an axis in HOLD, or for no reaction; returns whether the axis went
    /// through QUICK_STOP.
    fn other(&mut self, bench: &StageBench, observed: &Observation, first_stop: Option<u64>) -> bool {
        if self.seen.case.row.expects.others == Others::GoOn {
            self.goes_on(bench, observed);
            return false;
        }
        if self.seen.case.row.expects.in_hold {
            let causes = observed.causes(bench);
            self.demand(causes == Cause::GroupStop.bit(), || {
                format!("causes {causes:#x} of a group stop")
            });
            let stays = observed.change.is_none() && observed.drive_off.is_none();
            self.demand(stays, || "it did not stay in HOLD".to_owned());
            return false;
        }
        let Some(change) = observed
            .change
            .filter(|change| change.state == SupervisorState::QuickStop as u64)
        else {
            self.demand(false, || "no group stop".to_owned());
            return false;
        };
        let late = change.clock.saturating_sub(first_stop.unwrap_or(change.clock));
        self.demand(late <= GROUP_CLOCKS, || {
            format!("group stop {late} clocks after the fault's")
        });
        let causes = observed.causes(bench);
        self.demand(causes == Cause::GroupStop.bit(), || {
            format!("causes {causes:#x} of a group stop")
        });
        self.stands(observed, Some(change));
        self.demand(observed.drive_off.is_none(), || {
            "the group stop disabled the drive".to_owned()
        });
        true
    }

    fn fault(&mut self, bench: &StageBench, observed: &Observation) -> bool {
        let both = self.seen.case.axes == 3;
        let group = if both { Cause::GroupStop.bit() } else { 0 };
        let expects = &self.seen.case.row.expects;
        self.causes(observed.causes(bench), group);
        let Some(change) = observed.change else {
            self.demand(false, || "no reaction".to_owned());
            return false;
        };
        let known = change.causes & (expects.causes | expects.also | group) != 0;
        self.demand(known, || format!("causes {:#x} when it stopped", change.causes));
        let cut = switching_off(change.causes, self.seen.case.off_causes) != 0;
        let wanted = if cut {
            SupervisorState::Fault
        } else {
            SupervisorState::QuickStop
        };
        self.in_time(observed, wanted as u64);
        if cut {
            self.off(observed, Some(change));
        } else if switching_off(observed.causes(bench), self.seen.case.off_causes) == 0 {
            self.stands(observed, Some(change));
            self.brakes(observed);
        }
        !cut
    }

    /// Checks that the state changed to this one in time.
    fn in_time(&mut self, observed: &Observation, state: u64) -> Option<Change> {
        let Some(change) = observed.change else {
            self.demand(false, || "no reaction".to_owned());
            return None;
        };
        self.demand(change.state == state, || {
            format!("the state became {}, not {state}", change.state)
        });
        let due = match self.seen.case.row.expects.due {
            Due::Seen(what) => observed.seen.map(|seen| seen + what.clocks()),
            Due::Clocks(_) | Due::Ticks { .. } => self.seen.due,
        };
        let clocks = change.clock.saturating_sub(self.base(observed));
        if let Some(due) = due {
            let late = change.clock.saturating_sub(due);
            self.demand(late == 0, || format!("{late} clocks late, {clocks} after the fault"));
        }
        larger(&mut self.figures.state_clocks, clocks);
        Some(change)
    }

    /// Clock from which times are counted: the clock of the fault, or of its detection.
    fn base(&self, observed: &Observation) -> u64 {
        match self.seen.case.row.expects.due {
            Due::Seen(_) => observed.seen.unwrap_or(self.seen.start),
            Due::Clocks(_) | Due::Ticks { .. } => self.seen.start,
        }
    }

    /// Checks gates, drive and brake after a cause that switches off.
    fn off(&mut self, observed: &Observation, change: Option<Change>) {
        let (base, start) = (self.base(observed), self.seen.start);
        let state = change.map_or(start, |change| change.clock);
        if self.seen.case.row.expects.gates_at_once {
            let gate = observed.last_gate;
            self.demand(gate < start, || {
                format!("a gate was on {} clocks after the fault", gate + 1 - start)
            });
        }
        let gates_off = observed.last_gate + 1;
        self.demand(gates_off <= state + GATES_CLOCKS, || {
            format!("a gate was on {} clocks after the state", gates_off - state)
        });
        for (what, clock) in [("drive", observed.drive_off), ("brake", observed.brake)] {
            let in_time = clock.is_some_and(|clock| clock <= state + PINS_CLOCKS);
            self.demand(in_time, || {
                format!("the {what} is off at {clock:?}, the state changed at {state}")
            });
        }
        let all_off = observed.drive_off.unwrap_or(gates_off).max(gates_off);
        larger(&mut self.figures.off_clocks, all_off.saturating_sub(base));
    }

    /// Checks that a quick stop ends in time.
    fn stands(&mut self, observed: &Observation, change: Option<Change>) {
        let (Some(change), Some(stood)) = (change, observed.stood) else {
            self.demand(false, || "the quick stop does not end".to_owned());
            return;
        };
        let watched = &self.seen.bed.stage.config.axes[self.axis].supervision;
        // Without a deceleration the axis stops at once.
        let deceleration = u64::from(watched.stop_deceleration.max(1));
        let slowing = (u64::from(change.travel) << 16).div_ceil(deceleration);
        let most = slowing + u64::from(watched.settle_ticks) + STOP_TICKS;
        let ticks = (stood - change.clock).div_ceil(TICK_CLOCKS);
        self.demand(ticks <= most, || {
            format!("a quick stop of {ticks} ticks, at most {most}")
        });
        larger(&mut self.figures.stop_ticks, ticks);
    }

    /// Checks the brake after the quick stop of a fault, and the outputs when it holds.
    fn brakes(&mut self, observed: &Observation) {
        let (Some(stood), Some(brake), Some(drive)) = (observed.stood, observed.brake, observed.drive_off) else {
            self.demand(false, || "no brake after the quick stop".to_owned());
            return;
        };
        self.demand(brake <= stood + PINS_CLOCKS, || {
            format!("the brake came {} clocks after the stop", brake - stood)
        });
        let holds = (BRAKE_APPLY_TICKS + 1) * TICK_CLOCKS + PINS_CLOCKS;
        let in_time = drive > brake && drive <= stood + holds;
        self.demand(in_time, || {
            format!("outputs off {} clocks after the stop", drive.abs_diff(stood))
        });
        self.demand(observed.last_gate < drive + GATES_CLOCKS, || {
            "a gate was on with the brake".to_owned()
        });
    }

    /// Checks that an expected cause of this fault is set, and no cause that the fault cannot lead to.
    fn causes(&mut self, causes: u32, group: u32) {
        let expects = &self.seen.case.row.expects;
        let there = expects.causes == 0 || causes & (expects.causes | group) != 0;
        let strange = causes & !(expects.causes | expects.also | group);
        self.demand(there, || {
            format!("causes {causes:#x}, but none of the expected {:#x}", expects.causes)
        });
        self.demand(strange == 0, || {
            format!("causes {causes:#x}, of these {strange:#x} are unexpected")
        });
    }

    fn interrupts(&mut self, bits: u32, quick: bool, faulted: bool) {
        let axis = self.axis;
        let is = |name| axis_interrupt_bit(axis, name).is_some_and(|bit| bits >> bit & 1 != 0);
        if self.reaction() == Some(Reaction::Reset) {
            return;
        }
        for (name, wanted) in [("stopping", quick), ("faulted", faulted)] {
            self.demand(is(name) == wanted, || format!("interrupt `{name}` is {}", is(name)));
        }
    }
}
