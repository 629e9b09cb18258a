//! The PWM: a duty to the gates of a bridge, with dead time, minimum pulse, fault path and watchdog.
//!
//! The datasheet is `docs/pwm.md`; this is the reference that the hardware is compared with.
//!
//! | part | what it does |
//! |---|---|
//! | [`PwmConfig`] | polarities and floors, fixed when the PWM is built |
//! | `command` | duty and mode to the width of a pulse, in the two clocks before a boundary |
//! | [`Pwm`] | the carrier, what is latched at its boundaries, and the ports |
//! | `leg` | dead time and minimum pulse, from any state |
//! | `quiet` | the clocks in which only the carrier and a timer count |
//! | `trip` | fault latch, filtered faults, PLL, watchdog |
//! | [`pulses`] | the pin rule as a pure function: the edges of half a period, without clocks |
//!
//! [`Pwm::step`] is one clock; [`Pwm::hold`] is many with the same inputs, and goes from event to event.
//!
//! ```
//! use posicast_model::rtl::pwm::{ActiveLow, Inputs, Pwm, PwmConfig};
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
//! # Ok::<(), posicast_model::rtl::pwm::PwmConfigError>(())
//! ```

mod command;
mod config;
mod leg;
mod ports;
pub mod pulses;
mod quiet;
mod trip;

pub use config::{ActiveLow, PwmConfig, PwmConfigError, TIME_BITS};
pub use ports::{Gates, INPUTS, Inputs, Mode, OUTPUTS, Outputs, ports};

use self::command::{Limited, Width};
use self::leg::{Leg, Want};
use self::trip::Trip;
use super::{ClockedBlock, Port, StepError};

/// Clocks before a boundary at which duty and mode are read.
pub const COMMAND_CLOCKS: u32 = 2;

/// What the leg does until the next boundary.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Pattern {
    /// All is off.
    #[default]
    Off,
    /// The low side is on.
    Low,
    /// The high side is on.
    High,
    /// The sides change over in each half of the period.
    Pulse,
}

/// Everything that is a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct State {
    position: u16,
    period: u16,
    dead_time: u16,
    minimum_pulse: u16,
    limited: Limited,
    width: Width,
    /// Latched at the last boundary with an update.
    mode: Mode,
    negative: bool,
    pattern: Pattern,
    pulse_clocks: i32,
    /// Position at which the sides change over.
    edge_at: u16,
    /// Within a pulse, before dead time and minimum.
    level: bool,
    leg: Leg,
    gates: Gates,
    running: bool,
    /// Whether the times in use stood at the inputs, one and two clocks ago.
    settled: [bool; 2],
    /// `mask_pins` of the clock before.
    masked: bool,
    trip: Trip,
    /// The carrier is at its valley, its peak, the trigger's phase; one clock later the pins are.
    at_valley: bool,
    at_peak: bool,
    at_trigger: bool,
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
            // The shortest, so that the first one set comes into use at once.
            period: 1,
            dead_time: config.dead_time_floor_clocks(),
            minimum_pulse: config.minimum_pulse_floor_clocks(),
            limited: Limited::default(),
            width: Width::default(),
            mode: Mode::default(),
            negative: false,
            pattern: Pattern::Off,
            pulse_clocks: 0,
            edge_at: 0,
            level: false,
            leg: Leg::default(),
            gates: Gates::default(),
            running: false,
            settled: [false; 2],
            masked: false,
            trip: Trip::default(),
            at_valley: false,
            at_peak: false,
            at_trigger: false,
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

/// The PWM, cycle accurate at its ports.
pub struct Pwm {
    config: PwmConfig,
    ports: Vec<Port>,
    state: State,
}

impl Pwm {
    /// A PWM after reset: off, and tripped until the first [`Inputs::clear_trip`].
    pub fn new(config: &PwmConfig) -> Self {
        Self {
            config: *config,
            ports: ports(),
            state: State::new(config),
        }
    }

    /// What the outputs show now. The raw inputs of this moment act on the pins without a clock.
    #[inline]
    pub fn outputs(&self, inputs: &Inputs) -> Outputs {
        let state = &self.state;
        let on = state.trip.armed(inputs) && !state.masked;
        let off = self.config.active_low();
        Outputs {
            a_high: (state.gates.a_high && on) != off.a_high,
            a_low: (state.gates.a_low && on) != off.a_low,
            b_high: (state.gates.b_high && on) != off.b_high,
            b_low: (state.gates.b_low && on) != off.b_low,
            running: state.running,
            tripped: state.trip.tripped(),
            trip_causes: state.trip.causes(),
            negative: state.negative,
            valley: state.valley,
            peak: state.peak,
            trigger: state.trigger,
            saturated: state.saturated,
            refused: state.refused,
            below_floor: state.below_floor,
            unaligned: state.unaligned,
            dead_time_used: state.dead_time,
            minimum_pulse_used: state.minimum_pulse,
            gates: state.gates,
        }
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs(inputs);
        self.state.clock(&self.config, inputs);
        outputs
    }

