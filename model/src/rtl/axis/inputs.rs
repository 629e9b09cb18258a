//! The input ports of the axis's supervisor.

use crate::rtl::PlainRow;

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: the tick.
    pub tick: bool,
    /// Line, any time: low, or a broken wire, is an emergency stop.
    pub emergency_stop_n: bool,
    /// Line, any time: low, or a broken wire, is on the limit switch +.
    pub limit_plus_n: bool,
    /// Line, any time: low, or a broken wire, is on the limit switch −.
    pub limit_minus_n: bool,
    /// Line, any time: low, or a broken wire, is not ready.
    pub drive_ready: bool,
    /// Line, any time: the home switch; only filtered.
    pub home: bool,
    /// Pulses of up to so many clocks on a line are ignored, 6 bits.
    pub filter_clocks: u8,
    /// Outputs on; low: off, through a quick stop and the brake. Must be low once before READY.
    pub enable: bool,
    /// One clock: at the next tick from HOLD to RUN.
    pub start: bool,
    /// One clock: quick stop, then HOLD.
    pub stop: bool,
    /// One clock: forget the causes that are over, eight clocks later.
    pub clear_faults: bool,
    /// One clock: `kick_word` is for the watchdog.
    pub kick: bool,
    /// Only [`KICK`](super::KICK) counts.
    pub kick_word: u32,
    /// One clock: `homed_value` is for `homed`.
    pub write_homed: bool,
    /// The position's origin is known, the soft limits are for it.
    pub homed_value: bool,
    /// Another axis wants all to stop.
    pub group_stop: bool,
    /// Another axis has its emergency stop.
    pub group_emergency_stop: bool,
    /// Per cause: 1 outputs off, 0 quick stop. See [`Cause`](super::Cause).
    pub off_causes: u16,
    /// Ticks from HOLD until the brake is open.
    pub brake_release_ticks: u16,
    /// Ticks from applying the brake until it holds.
    pub brake_apply_ticks: u16,
    /// Ticks from the command's standstill to that of the shaped command: the shaper's longest delay.
    pub settle_ticks: u16,
    /// Q24.8 counts. Both 0: no soft limits.
    pub soft_limit_plus: i32,
    /// Q24.8 counts.
    pub soft_limit_minus: i32,
    /// No soft limits unless `homed`.
    pub limits_after_homing: bool,
    /// Q16.16 counts; 0: not watched.
    pub following_error_limit: u32,
    /// As `deviation`; 0: not watched.
    pub deviation_limit: u32,
    /// Ticks in a row; 0: not watched.
    pub saturation_ticks: u16,
    /// Q20.12 command units, above which the position must move.
    pub lost_command: u32,
    /// Ticks without a motion the command's way; 0: not watched.
    pub lost_ticks: u16,
    /// A motion against the command is as none: so an encoder of the wrong sign is lost.
    pub watches_direction: bool,
    /// Ticks without a kick; 0: no watchdog.
    pub watchdog_ticks: u16,
    /// A rotary axis: positions wrap, and no range is left.
    pub modulo: bool,
    /// Measured, counts; live.
    pub position: i32,
    /// Motor against scale.
    pub deviation: i32,
    /// Of `segments`: its `state`.
    pub segments_state: u8,
    /// Of `segments`: its `empty`.
    pub segments_empty: bool,
    /// Of `segments`: its `valid`.
    pub segments_valid: bool,
    /// Of `segments`: its `underrun`.
    pub segments_underrun: bool,
    /// Of `segments`: its `overflow`.
    pub segments_overflow: bool,
    /// Of `segments`: its `tick_missed`.
    pub segments_tick_missed: bool,
    /// Of `segments`: its `out_of_range`.
    pub segments_out_of_range: bool,
    /// Of `segments`: its `velocity`.
    pub command_velocity: i32,
    /// Of the shaper: `y_0`, Q24.8 counts.
    pub reference_position: i32,
    /// Of the shaper: `y_1`, Q16.16 counts per tick.
    pub reference_velocity: i32,
    /// Of the shaper: its `saturated`.
    pub shaper_saturated: bool,
    /// Of the shaper: its `overrun`.
    pub shaper_overrun: bool,
    /// Of the controller: e, Q16.16 counts.
    pub error: i32,
    /// Of the controller: its `command`, Q20.12.
    pub command: i32,
    /// Of the controller: its `limited_ticks`.
    pub limited_ticks: u16,
    /// Of the controller: its `saturated_high`, 7 bits; bit 0 is that of e.
    pub saturated_high: u8,
    /// Of the controller: its `saturated_low`, the same.
    pub saturated_low: u8,
    /// Of the controller: its `overrun`.
    pub controller_overrun: bool,
    /// Of the PWM: its `tripped`.
    pub pwm_tripped: bool,
    /// Of the pulse counter: its `illegal`.
    pub encoder_illegal: bool,
    /// Of the pulse counter: its `disagreement`.
    pub encoder_disagreement: bool,
    /// Of the pulse counter: its `velocity_missed`.
    pub velocity_missed: bool,
    /// Of the scale's pulse counter: its `illegal`.
    pub scale_illegal: bool,
    /// Of the scale's pulse counter: its `disagreement`.
    pub scale_disagreement: bool,
}

