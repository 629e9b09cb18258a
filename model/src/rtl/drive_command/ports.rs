//! The ports of the drive command.

use crate::rtl::ports;

/// Width of the controller's duty.
pub const CONTROLLER_DUTY_BITS: u32 = 18;
/// Width of the PWM's duty.
pub const DUTY_BITS: u32 = 17;
/// Largest duty of the PWM.
pub const DUTY_MAX: i32 = (1 << (DUTY_BITS - 1)) - 1;
/// Smallest duty of the PWM.
pub const DUTY_MIN: i32 = -DUTY_MAX - 1;

impl Outputs {
    /// At power-up: all off, and the register behind `drive_fault_n` low.
    pub(super) fn at_power_up() -> Self {
        Self {
            filtered_fault_n: 1,
            ..Self::default()
        }
    }
}

ports! {
    drive_command_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// Of sliding_mode: its `duty`, clocks of the PWM.
        controller_duty: Signed(18) as i32, "clocks";
        /// One clock: `controller_duty` is new.
        controller_valid: Bit as bool;
        /// Of the supervisor, axis: its `state`.
        axis_state: Bits(3) as u8;
        /// Of the supervisor: its `pwm_enable`.
        axis_pwm_enable: Bit as bool;
        /// Of the supervisor: its `drive_enable`.
        axis_drive_enable: Bit as bool;
        /// Of the supervisor: its `brake_release`.
        axis_brake_release: Bit as bool;
        /// Of the supervisor: its `pwm_trip_n`; low is an emergency stop.
        axis_pwm_trip_n: Bit as bool;
        /// Pin, any time: low, or a broken wire, is a fault of the drive.
        drive_fault_n: Bit as bool;
        /// The supervisor's `level_limit_plus_n`: low is on the switch.
        limit_plus_ok: Bit as bool;
        /// The supervisor's `level_limit_minus_n`: low is on the switch.
        limit_minus_ok: Bit as bool;
        /// Direct mode is wanted.
        direct_enable: Bit as bool;
        /// One clock: direct mode for `direct_hold_ticks` from now on.
        direct_kick: Bit as bool;
        /// Tied: ticks per kick; 0: never.
        direct_hold_ticks: Bits(16) as u16, "ticks";
        /// Manual duty, clocks of the PWM.
        direct_duty: Signed(17) as i32, "clocks";
        /// Tied: largest |manual duty|.
        direct_limit: Bits(16) as u16, "clocks";
        /// Direct mode is the self-test.
        self_test: Bit as bool;
        /// Of the PWM: its `gates`; bit 0 `a_high`, bit 1 `a_low`.
        gates: Bits(4) as u8;
        /// Of the PWM: its `valley`.
        valley: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// To the PWM.
        duty: Signed(17) as i32, "clocks";
        /// One clock, with each duty taken: to the PWM's watchdog.
        feed: Bit as bool;
        /// To the PWM's `enable`.
        pwm_enable: Bit as bool;
        /// To the drive.
        drive_enable: Bit as bool;
        /// To the brake: high opens it.
        brake_release: Bit as bool;
        /// To the PWM: bit 0 the supervisor's trip, bit 1 the drive's fault.
        filtered_fault_n: Bits(2) as u8;
        /// Direct mode: the outputs are on by it.
        direct_active: Bit as bool;
        /// One clock: direct mode ended since its time ran out.
        direct_expired: Bit as bool;
        /// To the PWM: its pins are off.
        mask_pins: Bit as bool;
        /// Clocks that `a_high` was on in the last whole period of a self-test; stops at 65,535.
        self_test_high: Bits(16) as u16, "clocks";
        /// The same of `a_low`.
        self_test_low: Bits(16) as u16, "clocks";
    }
}
