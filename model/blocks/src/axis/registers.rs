//! The registers of the supervisor, and their update in a clock.

use super::cause::{AT_ONCE, Cause, DOUBTFUL, HARMLESS, switching_off};
use super::clocks::{CLEAR_CLOCKS, KICK, PRIMING_CLOCKS};
use super::monitors::Monitors;
use super::ports::Inputs;
use super::timer::{Begins, Timer};
use super::transition::{Condition, Conditions, SupervisorState, next};
use crate::pulse_counter::GlitchFilter;
use crate::segments::{self, STAND_COUNTS};
use crate::sliding_mode::Saturation;

/// A line with its synchroniser and filter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Line {
    synchroniser: [bool; 2],
    filter: GlitchFilter,
}

impl Line {
    fn clock(&mut self, pin: bool, filter_clocks: u8, ready: bool) {
        self.filter.clock(self.synchroniser[1], filter_clocks, ready);
        self.synchroniser = [pin, self.synchroniser[0]];
    }
}

/// Output pulses, which come a clock after their reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Pulses {
    pub(super) quick_stop: bool,
    pub(super) restart: bool,
    pub(super) clear_sources: bool,
    pub(super) can_start: bool,
    pub(super) enabled: bool,
    pub(super) started: bool,
    pub(super) stopping: bool,
    pub(super) halted: bool,
    pub(super) disabled: bool,
    pub(super) faulted: bool,
    pub(super) refused: bool,
}

/// All registers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Registers {
    /// Lines of emergency stop, limit +, limit −, drive ready and home.
    lines: [Line; 5],
    /// Clocks since the reset, at most [`PRIMING_CLOCKS`].
    primed: u8,
    pub(super) monitors: Monitors,
    pub(super) state: SupervisorState,
    pub(super) causes: u32,
    /// Whether a position left the range of its word, as of the clock before.
    out_of_range: bool,
    /// Whether causes were forgotten in the clock before.
    forgot: bool,
    /// Whether a cause that is set switches off, by `off_causes` of the clock before.
    cuts: bool,
    timer: Timer,
    /// In HOLD after READY: the timer counts the brake's release.
    opening: bool,
    /// In HOLD and FAULT: the brake is applied while the outputs are still on.
    closing: bool,
    pub(super) on: bool,
    pub(super) released: bool,
    /// Whether the shaper's start is still high, until the first sample.
    pub(super) starting: bool,
    start_waits: bool,
    /// Clocks until causes are forgotten.
    clear_left: u8,
    pub(super) tripping: bool,
    pub(super) homed: bool,
    pub(super) pulses: Pulses,
}

impl Default for Registers {
    fn default() -> Self {
        Self {
            lines: Default::default(),
            primed: 0,
            monitors: Monitors::default(),
            state: SupervisorState::Off,
            causes: 0,
            out_of_range: false,
            forgot: false,
            cuts: false,
            timer: Timer::default(),
            opening: false,
            closing: false,
            on: false,
            released: false,
            starting: true,
            start_waits: false,
            clear_left: 0,
            tripping: false,
            homed: false,
            pulses: Pulses::default(),
        }
    }
}

/// Causes and conditions of a clock, from inputs and registers.
struct Now {
    causes: u32,
    /// Causes that act in this clock.
    seen: u32,
    forgets: bool,
    cut: bool,
    group_stop: bool,
    wants_start: bool,
    able: bool,
    stopped: bool,
    /// Whether this is a tick at which the timer is over.
    timed_out: bool,
    /// Whether the brake is applied: `enable` is low in HOLD, and nothing else must be waited for.
    closes: bool,
    conditions: Conditions,
}

/// Whether a number is at the end of its word: the count of the last tick on an axis that is not modulo, the shaped
/// command, or e. Its meaning is wrong from there on, so the outputs must not be on.
fn leaves_range(inputs: &Inputs, position: i32) -> bool {
    let far = !(-STAND_COUNTS..STAND_COUNTS).contains(&position);
    let error = (inputs.saturated_high | inputs.saturated_low) & Saturation::Error.bit() != 0;
    (far && !inputs.modulo) || inputs.shaper_saturated || error
}

