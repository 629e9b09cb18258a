//! The ports of the drive command.

use crate::ports;

/// Width of the controller's duty in bits.
pub const CONTROLLER_DUTY_BITS: u32 = 18;
/// Width of the PWM's duty in bits.
pub const DUTY_BITS: u32 = 17;
/// Largest duty of the PWM.
pub const DUTY_MAX: i32 = (1 << (DUTY_BITS - 1)) - 1;
/// Smallest duty of the PWM.
pub const DUTY_MIN: i32 = -DUTY_MAX - 1;

impl Outputs {
    /// Outputs at power-up: all off, and the register behind `drive_fault_n` low.
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
        /// `duty` of the controller.
        controller_duty: Signed(18) as i32, "clocks";
        /// One clock: `controller_duty` is new.
        controller_valid: Bit as bool;
        /// `state` of the supervisor.
        axis_state: Bits(3) as u8;
        /// `pwm_enable` of the supervisor.
        axis_pwm_enable: Bit as bool;
        /// `drive_enable` of the supervisor.
        axis_drive_enable: Bit as bool;
        /// `brake_release` of the supervisor.
        axis_brake_release: Bit as bool;
        /// `pwm_trip_n` of the supervisor; low is an emergency stop.
        axis_pwm_trip_n: Bit as bool;
        /// Asynchronous pin; low, as with a broken wire: the drive has a fault.
        drive_fault_n: Bit as bool;
        /// `level_limit_plus_n` of the supervisor; low: the axis is on the switch.
        limit_plus_ok: Bit as bool;
        /// `level_limit_minus_n` of the supervisor; low: the axis is on the switch.
        limit_minus_ok: Bit as bool;
        /// Requests direct mode.
        direct_enable: Bit as bool;
        /// One clock: direct mode lasts `direct_hold_ticks` from now on.
        direct_kick: Bit as bool;
        /// Constant: duration of direct mode per kick; 0 disables direct mode.
        direct_hold_ticks: Bits(16) as u16, "ticks";
        /// Manual duty.
        direct_duty: Signed(17) as i32, "clocks";
        /// Constant: largest |manual duty|.
        direct_limit: Bits(16) as u16, "clocks";
        /// Direct mode is a self-test.
        self_test: Bit as bool;
        /// `gates` of the PWM: bit 0 `a_high`, bit 1 `a_low`.
        gates: Bits(4) as u8;
        /// `valley` of the PWM.
        valley: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Duty, to the PWM.
        duty: Signed(17) as i32, "clocks";
        /// One clock, with each duty taken: feeds the PWM's watchdog.
        feed: Bit as bool;
        /// To `enable` of the PWM.
        pwm_enable: Bit as bool;
        /// To the drive: high enables it.
        drive_enable: Bit as bool;
        /// To the brake: high opens it.
        brake_release: Bit as bool;
        /// To the PWM: bit 0 is the supervisor's trip, bit 1 the drive's fault.
        filtered_fault_n: Bits(2) as u8;
        /// The outputs are on by direct mode.
        direct_active: Bit as bool;
        /// One clock: direct mode ended because its time ran out.
        direct_expired: Bit as bool;
        /// To the PWM: its pins are masked off.
        mask_pins: Bit as bool;
        /// Clocks in which `a_high` was on in the last whole period of a self-test; stops at 65,535.
        self_test_high: Bits(16) as u16, "clocks";
        /// Clocks in which `a_low` was on in the last whole period of a self-test; stops at 65,535.
        self_test_low: Bits(16) as u16, "clocks";
    }
}
