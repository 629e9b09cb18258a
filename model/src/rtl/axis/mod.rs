//! The supervisor of an axis: when its outputs are on, what its command does, and what happens when something goes wrong.
//!
//! The datasheet is `docs/axis.md`; this is the reference that the hardware is compared with.
//!
//! | part | what it does |
//! |---|---|
//! | [`TRANSITIONS`], [`next`] | the states, as data |
//! | [`Cause`], [`switching_off`] | what can go wrong, and which of it switches off |
//! | `monitors` | limits, soft limits, following error and the rest of what is watched at ticks |
//! | [`Axis`] | lines, sticky causes, the state, outputs |
//!
//! [`Axis::step`] is one clock; [`Axis::hold`] is many with the same inputs, and skips those that change nothing.
//!
//! ```
//! use posicast_model::rtl::axis::{Axis, Inputs, State};
//!
//! let mut axis = Axis::new();
//! let good = Inputs { emergency_stop_n: true, drive_ready: true, ..Inputs::default() };
//! axis.hold(&good, 20);
//! assert_eq!(axis.outputs().state, State::Ready);
//! axis.step(&Inputs { enable: true, tick: true, ..good });
//! assert_eq!((axis.outputs().state, axis.outputs().pwm_enable), (State::Hold, true));
//! // The emergency stop's wire breaks: five clocks without a filter.
//! axis.hold(&Inputs { emergency_stop_n: false, enable: true, ..good }, 4);
//! assert_eq!((axis.outputs().state, axis.outputs().pwm_enable), (State::Fault, false));
//! ```

mod cause;
mod inputs;
mod monitors;
mod outputs;
mod transition;

pub use cause::{ALWAYS_OFF, Cause, HARMLESS, switching_off};
pub use inputs::{INPUT_PORTS, Inputs};
pub use outputs::{OUTPUT_PORTS, Outputs};
pub use transition::{Condition, Conditions, State, TRANSITIONS, Transition, next};

use self::monitors::Monitors;
use super::pulse_counter::GlitchFilter;
use super::segments;
use super::{ClockedBlock, Direction, Moore, Port, StepError};

/// The word that kicks the watchdog: `KICK`, in ASCII.
pub const KICK: u32 = 0x4b49_434b;
/// Clocks from `clear_faults` until causes that are over are forgotten: what they come from is cleared meanwhile.
pub const CLEAR_CLOCKS: u8 = 8;
/// Clocks after a reset until lines count as known: two of the synchroniser, the filter's, one to spare.
pub const PRIMING_CLOCKS: u8 = 4;
/// Clocks from a line to the state, beside `filter_clocks`: two of the synchroniser, the filter's, the state's.
pub const LINE_CLOCKS: u32 = 4;

/// A line: synchroniser, then filter.
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

/// Pulses, and what follows a clock after its reason.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Pulses {
    quick_stop: bool,
    restart: bool,
    clear_sources: bool,
    can_start: bool,
    enabled: bool,
    started: bool,
    stopping: bool,
    halted: bool,
    disabled: bool,
    faulted: bool,
    refused: bool,
}

/// Everything that is a register.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Registers {
    /// Emergency stop, limit +, limit −, drive ready, home.
    lines: [Line; 5],
    /// Clocks since the reset, at most [`PRIMING_CLOCKS`].
    primed: u8,
    monitors: Monitors,
    state: State,
    causes: u16,
    /// Ticks until brake, shaper or brake are done.
    timer: u16,
    /// In HOLD after READY: the timer is that of the brake's release.
    opening: bool,
    /// In HOLD and FAULT: the brake is applied and the outputs are still on.
    closing: bool,
    on: bool,
    released: bool,
    /// The shaper's start is kept until the first sample.
    starting: bool,
    start_waits: bool,
    /// Clocks until causes are forgotten.
    clear_left: u8,
    tripping: bool,
    pulses: Pulses,
}

impl Default for Registers {
    fn default() -> Self {
        Self {
            lines: Default::default(),
            primed: 0,
            monitors: Monitors::default(),
            state: State::Off,
            causes: 0,
            timer: 0,
            opening: false,
            closing: false,
            on: false,
            released: false,
            starting: true,
            start_waits: false,
            clear_left: 0,
            tripping: false,
            pulses: Pulses::default(),
        }
    }
}

/// What a clock is about, from inputs and registers.
struct Now {
    causes: u16,
    cut: bool,
    group_stop: bool,
    wants_start: bool,
    able: bool,
    stopped: bool,
    /// A tick with the timer over.
    timed_out: bool,
    /// `enable` is low in HOLD, and nothing has to be waited for: the brake is applied.
    closes: bool,
    conditions: Conditions,
}

