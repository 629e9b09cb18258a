//! The ports of the drive command.

use crate::rtl::{PlainRow, Port, ports_of};

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
    /// At power-up: all off, and the register behind `drive_fault_n` low.
    fn default() -> Self {
        Self {
            duty: 0,
            feed: false,
            pwm_enable: false,
            drive_enable: false,
            brake_release: false,
            filtered_fault_n: 1,
            direct_active: false,
            direct_expired: false,
            mask_pins: false,
            self_test_high: 0,
            self_test_low: 0,
        }
    }
}

/// Input ports in port order, with their widths.
const INPUTS: [PlainRow; 20] = [
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
const OUTPUTS: [PlainRow; 11] = [
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
    ports_of(&INPUTS, &OUTPUTS)
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
