//! The PWM turns a duty into the gates of a bridge, with dead time, minimum pulse, fault path and watchdog.
//!
//! The datasheet is `docs/pwm.md`; the hardware is compared with this reference model.
//!
//! | part | what it does |
//! |---|---|
//! | [`PwmConfig`] | the build parameters: polarities and lower limits |
//! | `command` | computes pattern and edges from duty and mode in the 16 clocks before a boundary, then counts the clocks to an edge |
//! | [`Pwm`] | the carrier, what is latched at its boundaries, and the ports |
//! | `leg` | dead time and minimum pulse, from any state |
//! | `quiet` | the clocks in which only the carrier and a timer count |
//! | `trip` | fault latch, filtered faults, PLL, watchdog |
//! | [`pulses`] | the pin rule as a pure function: the edges of half a period, without clocks |
//!
//! [`Pwm::step`] simulates one clock; [`Pwm::hold`] simulates many with the same inputs, and goes from event to
//! event.
//!
//! ```
//! use posicast_blocks::pwm::{ActiveLow, Inputs, Pwm, PwmConfig};
//!
//! // 20 kHz from 50 MHz, half bridge, 25 clocks of dead time.
//! let mut pwm = Pwm::new(&PwmConfig::new(ActiveLow::default(), 25, 50)?);
//! let inputs = Inputs {
//!     enable: true,
//!     mode: 1,
//!     period: 2500,
//!     duty: 1000,
//!     max_duty: 2500,
//!     fault_n: true,
//!     pll_locked: true,
//!     filtered_fault_n: 3,
//!     clear_trip: true,
//!     ..Inputs::default()
//! };
//! pwm.hold(&inputs, 10_000);
//! let high = (0..2500).filter(|_| pwm.step(&inputs).a_high).count();
//! assert_eq!(high, 1000 - 25);
//! # Ok::<(), posicast_blocks::pwm::PwmConfigError>(())
//! ```

mod command;
mod config;
mod leg;
mod ports;
pub mod pulses;
mod quiet;
mod trip;

pub use config::{ActiveLow, PwmConfig, PwmConfigError, TIME_BITS};
pub use ports::{BridgeMode, Gates, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use self::command::{Command, Surroundings};
use self::leg::{Leg, Want};
use self::trip::Trip;
use super::clocked_block;

/// Clocks before a boundary at which duty and mode are read.
pub const COMMAND_CLOCKS: u32 = 15;

/// The shortest period with both boundaries, in clocks. A shorter period has no peak; one shorter than half of this
/// lasts 65,536 clocks longer.
pub const SHORTEST_PERIOD_CLOCKS: u32 = 64;

/// Clocks from a valley's lead to the valley; a peak's lead is half as long.
const LEAD_CLOCKS: u16 = 32;

/// Pattern of the leg until the next boundary.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Pattern {
    /// Both sides are off.
    #[default]
    Off,
    /// The low side is on.
    Low,
    /// The high side is on.
    High,
    /// The sides change over in each half of the period.
    Pulse,
}

/// All registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct State {
    position: u16,
    period: u16,
    dead_time: u16,
    minimum_pulse: u16,
    command: Command,
    /// Mode, latched at the last boundary with an update.
    mode: BridgeMode,
    negative: bool,
    pattern: Pattern,
    leg: Leg,
    gates: Gates,
    running: bool,
    /// Whether the inputs have kept the times in use since the computation of the command began.
    stable: bool,
    /// `sync` of the clock before.
    synced: bool,
    /// Whether the carrier may be out of phase: a `sync` came at another phase, or none has come since the period
    /// changed.
    astray: bool,
    /// Whether there is a time base: by build parameter, or because a `sync` came.
    timed: bool,
    /// `mask_pins` of the clock before.
    masked: bool,
    trip: Trip,
    /// Whether the carrier is at its valley, and at its peak; the pins are there one clock later.
    at_valley: bool,
    at_peak: bool,
    valley: bool,
    peak: bool,
    trigger: bool,
    saturated: bool,
    refused: bool,
    below_floor: bool,
    unaligned: bool,
}

