//! What the PWM is told: the controller's duty, or in direct mode a manual one, or nothing.
//!
//! The datasheet is `docs/drive_command.md`; this is the reference that the hardware is compared with.
//!
//! - **Normal**: the outputs are the supervisor's, a clock later. A duty of the controller is saturated to 17 bits and taken
//!   with `controller_valid`; while the PWM is off it is 0.
//! - **Direct mode**, for bring-up: in READY alone, with `direct_enable`, from a `direct_kick` until as many ticks have come as
//!   `direct_hold_ticks` said then. All outputs are on; each tick takes `direct_duty`, at most `direct_limit` in size. A sign
//!   that turns is 0 for a tick; on a limit switch the duty is 0 in its direction, at once.
//! - A change between the two, either way, begins with a duty of 0.
//! - **Self-test** of the PWM: direct mode with `self_test` masks the pins and leaves drive and brake off. Only the PWM runs,
//!   and the clocks that its gates of leg A are on are counted. A change of `self_test` ends direct mode. The mask stays for
//!   the first clock in which `pwm_enable` is low again, and that clock there always is.
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
//! use posicast_model::rtl::axis::State;
//! use posicast_model::rtl::drive_command::{DriveCommand, Inputs};
//!
//! let mut command = DriveCommand::new();
//! let inputs = Inputs {
//!     axis_state: State::Ready as u8,
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
//! command.step(&Inputs { axis_state: State::Off as u8, ..inputs });
//! assert_eq!((command.outputs().duty, command.outputs().pwm_enable), (0, false));
//! ```

use std::sync::Arc;

use super::axis::State;
use super::shaper::wrap;
use super::{ClockedBlock, Direction, Moore, Port, StepError, quiet_at_rest};

/// Width of the controller's duty.
pub const CONTROLLER_DUTY_BITS: u32 = 18;
/// Width of the PWM's duty.
pub const DUTY_BITS: u32 = 17;
/// Largest duty of the PWM.
pub const DUTY_MAX: i32 = (1 << (DUTY_BITS - 1)) - 1;
/// Smallest duty of the PWM.
pub const DUTY_MIN: i32 = -DUTY_MAX - 1;

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: the tick.
    pub tick: bool,
    /// Of the controller, in clocks of the PWM, 18 bits.
    pub controller_duty: i32,
    /// One clock: `controller_duty` is new.
    pub controller_valid: bool,
    /// Of the supervisor, 3 bits.
    pub axis_state: u8,
    /// Of the supervisor: PWM on.
    pub axis_pwm_enable: bool,
    /// Of the supervisor: drive on.
    pub axis_drive_enable: bool,
    /// Of the supervisor: brake open.
    pub axis_brake_release: bool,
    /// Of the supervisor: low is an emergency stop.
    pub axis_pwm_trip_n: bool,
    /// Pin, at any time: low, or a broken wire, is a fault of the drive.
    pub drive_fault_n: bool,
    /// Filtered limit switch +: low is on the switch.
    pub limit_plus_ok: bool,
    /// Filtered limit switch −: low is on the switch.
    pub limit_minus_ok: bool,
    /// Direct mode is wanted.
    pub direct_enable: bool,
    /// One clock: direct mode for `direct_hold_ticks` from now on.
    pub direct_kick: bool,
    /// Ticks per kick; 0: never.
    pub direct_hold_ticks: u16,
    /// Manual duty, in clocks of the PWM, 17 bits.
    pub direct_duty: i32,
    /// Largest manual duty in size.
    pub direct_limit: u16,
    /// Direct mode is the PWM's self-test: pins masked, drive and brake off.
    pub self_test: bool,
    /// Of the PWM, before its mask: bit 0 `a_high`, bit 1 `a_low`.
    pub gates: u8,
    /// Of the PWM, one clock: `gates` are those of the first clock of a period.
    pub valley: bool,
}

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outputs {
    /// To the PWM, in its clocks, 17 bits.
    pub duty: i32,
    /// One clock, with each duty taken: to the PWM's watchdog.
    pub feed: bool,
    /// To the PWM.
    pub pwm_enable: bool,
    /// To the drive.
    pub drive_enable: bool,
    /// To the brake: high opens it.
    pub brake_release: bool,
    /// To the PWM's filtered faults: bit 0 the supervisor's trip, bit 1 the drive's fault; low is a fault.
    pub filtered_fault_n: u8,
    /// Direct mode: the outputs are on by it.
    pub direct_active: bool,
    /// One clock: direct mode ended since its time ran out.
    pub direct_expired: bool,
    /// To the PWM: its pins are off.
    pub mask_pins: bool,
    /// Clocks that `a_high` was on in the last whole period of a self-test; stops at 65,535.
    pub self_test_high: u16,
    /// The same of `a_low`.
    pub self_test_low: u16,
}

