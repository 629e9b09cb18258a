//! The drive command selects what the PWM gets: the controller's duty, in direct mode a manual one, or 0.
//!
//! The datasheet is `docs/drive_command.md`; the hardware is compared with this reference model.
//!
//! - **Normal mode**: the outputs are the supervisor's, a clock later. A duty of the controller is saturated to 17
//!   bits and taken with `controller_valid`; while the PWM is off it is 0.
//! - **Direct mode**, for bring-up: it is possible in READY only, with `direct_enable`. A `direct_kick` starts it for
//!   the number of ticks that `direct_hold_ticks` has then. All outputs are on; each tick takes `direct_duty`, limited
//!   to a magnitude of `direct_limit`. When the sign changes the duty is 0 for a tick; on a limit switch the duty in
//!   its direction is 0 at once.
//! - `drive_fault_n` is asynchronous: it passes one register without reset on its way to the synchroniser in the PWM.
//! - A change between the two modes begins with a duty of 0.
//! - **Self-test** of the PWM: direct mode with `self_test` masks the pins and leaves drive and brake off. Only the
//!   PWM runs, and the clocks in which its gates of leg A are on are counted. A change of `self_test` ends direct
//!   mode. The mask stays for the first clock in which `pwm_enable` is low again, and there is always such a clock.
//!
//! ```text
//! clock           0    1             100  101            200  201
//! direct_kick    ‾‾‾‾\____________________________________________      direct_hold_ticks = 2
//! tick           ____________________/‾‾‾\_______________/‾‾‾\____
//! direct_active  ____/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____      and pwm_enable, drive_enable, brake_release
//! duty           0 ----------------------< direct_duty ------>< 0
//! direct_expired ____________________________________________/‾‾‾\      clock 201
//! ```
//!
//! ```
//! use posicast_blocks::axis::SupervisorState;
//! use posicast_blocks::drive_command::{DriveCommand, Inputs};
//!
//! let mut command = DriveCommand::new();
//! let inputs = Inputs {
//!     axis_state: SupervisorState::Ready as u8,
//!     limit_plus_ok: true,
//!     limit_minus_ok: true,
//!     direct_enable: true,
//!     direct_hold_ticks: 2,
//!     direct_duty: -1000,
//!     direct_limit: 300,
//!     ..Inputs::default()
//! };
//! command.step(&Inputs { direct_kick: true, ..inputs });
//! assert!(command.outputs().pwm_enable);
//! command.step(&Inputs { tick: true, ..inputs }); // the sign turns: 0 for a tick
//! command.step(&Inputs { tick: true, direct_kick: true, ..inputs });
//! assert_eq!(command.outputs().duty, -300);
//! command.step(&Inputs { axis_state: SupervisorState::Off as u8, ..inputs });
//! assert_eq!((command.outputs().duty, command.outputs().pwm_enable), (0, false));
//! ```

mod ports;

pub use ports::{
    CONTROLLER_DUTY_BITS, DUTY_BITS, DUTY_MAX, DUTY_MIN, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports,
};

use super::axis::SupervisorState;
use super::shaper::wrap;
use super::{Moore, clocked_block, quiet_at_rest, show_each};

/// Saturates the controller's duty to the PWM's 17 bits.
pub fn saturated(controller_duty: i32) -> i32 {
    (wrap(i64::from(controller_duty), CONTROLLER_DUTY_BITS) as i32).clamp(DUTY_MIN, DUTY_MAX)
}

/// The manual duty, with a magnitude of at most `limit`.
pub fn limited(direct_duty: i32, limit: u16) -> i32 {
    let limit = i32::from(limit);
    (wrap(i64::from(direct_duty), DUTY_BITS) as i32).clamp(-limit, limit)
}

/// The cycle-accurate model of the drive command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DriveCommand {
    /// Ticks until direct mode expires; meaningless outside it.
    ticks_left: u16,
    /// Whether the last manual duty that was requested is negative.
    backward: bool,
    /// Clocks of this period in which a gate was on: `a_high`, `a_low`.
    on_clocks: [u16; 2],
    shown: Outputs,
}