impl State {
    fn new(config: &PwmConfig) -> Self {
        Self {
            position: 0,
            // The shortest period, so that the first one set soon comes into use.
            period: LEAD_CLOCKS,
            dead_time: config.dead_time_floor_clocks(),
            minimum_pulse: config.minimum_pulse_floor_clocks(),
            command: Command::default(),
            mode: BridgeMode::default(),
            negative: false,
            pattern: Pattern::Off,
            leg: Leg::default(),
            gates: Gates::default(),
            running: false,
            stable: false,
            synced: false,
            astray: config.is_on_time_base(),
            timed: config.is_on_time_base(),
            masked: false,
            trip: Trip::default(),
            at_valley: false,
            at_peak: false,
            valley: false,
            peak: false,
            trigger: false,
            saturated: false,
            refused: false,
            below_floor: false,
            unaligned: false,
        }
    }
}

/// The cycle-accurate model of the PWM.
pub struct Pwm {
    config: PwmConfig,
    state: State,
}

impl Pwm {
    /// A PWM after reset: off, and tripped until the first [`Inputs::clear_trip`].
    pub fn new(config: &PwmConfig) -> Self {
        Self {
            config: *config,
            state: State::new(config),
        }
    }

    /// The outputs in this clock. The raw inputs act on the pins in the same clock.
    #[inline]
    pub fn outputs(&self, inputs: &Inputs) -> Outputs {
        self.state.outputs(self.config.active_low(), inputs)
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs(inputs);
        self.state.clock(&self.config, inputs);
        outputs
    }

    /// Simulates this many clocks with the same inputs, from event to event; between two events only the carrier and
    /// a timer count, or nothing does while the carrier waits.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        let mut left = clocks;
        while left > 0 {
            let before = self.state;
            self.state.clock(&self.config, inputs);
            if self.state == before {
                return;
            }
            left -= 1;
            let skipped = self.state.more_of(&before, inputs).unwrap_or(0).min(left);
            left -= skipped;
            self.state.count(skipped as u16);
        }
    }
}

impl State {
    #[inline]
    fn outputs(&self, off: ActiveLow, inputs: &Inputs) -> Outputs {
        let on = self.trip.armed(inputs) && !self.masked;
        Outputs {
            a_high: (self.gates.a_high && on) != off.a_high,
            a_low: (self.gates.a_low && on) != off.a_low,
            b_high: (self.gates.b_high && on) != off.b_high,
            b_low: (self.gates.b_low && on) != off.b_low,
            running: self.running,
            tripped: self.trip.tripped(),
            trip_causes: self.trip.causes(),
            negative: self.negative,
            valley: self.valley,
            peak: self.peak,
            trigger: self.trigger,
            saturated: self.saturated,
            refused: self.refused,
            below_floor: self.below_floor,
            unaligned: self.unaligned,
            dead_time_used: self.dead_time,
            minimum_pulse_used: self.minimum_pulse,
            gates: self.gates,
        }
    }