impl Default for Outputs {
    /// After reset: all off. No fault is reported: the PWM is off by its own latch then.
    fn default() -> Self {
        Self {
            duty: 0,
            feed: false,
            pwm_enable: false,
            drive_enable: false,
            brake_release: false,
            filtered_fault_n: 3,
            direct_active: false,
            direct_expired: false,
            mask_pins: false,
            self_test_high: 0,
            self_test_low: 0,
        }
    }
}

/// Input ports in port order, with their widths.
const INPUTS: [(&str, u32, bool); 20] = [
    ("rst", 1, false),
    ("tick", 1, false),
    ("controller_duty", CONTROLLER_DUTY_BITS, true),
    ("controller_valid", 1, false),
    ("axis_state", 3, false),
    ("axis_pwm_enable", 1, false),
    ("axis_drive_enable", 1, false),
    ("axis_brake_release", 1, false),
    ("axis_pwm_trip_n", 1, false),
    ("drive_fault_n", 1, false),
    ("limit_plus_ok", 1, false),
    ("limit_minus_ok", 1, false),
    ("direct_enable", 1, false),
    ("direct_kick", 1, false),
    ("direct_hold_ticks", 16, false),
    ("direct_duty", DUTY_BITS, true),
    ("direct_limit", 16, false),
    ("self_test", 1, false),
    ("gates", 4, false),
    ("valley", 1, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [(&str, u32, bool); 11] = [
    ("duty", DUTY_BITS, true),
    ("feed", 1, false),
    ("pwm_enable", 1, false),
    ("drive_enable", 1, false),
    ("brake_release", 1, false),
    ("filtered_fault_n", 2, false),
    ("direct_active", 1, false),
    ("direct_expired", 1, false),
    ("mask_pins", 1, false),
    ("self_test_high", 16, false),
    ("self_test_low", 16, false),
];

/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = INPUTS.len();
/// Number of output ports.
pub const OUTPUT_PORTS: usize = OUTPUTS.len();

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
    let inputs = INPUTS.iter().map(port(Direction::Input));
    inputs.chain(OUTPUTS.iter().map(port(Direction::Output))).collect()
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        let bit = |value: u64| value & 1 != 0;
        let [
            rst,
            tick,
            controller_duty,
            controller_valid,
            axis_state,
            axis_pwm_enable,
            axis_drive_enable,
            axis_brake_release,
            axis_pwm_trip_n,
            drive_fault_n,
            limit_plus_ok,
            limit_minus_ok,
            direct_enable,
            direct_kick,
            direct_hold_ticks,
            direct_duty,
            direct_limit,
            self_test,
            gates,
            valley,
        ] = *raw;
        Self {
            rst: bit(rst),
            tick: bit(tick),
            controller_duty: controller_duty as i32,
            controller_valid: bit(controller_valid),
            axis_state: (axis_state & 7) as u8,
            axis_pwm_enable: bit(axis_pwm_enable),
            axis_drive_enable: bit(axis_drive_enable),
            axis_brake_release: bit(axis_brake_release),
            axis_pwm_trip_n: bit(axis_pwm_trip_n),
            drive_fault_n: bit(drive_fault_n),
            limit_plus_ok: bit(limit_plus_ok),
            limit_minus_ok: bit(limit_minus_ok),
            direct_enable: bit(direct_enable),
            direct_kick: bit(direct_kick),
            direct_hold_ticks: direct_hold_ticks as u16,
            direct_duty: direct_duty as i32,
            direct_limit: direct_limit as u16,
            self_test: bit(self_test),
            gates: (gates & 0xf) as u8,
            valley: bit(valley),
        }
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            self.duty as u64 & ((1 << DUTY_BITS) - 1),
            u64::from(self.feed),
            u64::from(self.pwm_enable),
            u64::from(self.drive_enable),
            u64::from(self.brake_release),
            u64::from(self.filtered_fault_n),
            u64::from(self.direct_active),
            u64::from(self.direct_expired),
            u64::from(self.mask_pins),
            u64::from(self.self_test_high),
            u64::from(self.self_test_low),
        ]
    }
}