impl Default for DriveCommand {
    fn default() -> Self {
        Self::new()
    }
}

impl DriveCommand {
    /// The block at power-up.
    pub fn new() -> Self {
        Self {
            ticks_left: 0,
            backward: false,
            on_clocks: [0; 2],
            shown: Outputs::at_power_up(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.shown
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.shown;
        if inputs.rst {
            (self.ticks_left, self.backward) = (0, false);
            self.on_clocks = [0; 2];
            self.shown = Outputs {
                filtered_fault_n: 1 | u8::from(inputs.drive_fault_n) << 1,
                ..Outputs::default()
            };
            return shown;
        }
        let test_changes = shown.direct_active && inputs.self_test != shown.mask_pins;
        let permitted = inputs.axis_state == SupervisorState::Ready as u8 && inputs.direct_enable && !test_changes;
        let expires = inputs.tick && self.ticks_left == 1;
        let direct = permitted
            && if inputs.direct_kick {
                inputs.direct_hold_ticks > 0
            } else {
                shown.direct_active && !expires
            };
        let tests = direct && inputs.self_test;
        let tested = shown.direct_active && shown.mask_pins;
        let [self_test_high, self_test_low] = self.count(inputs);
        self.shown = Outputs {
            duty: self.next_duty(inputs, direct),
            feed: if shown.direct_active {
                inputs.tick
            } else {
                inputs.controller_valid
            },
            pwm_enable: (inputs.axis_pwm_enable && !tested) || direct,
            drive_enable: (inputs.axis_drive_enable || direct) && !tests,
            brake_release: (inputs.axis_brake_release || direct) && !tests,
            filtered_fault_n: u8::from(inputs.axis_pwm_trip_n) | u8::from(inputs.drive_fault_n) << 1,
            direct_active: direct,
            direct_expired: shown.direct_active && permitted && !inputs.direct_kick && expires,
            mask_pins: tests || tested,
            self_test_high,
            self_test_low,
        };
        if inputs.direct_kick {
            self.ticks_left = inputs.direct_hold_ticks;
        } else if inputs.tick {
            self.ticks_left = self.ticks_left.wrapping_sub(1);
        }
        if inputs.tick {
            self.backward = inputs.direct_duty & (1 << (DUTY_BITS - 1)) != 0;
        }
        shown
    }

    /// Counts the gates while the pins are masked, and returns the results after this clock.
    fn count(&mut self, inputs: &Inputs) -> [u16; 2] {
        let results = [self.shown.self_test_high, self.shown.self_test_low];
        if !self.shown.mask_pins {
            self.on_clocks = [0; 2];
            return results;
        }
        let counted = self.on_clocks;
        for (gate, clocks) in self.on_clocks.iter_mut().enumerate() {
            let before = if inputs.valley { 0 } else { *clocks };
            *clocks = before.saturating_add((inputs.gates >> gate & 1).into());
        }
        if inputs.valley { counted } else { results }
    }

    /// Returns the duty after this clock. `direct`: direct mode is on after it.
    fn next_duty(&self, inputs: &Inputs, direct: bool) -> i32 {
        let Outputs {
            duty, direct_active, ..
        } = self.shown;
        if direct != direct_active || !(direct || inputs.axis_pwm_enable) {
            return 0;
        }
        if !direct {
            return if inputs.controller_valid {
                saturated(inputs.controller_duty)
            } else {
                duty
            };
        }
        let on_switch = if self.backward {
            !inputs.limit_minus_ok
        } else {
            !inputs.limit_plus_ok
        };
        let wanted = limited(inputs.direct_duty, inputs.direct_limit);
        let turns = (wrap(i64::from(inputs.direct_duty), DUTY_BITS) < 0) != self.backward;
        match (inputs.tick, on_switch || (inputs.tick && turns)) {
            (_, true) => 0,
            (true, false) => wanted,
            (false, false) => duty,
        }
    }
}

clocked_block!(DriveCommand, "the drive command");

impl Moore for DriveCommand {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            DriveCommand::step(next, &Inputs::from_raw(raw));
        })
    }
}