/// In port order, with width and sign.
pub(super) const INPUTS: [PlainRow; 59] = [
    ("rst", 1, false),
    ("tick", 1, false),
    ("emergency_stop_n", 1, false),
    ("limit_plus_n", 1, false),
    ("limit_minus_n", 1, false),
    ("drive_ready", 1, false),
    ("home", 1, false),
    ("filter_clocks", 6, false),
    ("enable", 1, false),
    ("start", 1, false),
    ("stop", 1, false),
    ("clear_faults", 1, false),
    ("kick", 1, false),
    ("kick_word", 32, false),
    ("write_homed", 1, false),
    ("homed_value", 1, false),
    ("group_stop", 1, false),
    ("group_emergency_stop", 1, false),
    ("off_causes", 16, false),
    ("brake_release_ticks", 16, false),
    ("brake_apply_ticks", 16, false),
    ("settle_ticks", 16, false),
    ("soft_limit_plus", 32, true),
    ("soft_limit_minus", 32, true),
    ("limits_after_homing", 1, false),
    ("following_error_limit", 32, false),
    ("deviation_limit", 32, false),
    ("saturation_ticks", 16, false),
    ("lost_command", 32, false),
    ("lost_ticks", 16, false),
    ("watches_direction", 1, false),
    ("watchdog_ticks", 16, false),
    ("modulo", 1, false),
    ("position", 32, true),
    ("deviation", 32, true),
    ("segments_state", 2, false),
    ("segments_empty", 1, false),
    ("segments_valid", 1, false),
    ("segments_underrun", 1, false),
    ("segments_overflow", 1, false),
    ("segments_tick_missed", 1, false),
    ("segments_out_of_range", 1, false),
    ("command_velocity", 32, true),
    ("reference_position", 32, true),
    ("reference_velocity", 32, true),
    ("shaper_saturated", 1, false),
    ("shaper_overrun", 1, false),
    ("error", 32, true),
    ("command", 32, true),
    ("limited_ticks", 16, false),
    ("saturated_high", 7, false),
    ("saturated_low", 7, false),
    ("controller_overrun", 1, false),
    ("pwm_tripped", 1, false),
    ("encoder_illegal", 1, false),
    ("encoder_disagreement", 1, false),
    ("velocity_missed", 1, false),
    ("scale_illegal", 1, false),
    ("scale_disagreement", 1, false),
];