/// The controller's duty in the PWM's 17 bits: saturated, never cut.
pub fn saturated(controller_duty: i32) -> i32 {
    (wrap(i64::from(controller_duty), CONTROLLER_DUTY_BITS) as i32).clamp(DUTY_MIN, DUTY_MAX)
}

/// The manual duty, at most `limit` in size.
pub fn limited(direct_duty: i32, limit: u16) -> i32 {
    let limit = i32::from(limit);
    (wrap(i64::from(direct_duty), DUTY_BITS) as i32).clamp(-limit, limit)
}

/// The block, cycle accurate at its ports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DriveCommand {
    ports: Arc<[Port]>,
    /// Ticks until direct mode expires; of no meaning outside of it.
    ticks_left: u16,
    /// The sign of the last manual duty wanted.
    backward: bool,
    /// Clocks of this period that a gate was on: `a_high`, `a_low`.
    on_clocks: [u16; 2],
    shown: Outputs,
}

impl Default for DriveCommand {
    fn default() -> Self {
        Self::new()
    }
}

impl DriveCommand {
    /// The block after reset.
    pub fn new() -> Self {
        Self {
            ports: ports().into(),
            ticks_left: 0,
            backward: false,
            on_clocks: [0; 2],
            shown: Outputs::default(),
        }
    }

    /// What the outputs show now.
    pub fn outputs(&self) -> Outputs {
        self.shown
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.shown;
        if inputs.rst {
            (self.ticks_left, self.backward) = (0, false);
            (self.on_clocks, self.shown) = ([0; 2], Outputs::default());
            return shown;
        }
        let test_changes = shown.direct_active && inputs.self_test != shown.mask_pins;
        let permitted = inputs.axis_state == State::Ready as u8 && inputs.direct_enable && !test_changes;
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

    /// Counts the gates while the pins are masked; the results after this clock.
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

    /// The duty after this clock, with direct mode on or off after it.
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
        let on_switch = match self.backward {
            false => !inputs.limit_plus_ok,
            true => !inputs.limit_minus_ok,
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

impl ClockedBlock for DriveCommand {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), OUTPUT_PORTS) = (<&[u64; INPUT_PORTS]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the drive command has {INPUT_PORTS} and {OUTPUT_PORTS}",
                inputs.len(),
                outputs.len()
            )));
        };
        let shown = DriveCommand::step(self, &Inputs::from_raw(raw));
        outputs.copy_from_slice(&shown.to_raw());
        Ok(())
    }
}

impl Moore for DriveCommand {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip(self.outputs().to_raw()) {
            *output = value;
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        match <&[u64; INPUT_PORTS]>::try_from(inputs) {
            Ok(raw) => quiet_at_rest(self, |next| {
                DriveCommand::step(next, &Inputs::from_raw(raw));
            }),
            Err(_) => 0,
        }
    }
}