    /// So many clocks with the same inputs: the fast path. It goes from event to event; between two of them only the carrier
    /// and a timer count.
    pub fn hold(&mut self, inputs: &Inputs, clocks: u64) {
        let mut left = clocks;
        while left > 0 {
            let before = self.state;
            self.state.clock(&self.config, inputs);
            left -= 1;
            let skipped = self.state.more_of(&before, inputs).unwrap_or(0).min(left);
            left -= skipped;
            let state = &mut self.state;
            // At most the distance to a position of 16 bits, and to the end of the timer.
            state.position = state.position.wrapping_add(skipped as u16);
            if state.leg.timer != before.leg.timer {
                state.leg.timer -= skipped as u16;
            }
        }
    }
}

impl State {
    fn clock(&mut self, config: &PwmConfig, inputs: &Inputs) {
        let state = self;
        if inputs.rst {
            *state = State::new(config);
            return;
        }
        let next = state.position.wrapping_add(1);
        let valley = next == state.period;
        let peak = next == state.period >> 1 && !valley;
        let next = if valley { 0 } else { next };
        let out_of_step = inputs.sync && next != inputs.phase;
        let realigns = out_of_step && !state.running;

        let floors = (config.dead_time_floor_clocks(), config.minimum_pulse_floor_clocks());
        let (dead_time, minimum_pulse) = (inputs.dead_time & 0x3ff, inputs.minimum_pulse & 0x3ff);
        let low = dead_time < floors.0 || minimum_pulse < floors.1;
        let (dead_time, minimum_pulse) = (dead_time.max(floors.0), minimum_pulse.max(floors.1));
        let settled = (state.dead_time, state.minimum_pulse, state.period) == (dead_time, minimum_pulse, inputs.period);

        let was_running = state.running;
        let may_run = inputs.enable && !state.trip.tripped();
        let goes_on = was_running && may_run;
        let starts = !was_running && may_run && valley && settled && state.settled == [true; 2] && !realigns;

        // The gates, for the present position.
        state.level ^= state.position == state.edge_at;
        let want = match (goes_on, state.pattern, state.level) {
            (false, ..) | (_, Pattern::Off, _) => Want::Off,
            (_, Pattern::Low, _) | (_, Pattern::Pulse, false) => Want::Low,
            (_, Pattern::High, _) | (_, Pattern::Pulse, true) => Want::High,
        };
        let low_first = state.mode == Mode::Direction;
        state.leg.clock(want, low_first, state.dead_time, state.minimum_pulse);
        state.gates = Gates::of(state.mode, state.negative, state.leg.awake(), state.leg.sides());

        let updates = valley || (peak && inputs.update_at_peak);
        if inputs.clear_flags {
            (state.saturated, state.refused) = (false, false);
            (state.below_floor, state.unaligned) = (false, false);
        }
        state.saturated |= updates && goes_on && state.width.saturated;
        state.refused |= was_running && !settled;
        state.below_floor |= inputs.enable && low;
        state.unaligned |= was_running && out_of_step;

        if updates {
            state.latch(goes_on);
        }
        if valley || peak {
            state.plan_edge(peak);
        }
        state.width = Width::new(&state.limited, state.period, state.dead_time);
        state.limited = Limited::new(inputs);

        state.trip.clock(inputs, was_running, valley);
        state.running = goes_on || starts;
        if !was_running {
            (state.dead_time, state.minimum_pulse) = (dead_time, minimum_pulse);
            if valley {
                state.period = inputs.period;
            }
        }
        state.masked = inputs.mask_pins;
        state.settled = [settled, state.settled[0]];
        (state.valley, state.peak, state.trigger) = (state.at_valley, state.at_peak, state.at_trigger);
        (state.at_valley, state.at_peak) = (valley && !realigns, peak && !realigns);
        state.at_trigger = next == inputs.trigger_phase && !realigns;
        state.position = if realigns { inputs.phase } else { next };
    }

    /// Takes duty and mode at a boundary. `goes_on`: the outputs were on and stay on.
    fn latch(&mut self, goes_on: bool) {
        let width = self.width;
        let longest = i32::from(self.period) - 2 * i32::from(self.dead_time) - i32::from(self.minimum_pulse);
        let none = width.clocks < i32::from(self.minimum_pulse);
        let full = width.clocks > longest;
        let turns = width.mode.has_direction() && !none && width.negative != self.negative;
        self.pattern = if goes_on && width.mode != self.mode {
            Pattern::Off
        } else if none || (turns && !self.leg.may_turn()) {
            Pattern::Low
        } else if full {
            Pattern::High
        } else {
            Pattern::Pulse
        };
        self.negative ^= turns && self.leg.may_turn();
        self.mode = width.mode;
        self.pulse_clocks = width.clocks;
    }

    /// Half the pulse lies before the peak, half behind it; an odd clock behind it.
    fn plan_edge(&mut self, falling: bool) {
        let half_period = i32::from(self.period >> 1);
        let (half_pulse, odd) = (self.pulse_clocks >> 1, self.pulse_clocks & 1);
        let edge_at = if falling {
            half_period + half_pulse + odd
        } else {
            half_period - i32::from(self.dead_time) - half_pulse
        };
        self.edge_at = edge_at as u16;
        self.level = falling;
    }
}

impl ClockedBlock for Pwm {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), OUTPUTS) = (<&[u64; INPUTS]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the PWM has {INPUTS} and {OUTPUTS}",
                inputs.len(),
                outputs.len()
            )));
        };
        let shown = Pwm::step(self, &Inputs::from_raw(raw));
        outputs.copy_from_slice(&shown.to_raw());
        Ok(())
    }
}