impl Registers {
    fn ready(&self) -> bool {
        self.primed == PRIMING_CLOCKS
    }

    pub(super) fn level(&self, line: usize) -> bool {
        self.lines[line].filter.level()
    }

    fn on_limits(&self) -> [bool; 2] {
        [!self.level(1), !self.level(2)]
    }

    pub(super) fn emergency_stop(&self) -> bool {
        self.ready() && !self.level(0)
    }

    pub(super) fn wants_group_stop(&self) -> bool {
        self.state == SupervisorState::Fault
            || (self.state == SupervisorState::QuickStop && self.causes & !HARMLESS != 0)
    }

    pub(super) fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            *self = Self::default();
            return;
        }
        let now = self.look(inputs);
        let (was_on, waits) = (self.on, inputs.limits_after_homing && !self.homed);
        // `homed` is that of the clock before: a write has no effect until causes are forgotten.
        let is_homed = if inputs.write_homed {
            inputs.homed_value
        } else {
            self.homed
        };
        self.homed = is_homed && self.causes & DOUBTFUL == 0;
        let after = next(self.state, now.conditions);
        self.pulses = self.pulses(inputs, &now, after);
        self.run_timer(inputs, &now, after);
        self.cuts = switching_off(now.causes, inputs.off_causes) != 0;
        self.switch(&now, after);
        self.starting = !self.on || (self.starting && !inputs.segments_valid);
        self.start_waits = now.wants_start && !inputs.tick;
        self.tripping = self.emergency_stop() || inputs.group_emergency_stop;
        (self.state, self.causes, self.forgot) = (after, now.causes, now.forgets);
        self.out_of_range = leaves_range(inputs, self.monitors.captured_position);

        let kicked = inputs.kick && inputs.kick_word == KICK;
        let on_limits = self.on_limits();
        self.monitors.clock(inputs, on_limits, waits, was_on, kicked);
        // Without a filter a level equals its line.
        let filters = self.ready() && inputs.filter_clocks != 0;
        let pins = [
            inputs.emergency_stop_n,
            inputs.limit_plus_n,
            inputs.limit_minus_n,
            inputs.drive_ready,
            inputs.home,
        ];
        for (line, pin) in self.lines.iter_mut().zip(pins) {
            line.clock(pin, inputs.filter_clocks, filters);
        }
        self.primed = (self.primed + 1).min(PRIMING_CLOCKS);
        self.clear_left = match (inputs.clear_faults, self.clear_left) {
            (true, _) => CLEAR_CLOCKS,
            (false, left) => left.saturating_sub(1),
        };
    }

    /// The causes of this clock, including those that the monitors have found.
    fn active(&self, inputs: &Inputs, group_stop: bool) -> u32 {
        let encoder = inputs.encoder_illegal || inputs.encoder_disagreement;
        let scale = inputs.scale_illegal || inputs.scale_disagreement;
        let missed = inputs.segments_tick_missed || inputs.velocity_missed;
        let segments = inputs.segments_underrun || inputs.segments_overflow || inputs.segments_out_of_range;
        let overrun = inputs.shaper_overrun || inputs.controller_overrun;
        let found = [
            (
                Cause::EmergencyStop,
                self.emergency_stop() || inputs.group_emergency_stop,
            ),
            (Cause::PwmTripped, inputs.pwm_tripped),
            (Cause::DriveLost, self.on && !self.level(3)),
            (Cause::EncoderError, encoder || scale),
            (Cause::Segments, segments),
            (Cause::GroupStop, self.on && group_stop),
            (Cause::Schedule, missed || overrun),
            (Cause::Range, self.out_of_range && (self.on || inputs.enable)),
        ];
        let bits = found.map(|(cause, is)| if is { cause.bit() } else { 0 });
        bits.into_iter().fold(self.monitors.found, |all, bit| all | bit)
    }

    /// Evaluates causes and conditions of this clock.
    fn look(&self, inputs: &Inputs) -> Now {
        let group_stop = inputs.group_stop && !self.wants_group_stop();
        // Causes that must still act are not forgotten.
        let may_forget = match self.state {
            SupervisorState::Off => true,
            SupervisorState::Ready | SupervisorState::Hold | SupervisorState::Run => self.causes & !HARMLESS == 0,
            SupervisorState::QuickStop => false,
            SupervisorState::Fault => !self.on,
        };
        let forgets = self.clear_left == 1 && may_forget;
        let kept = if forgets { 0 } else { self.causes };
        let active = self.active(inputs, group_stop);
        let causes = kept | active;
        let at_once = active & AT_ONCE;
        let seen = self.causes | at_once | (active & HARMLESS);
        let cut = self.cuts || switching_off(at_once, inputs.off_causes) != 0;
        let fault = seen & !HARMLESS != 0;
        let segments_hold = inputs.segments_state == segments::SegmentsState::Hold as u8;
        let stopped = inputs.segments_state == segments::SegmentsState::Stopped as u8;
        let elapsed = self.timer.elapsed();
        let opened = !self.opening || elapsed;
        let able = self.state == SupervisorState::Hold && opened && !self.closing && segments_hold;
        let wants_start = (inputs.start || self.start_waits) && !inputs.stop;
        let conditions = Conditions::default()
            .with(Condition::Cut, cut)
            .with(Condition::Fault, fault)
            .with(Condition::Cause, seen != 0)
            .with(Condition::DriveReady, self.ready() && self.level(3))
            .with(Condition::Enable, inputs.enable)
            .with(Condition::Tick, inputs.tick)
            .with(Condition::GroupStop, group_stop)
            .with(Condition::Stop, inputs.stop)
            .with(Condition::Start, wants_start && able)
            .with(Condition::Done, segments_hold && inputs.segments_empty)
            .with(Condition::Stopped, stopped)
            .with(Condition::Elapsed, elapsed)
            .with(Condition::Closing, self.closing)
            .with(Condition::Cleared, self.forgot && seen == 0 && !self.on);
        Now {
            causes,
            seen,
            forgets,
            cut,
            group_stop,
            wants_start,
            able,
            stopped,
            timed_out: inputs.tick && elapsed,
            closes: self.state == SupervisorState::Hold && inputs.tick && elapsed && !inputs.enable && !self.closing,
            conditions,
        }
    }

    fn pulses(&self, inputs: &Inputs, now: &Now, after: SupervisorState) -> Pulses {
        use SupervisorState::{Fault, Hold, Off, QuickStop, Ready, Run};
        let before = self.state;
        let plays = inputs.segments_state <= segments::SegmentsState::Move as u8;
        let steady = inputs.enable && !now.group_stop && now.seen == 0;
        Pulses {
            quick_stop: after == QuickStop && plays,
            restart: before == Hold && now.stopped,
            clear_sources: inputs.clear_faults,
            can_start: now.able && steady,
            enabled: before == Ready && after == Hold,
            started: before == Hold && after == Run,
            stopping: before != QuickStop && after == QuickStop,
            halted: matches!(before, Run | QuickStop) && after == Hold,
            disabled: before == Hold && after == Off,
            faulted: before != Fault && after == Fault,
            refused: inputs.tick && now.wants_start && !(before == Hold && after == Run),
        }
    }

    /// Runs the timer. It begins with a state and counts ticks; in QUICK_STOP it counts those after the segments'
    /// stop.
    fn run_timer(&mut self, inputs: &Inputs, now: &Now, after: SupervisorState) {
        use SupervisorState::{Fault, Hold, QuickStop, Ready, Run};
        let before = self.state;
        let counts = inputs.tick && (before != QuickStop || now.stopped);
        let begins = match (before, after) {
            (Ready, Hold) => Some(Begins::Release),
            // In RUN it is loaded in every clock, so that it is ready whatever ends the state.
            (Run, _) | (Hold, QuickStop) => Some(Begins::Settle),
            (QuickStop, Fault) => Some(Begins::Apply),
            (Hold, Hold) if now.closes => Some(Begins::Apply),
            _ => None,
        };
        self.timer.clock(inputs, counts, begins);
    }

    /// Updates outputs and brake.
    fn switch(&mut self, now: &Now, after: SupervisorState) {
        use SupervisorState::{Fault, Hold, QuickStop, Ready};
        let before = self.state;
        (self.on, self.closing) = match (before, after) {
            _ if now.cut || (self.closing && now.timed_out) => (false, false),
            (Ready, Hold) => (true, false),
            (QuickStop, Fault) => (true, true),
            _ => (self.on, self.closing || (after == Hold && now.closes)),
        };
        self.opening = after == Hold && (before == Ready || self.opening);
        self.released = self.on && !self.closing;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns bit `at` of a case.
    fn is(case: u32, at: u32) -> bool {
        case >> at & 1 != 0
    }

    /// Registers and inputs of a case, and the conditions that they should give.
    fn situation(state: SupervisorState, case: u32) -> (Registers, Inputs, Conditions) {
        let drive_ready = is(case, 0);
        let (cut, quick, group) = (is(case, 1), is(case, 2), is(case, 3));
        let (elapsed, opening, closing, on) = (is(case, 4), is(case, 5), is(case, 6), is(case, 7));
        let (forgotten, segments_state) = (is(case, 8), (case >> 9 & 3) as u8);
        let mut registers = Registers {
            primed: PRIMING_CLOCKS,
            state,
            timer: Timer::left(u16::from(!elapsed)),
            opening,
            closing,
            on,
            causes: if quick { Cause::EncoderError.bit() } else { 0 },
            forgot: forgotten,
            ..Registers::default()
        };
        registers.lines[0].clock(true, 0, false);
        for line in &mut registers.lines {
            (0..3).for_each(|_| line.clock(true, 0, false));
        }
        (0..3).for_each(|_| registers.lines[3].clock(drive_ready, 0, false));
        let inputs = Inputs {
            enable: is(case, 11),
            tick: is(case, 12),
            stop: is(case, 13),
            start: is(case, 14),
            segments_empty: is(case, 15),
            segments_state,
            // This cause is a line, so that it is not forgotten while it is active.
            pwm_tripped: cut,
            group_stop: group,
            drive_ready,
            ..Inputs::default()
        };
        // An axis does not see the group stop that it causes itself.
        let wants = state == SupervisorState::Fault || (state == SupervisorState::QuickStop && quick);
        let seen_group = group && !wants;
        let any = cut || quick || (on && seen_group);
        let hold = segments_state == 0;
        let brake_open = !closing && (!opening || elapsed);
        let all = [
            cut,
            cut || quick,
            any,
            drive_ready,
            inputs.enable,
            inputs.tick,
            seen_group,
            inputs.stop,
            inputs.start && !inputs.stop && state == SupervisorState::Hold && brake_open && hold,
            hold && inputs.segments_empty,
            segments_state == 3,
            elapsed,
            closing,
            forgotten && !any && !on,
        ];
        let pairs = Condition::ALL.into_iter().zip(all);
        let conditions = pairs.fold(Conditions::default(), |so_far, (condition, holds)| {
            so_far.with(condition, holds)
        });
        (registers, inputs, conditions)
    }

    #[test]
    fn the_clocked_model_follows_the_table_in_every_situation() {
        for state in SupervisorState::ALL {
            for case in 0..1 << 16 {
                let (mut registers, mut inputs, conditions) = situation(state, case);
                // A lost drive is a cause of its own; here it is one that does not switch off.
                let lost = registers.on && !is(case, 0);
                let conditions = conditions.with(Condition::Fault, lost).with(Condition::Cause, lost);
                inputs.off_causes = 0;
                registers.clock(&inputs);
                assert_eq!(registers.state, next(state, conditions), "{state:?} {case:#x}");
                assert!(registers.on || !registers.released);
            }
        }
    }
}