    fn clock(&mut self, config: &PwmConfig, inputs: &Inputs) {
        let state = self;
        if inputs.rst {
            *state = State::new(config);
            return;
        }
        let lead = state.period.wrapping_sub(LEAD_CLOCKS);
        let in_phase = state.position == inputs.phase;
        let waits = state.waits(inputs);
        let out_of_step = state.synced && !in_phase;
        let ends = state.command.ends() && !waits;
        let (valley, peak) = (ends && state.command.rises, ends && !state.command.rises);

        let floors = (config.dead_time_floor_clocks(), config.minimum_pulse_floor_clocks());
        let (dead_time, minimum_pulse) = (inputs.dead_time & 0x3ff, inputs.minimum_pulse & 0x3ff);
        let low = dead_time < floors.0 || minimum_pulse < floors.1;
        let (dead_time, minimum_pulse) = (dead_time.max(floors.0), minimum_pulse.max(floors.1));
        // With no slack a leg that is late once would stay late.
        let no_slack = inputs.period == 2 * (state.dead_time + state.minimum_pulse);
        let settled = (state.dead_time, state.minimum_pulse, state.period) == (dead_time, minimum_pulse, inputs.period);

        let was_running = state.running;
        let may_run = inputs.enable && !state.trip.tripped();
        let goes_on = was_running && may_run;
        let starts = !was_running && may_run && valley && settled && state.stable && !state.astray && !no_slack;

        // The gates are those for the present position.
        let want = match (goes_on, state.pattern, state.command.level) {
            (false, ..) | (_, Pattern::Off, _) => Want::Off,
            (_, Pattern::Low, _) | (_, Pattern::Pulse, false) => Want::Low,
            (_, Pattern::High, _) | (_, Pattern::Pulse, true) => Want::High,
        };
        let low_first = state.mode == BridgeMode::Direction;
        state.leg.clock(want, low_first, state.dead_time, state.minimum_pulse);
        state.gates = Gates::of(state.mode, state.negative, state.leg.awake(), state.leg.sides());

        let updates = state.command.updates() && !waits;
        if inputs.clear_flags {
            (state.saturated, state.refused) = (false, false);
            (state.below_floor, state.unaligned) = (false, false);
        }
        state.saturated |= updates && goes_on && state.command.saturated();
        state.refused |= was_running && !settled;
        state.below_floor |= inputs.enable && (low || (settled && no_slack));
        state.unaligned |= was_running && out_of_step;

        if updates {
            state.latch(goes_on);
        }
        state.trigger = state.position == inputs.trigger_phase && !waits;
        state.stable = settled && (state.stable || !state.command.works);
        if !waits {
            let around = Surroundings {
                period: match state.period {
                    0 => 1 << 16,
                    period => i32::from(period),
                },
                dead_time: state.dead_time,
                minimum_pulse: state.minimum_pulse,
                valley_lead: state.position == lead,
                peak_lead: state.position == lead >> 1,
            };
            state.command.clock(inputs, &around);
            state.position = if valley { 0 } else { state.position.wrapping_add(1) };
        }
        // While off, the carrier waits there for the next boundary; with another period it is in phase only by
        // chance.
        let other_period = !was_running && valley && state.period != inputs.period && state.timed;
        state.astray = out_of_step || other_period || (state.astray && !(waits && inputs.sync));
        state.synced = inputs.sync;
        state.timed |= inputs.sync;

        state.trip.clock(inputs, was_running, valley);
        state.running = goes_on || starts;
        if !was_running {
            (state.dead_time, state.minimum_pulse) = (dead_time, minimum_pulse);
            if valley {
                state.period = inputs.period;
            }
        }
        state.masked = inputs.mask_pins;
        (state.valley, state.peak) = (state.at_valley, state.at_peak);
        (state.at_valley, state.at_peak) = (valley, peak);
    }

    /// Whether the carrier waits where it is in phase, for its time base.
    fn waits(&self, inputs: &Inputs) -> bool {
        self.astray && self.position == inputs.phase && !self.running
    }

    /// Takes duty and mode at a boundary. `goes_on`: the outputs were on and stay on.
    fn latch(&mut self, goes_on: bool) {
        let command = self.command;
        let (none, full) = (command.too_short, command.too_long);
        let turns = command.mode.has_direction() && !none && command.negative() != self.negative;
        self.pattern = if goes_on && command.mode != self.mode {
            Pattern::Off
        } else if none || (turns && !self.leg.may_turn()) {
            Pattern::Low
        } else if full {
            Pattern::High
        } else {
            Pattern::Pulse
        };
        self.negative ^= turns && self.leg.may_turn();
        self.mode = command.mode;
    }
}

clocked_block!(Pwm, "the PWM");