/// The supervisor, cycle accurate at its ports.
#[derive(Debug, Clone)]
pub struct Axis {
    ports: Vec<Port>,
    registers: Registers,
}

impl Default for Axis {
    fn default() -> Self {
        Self::new()
    }
}

impl Axis {
    /// A supervisor after reset.
    pub fn new() -> Self {
        Self {
            ports: ports(),
            registers: Registers::default(),
        }
    }

    /// What the outputs show now.
    pub fn outputs(&self) -> Outputs {
        let registers = &self.registers;
        let pulses = registers.pulses;
        let [emergency_stop_n, limit_plus_n, limit_minus_n, drive_ready, home] =
            [0, 1, 2, 3, 4].map(|line: usize| registers.lines[line].filter.level());
        Outputs {
            state: registers.state,
            causes: registers.causes,
            drive_enable: registers.on,
            brake_release: registers.released,
            pwm_enable: registers.on,
            pwm_trip_n: !registers.tripping,
            segments_enable: registers.state == State::Run,
            segments_preset: !registers.on,
            segments_quick_stop: pulses.quick_stop,
            segments_restart: pulses.restart,
            shaper_start: registers.starting,
            clear_integral: registers.starting,
            clear_sources: pulses.clear_sources,
            wants_group_stop: registers.wants_group_stop(),
            emergency_stop: registers.emergency_stop(),
            can_start: pulses.can_start,
            captured_position: registers.monitors.captured_position,
            level_emergency_stop_n: emergency_stop_n,
            level_limit_plus_n: limit_plus_n,
            level_limit_minus_n: limit_minus_n,
            level_drive_ready: drive_ready,
            level_home: home,
            enabled: pulses.enabled,
            started: pulses.started,
            stopping: pulses.stopping,
            halted: pulses.halted,
            disabled: pulses.disabled,
            faulted: pulses.faulted,
            refused: pulses.refused,
        }
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        self.registers.clock(inputs);
        outputs
    }

    /// So many clocks with the same inputs. Ends early once a clock changes nothing, since no later one would.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        for _ in 0..clocks {
            let before = self.registers.clone();
            self.registers.clock(inputs);
            if self.registers == before {
                return;
            }
        }
    }
}

impl Registers {
    fn ready(&self) -> bool {
        self.primed == PRIMING_CLOCKS
    }

    fn level(&self, line: usize) -> bool {
        self.lines[line].filter.level()
    }

    fn on_limits(&self) -> [bool; 2] {
        [!self.level(1), !self.level(2)]
    }

    fn emergency_stop(&self) -> bool {
        self.ready() && !self.level(0)
    }

    fn wants_group_stop(&self) -> bool {
        self.state == State::Fault || (self.state == State::QuickStop && self.causes & !HARMLESS != 0)
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            *self = Self::default();
            return;
        }
        let now = self.look(inputs);
        let was_on = self.on;
        let after = next(self.state, now.conditions);
        self.pulses = self.pulses(inputs, &now, after);
        self.run_timer(inputs, &now, after);
        self.switch(&now, after);
        self.starting = !self.on || (self.starting && !inputs.segments_valid);
        self.start_waits = now.wants_start && !inputs.tick;
        self.tripping = self.emergency_stop() || inputs.group_emergency_stop;
        (self.state, self.causes) = (after, now.causes);