/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = INPUTS.len();

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        let mut values = raw.iter().copied();
        let mut word = || values.next().unwrap_or_default();
        Self {
            rst: word() & 1 != 0,
            tick: word() & 1 != 0,
            emergency_stop_n: word() & 1 != 0,
            limit_plus_n: word() & 1 != 0,
            limit_minus_n: word() & 1 != 0,
            drive_ready: word() & 1 != 0,
            home: word() & 1 != 0,
            filter_clocks: word() as u8 & 0x3f,
            enable: word() & 1 != 0,
            start: word() & 1 != 0,
            stop: word() & 1 != 0,
            clear_faults: word() & 1 != 0,
            kick: word() & 1 != 0,
            kick_word: word() as u32,
            write_homed: word() & 1 != 0,
            homed_value: word() & 1 != 0,
            group_stop: word() & 1 != 0,
            group_emergency_stop: word() & 1 != 0,
            off_causes: word() as u16,
            brake_release_ticks: word() as u16,
            brake_apply_ticks: word() as u16,
            settle_ticks: word() as u16,
            soft_limit_plus: word() as i32,
            soft_limit_minus: word() as i32,
            limits_after_homing: word() & 1 != 0,
            following_error_limit: word() as u32,
            deviation_limit: word() as u32,
            saturation_ticks: word() as u16,
            lost_command: word() as u32,
            lost_ticks: word() as u16,
            watches_direction: word() & 1 != 0,
            watchdog_ticks: word() as u16,
            modulo: word() & 1 != 0,
            position: word() as i32,
            deviation: word() as i32,
            segments_state: word() as u8 & 0x3,
            segments_empty: word() & 1 != 0,
            segments_valid: word() & 1 != 0,
            segments_underrun: word() & 1 != 0,
            segments_overflow: word() & 1 != 0,
            segments_tick_missed: word() & 1 != 0,
            segments_out_of_range: word() & 1 != 0,
            command_velocity: word() as i32,
            reference_position: word() as i32,
            reference_velocity: word() as i32,
            shaper_saturated: word() & 1 != 0,
            shaper_overrun: word() & 1 != 0,
            error: word() as i32,
            command: word() as i32,
            limited_ticks: word() as u16,
            saturated_high: word() as u8 & 0x7f,
            saturated_low: word() as u8 & 0x7f,
            controller_overrun: word() & 1 != 0,
            pwm_tripped: word() & 1 != 0,
            encoder_illegal: word() & 1 != 0,
            encoder_disagreement: word() & 1 != 0,
            velocity_missed: word() & 1 != 0,
            scale_illegal: word() & 1 != 0,
            scale_disagreement: word() & 1 != 0,
        }
    }

    /// As raw bit patterns, one per input port in port order.
    pub fn to_raw(&self) -> [u64; INPUT_PORTS] {
        [
            u64::from(self.rst),
            u64::from(self.tick),
            u64::from(self.emergency_stop_n),
            u64::from(self.limit_plus_n),
            u64::from(self.limit_minus_n),
            u64::from(self.drive_ready),
            u64::from(self.home),
            u64::from(self.filter_clocks),
            u64::from(self.enable),
            u64::from(self.start),
            u64::from(self.stop),
            u64::from(self.clear_faults),
            u64::from(self.kick),
            u64::from(self.kick_word),
            u64::from(self.write_homed),
            u64::from(self.homed_value),
            u64::from(self.group_stop),
            u64::from(self.group_emergency_stop),
            u64::from(self.off_causes),
            u64::from(self.brake_release_ticks),
            u64::from(self.brake_apply_ticks),
            u64::from(self.settle_ticks),
            u64::from(self.soft_limit_plus as u32),
            u64::from(self.soft_limit_minus as u32),
            u64::from(self.limits_after_homing),
            u64::from(self.following_error_limit),
            u64::from(self.deviation_limit),
            u64::from(self.saturation_ticks),
            u64::from(self.lost_command),
            u64::from(self.lost_ticks),
            u64::from(self.watches_direction),
            u64::from(self.watchdog_ticks),
            u64::from(self.modulo),
            u64::from(self.position as u32),
            u64::from(self.deviation as u32),
            u64::from(self.segments_state),
            u64::from(self.segments_empty),
            u64::from(self.segments_valid),
            u64::from(self.segments_underrun),
            u64::from(self.segments_overflow),
            u64::from(self.segments_tick_missed),
            u64::from(self.segments_out_of_range),
            u64::from(self.command_velocity as u32),
            u64::from(self.reference_position as u32),
            u64::from(self.reference_velocity as u32),
            u64::from(self.shaper_saturated),
            u64::from(self.shaper_overrun),
            u64::from(self.error as u32),
            u64::from(self.command as u32),
            u64::from(self.limited_ticks),
            u64::from(self.saturated_high),
            u64::from(self.saturated_low),
            u64::from(self.controller_overrun),
            u64::from(self.pwm_tripped),
            u64::from(self.encoder_illegal),
            u64::from(self.encoder_disagreement),
            u64::from(self.velocity_missed),
            u64::from(self.scale_illegal),
            u64::from(self.scale_disagreement),
        ]
    }
}
