//! The supervisor of an axis switches its outputs, starts and stops its command, and reacts to faults.
//!
//! The datasheet is `docs/axis.md`; the hardware is compared with this reference model.
//!
//! | part | what it does |
//! |---|---|
//! | [`TRANSITIONS`], [`next`] | the states, as data |
//! | [`Cause`], [`switching_off`] | the causes of a fault, and which of them switch off |
//! | `monitors` | checks at ticks: limits, soft limits, following error and others |
//! | `timer` | the times of brake and shaper |
//! | `registers` | lines, sticky causes, the state and brake, clock by clock |
//! | [`Axis`] | the ports |
//!
//! [`Axis::step`] simulates one clock; [`Axis::hold`] simulates many with the same inputs, and skips those that do not
//! change the state.
//!
//! ```
//! use posicast_blocks::axis::{Axis, Inputs, SupervisorState};
//!
//! let mut axis = Axis::new();
//! let good = Inputs { emergency_stop_n: true, drive_ready: true, ..Inputs::default() };
//! axis.hold(&good, 20);
//! assert_eq!(axis.outputs().state, SupervisorState::Ready);
//! axis.step(&Inputs { enable: true, tick: true, ..good });
//! assert_eq!((axis.outputs().state, axis.outputs().pwm_enable), (SupervisorState::Hold, true));
//! // The emergency stop's wire breaks: five clocks without a filter.
//! axis.hold(&Inputs { emergency_stop_n: false, enable: true, ..good }, 4);
//! assert_eq!((axis.outputs().state, axis.outputs().pwm_enable), (SupervisorState::Fault, false));
//! ```

mod cause;
mod clocks;
mod monitors;
mod ports;
mod registers;
mod timer;
mod transition;

pub use cause::{ALWAYS_OFF, AT_ONCE, CAUSE_BITS, Cause, DOUBTFUL, HARMLESS, switching_off};
pub use clocks::{CLEAR_CLOCKS, KICK, LEAST_TICK_CLOCKS, LINE_CLOCKS, PRIMING_CLOCKS, WATCH_CLOCKS};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};
pub use transition::{Condition, Conditions, SupervisorState, TRANSITIONS, Transition, next};

use self::registers::Registers;
use super::{FOREVER, Moore, clocked_block, show_each};

/// The cycle-accurate model of the supervisor.
#[derive(Debug, Clone)]
pub struct Axis {
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
            registers: Registers::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let registers = &self.registers;
        let pulses = registers.pulses;
        let [emergency_stop_n, limit_plus_n, limit_minus_n, drive_ready, home] =
            [0, 1, 2, 3, 4].map(|line: usize| registers.level(line));
        Outputs {
            state: registers.state,
            causes: registers.causes,
            drive_enable: registers.on,
            brake_release: registers.released,
            pwm_enable: registers.on,
            pwm_trip_n: !registers.tripping,
            segments_enable: registers.state == SupervisorState::Run,
            segments_preset: !registers.on,
            segments_quick_stop: pulses.quick_stop,
            segments_restart: pulses.restart,
            shaper_start: registers.starting,
            clear_integral: registers.starting,
            clear_sources: pulses.clear_sources,
            wants_group_stop: registers.wants_group_stop(),
            emergency_stop: registers.emergency_stop(),
            can_start: pulses.can_start,
            homed: registers.homed,
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

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        self.registers.clock(inputs);
        outputs
    }

    /// Simulates this many clocks with the same inputs. It ends early once a clock changes nothing, since no later
    /// one would.
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

clocked_block!(Axis, "the axis");

impl Moore for Axis {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    /// Tries one clock: if it changes nothing, the following ones do not either.
    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        if inputs.rst || inputs.tick || inputs.kick {
            return 0;
        }
        let mut next = self.registers.clone();
        next.clock(&inputs);
        if next == self.registers { FOREVER } else { 0 }
    }

    /// Inputs that are read only at ticks, and the word of a kick.
    fn ignores(&self, input: &str) -> bool {
        matches!(
            input,
            "position"
                | "error"
                | "command"
                | "deviation"
                | "limited_ticks"
                | "command_velocity"
                | "reference_position"
                | "reference_velocity"
                | "kick_word"
        )
    }
}