        let kicked = inputs.kick && inputs.kick_word == KICK;
        let on_limits = self.on_limits();
        self.monitors.clock(inputs, on_limits, was_on, kicked);
        let ready = self.ready();
        let pins = [
            inputs.emergency_stop_n,
            inputs.limit_plus_n,
            inputs.limit_minus_n,
            inputs.drive_ready,
            inputs.home,
        ];
        for (line, pin) in self.lines.iter_mut().zip(pins) {
            line.clock(pin, inputs.filter_clocks, ready);
        }
        self.primed = (self.primed + 1).min(PRIMING_CLOCKS);
        self.clear_left = match (inputs.clear_faults, self.clear_left) {
            (true, _) => CLEAR_CLOCKS,
            (false, left) => left.saturating_sub(1),
        };
    }

    /// The causes of this clock, those of tick and monitors among them.
    fn active(&self, inputs: &Inputs, group_stop: bool) -> u16 {
        let encoder = inputs.encoder_illegal || inputs.encoder_disagreement;
        let scale = inputs.scale_illegal || inputs.scale_disagreement;
        let missed = inputs.segments_tick_missed || inputs.velocity_missed;
        let overrun = inputs.shaper_overrun || inputs.controller_overrun;
        let found = [
            (
                Cause::EmergencyStop,
                self.emergency_stop() || inputs.group_emergency_stop,
            ),
            (Cause::PwmTripped, inputs.pwm_tripped),
            (Cause::DriveLost, self.on && !self.level(3)),
            (Cause::EncoderError, encoder || scale),
            (Cause::Segments, inputs.segments_underrun || inputs.segments_overflow),
            (Cause::GroupStop, self.on && group_stop),
            (Cause::Schedule, missed || overrun),
        ];
        let watched = if self.on && inputs.tick {
            self.monitors.causes(inputs, self.on_limits())
        } else {
            0
        };
        let bits = found.map(|(cause, is)| if is { cause.bit() } else { 0 });
        bits.into_iter().fold(watched, |all, bit| all | bit)
    }

    /// Causes and conditions of this clock.
    fn look(&self, inputs: &Inputs) -> Now {
        let group_stop = inputs.group_stop && !self.wants_group_stop();
        let may_forget = self.state != State::QuickStop && (self.state != State::Fault || !self.on);
        let forgets = self.clear_left == 1 && may_forget;
        let kept = if forgets { 0 } else { self.causes };
        let causes = kept | self.active(inputs, group_stop);
        let cut = switching_off(causes, inputs.off_causes) != 0;
        let fault = causes & !HARMLESS != 0;
        let segments_hold = inputs.segments_state == segments::State::Hold as u8;
        let stopped = inputs.segments_state == segments::State::Stopped as u8;
        let elapsed = self.timer == 0;
        let opened = !self.opening || elapsed;
        let able = self.state == State::Hold && opened && !self.closing && segments_hold;
        let wants_start = (inputs.start || self.start_waits) && !inputs.stop;
        let conditions = Conditions::default()
            .with(Condition::Cut, cut)
            .with(Condition::Fault, fault)
            .with(Condition::Cause, causes != 0)
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
            .with(Condition::Cleared, forgets && causes == 0);
        Now {
            causes,
            cut,
            group_stop,
            wants_start,
            able,
            stopped,
            timed_out: inputs.tick && elapsed,
            closes: self.state == State::Hold && inputs.tick && elapsed && !inputs.enable && !self.closing,
            conditions,
        }
    }

    fn pulses(&self, inputs: &Inputs, now: &Now, after: State) -> Pulses {
        use State::{Fault, Hold, Off, QuickStop, Ready, Run};
        let before = self.state;
        let plays = inputs.segments_state <= segments::State::Move as u8;
        let steady = inputs.enable && !now.group_stop && now.causes == 0;
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

    /// The timer begins with a state, and counts ticks; in QUICK_STOP those after the segments' stop.
    fn run_timer(&mut self, inputs: &Inputs, now: &Now, after: State) {
        use State::{Fault, Hold, QuickStop, Ready, Run};
        let before = self.state;
        let counts = inputs.tick && (before != QuickStop || now.stopped);
        self.timer = match (before, after) {
            (Ready, Hold) => inputs.brake_release_ticks,
            (Run, Hold) | (Hold | Run, QuickStop) => inputs.settle_ticks,
            (QuickStop, Fault) => inputs.brake_apply_ticks,
            (Hold, Hold) if now.closes => inputs.brake_apply_ticks,
            _ => self.timer.saturating_sub(u16::from(counts)),
        };
    }

    /// Outputs and brake.
    fn switch(&mut self, now: &Now, after: State) {
        use State::{Fault, Hold, QuickStop, Ready};
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

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    let port = |direction| {
        move |&(name, width, signed): &(&str, u32, bool)| Port {
            name: name.to_owned(),
            direction,
            width,
            signed,
        }
    };
    let inputs = inputs::INPUTS.iter().map(port(Direction::Input));
    inputs
        .chain(outputs::OUTPUTS.iter().map(port(Direction::Output)))
        .collect()
}

impl ClockedBlock for Axis {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), OUTPUT_PORTS) = (<&[u64; INPUT_PORTS]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the axis has {INPUT_PORTS} and {OUTPUT_PORTS}",
                inputs.len(),
                outputs.len()
            )));
        };
        let shown = Axis::step(self, &Inputs::from_raw(raw));
        outputs.copy_from_slice(&shown.to_raw());
        Ok(())
    }
}

impl Moore for Axis {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip(self.outputs().to_raw()) {
            *output = value;
        }
    }
}
