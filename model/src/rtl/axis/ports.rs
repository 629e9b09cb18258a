//! The ports of the axis's supervisor.

use super::transition::SupervisorState;
use crate::rtl::ports;
use crate::rtl::ports::choices;

choices!(SupervisorState: Off, Ready, Hold, Run, QuickStop, Fault);

ports! {
    axis_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// Line, any time: low, or a broken wire, is an emergency stop.
        emergency_stop_n: Bit as bool;
        /// Line, any time: low, or a broken wire, is on the limit switch +.
        limit_plus_n: Bit as bool;
        /// Line, any time: low, or a broken wire, is on the limit switch −.
        limit_minus_n: Bit as bool;
        /// Line, any time: low, or a broken wire, is not ready.
        drive_ready: Bit as bool;
        /// Line, any time: the home switch; only filtered.
        home: Bit as bool;
        /// Pulses of up to so many clocks on a line are ignored.
        filter_clocks: Bits(6) as u8, "clocks";
        /// Outputs on; low: off, through a quick stop and the brake. Must be low once before READY.
        enable: Bit as bool;
        /// One clock: at the next tick from HOLD to RUN.
        start: Bit as bool;
        /// One clock: quick stop, then HOLD.
        stop: Bit as bool;
        /// One clock: forget the causes that are over, eight clocks later.
        clear_faults: Bit as bool;
        /// One clock: `kick_word` is for the watchdog.
        kick: Bit as bool;
        /// Only `0x4b49434b`, in ASCII `KICK`, counts.
        kick_word: Bits(32) as u32;
        /// One clock: `homed_value` is for `homed`.
        write_homed: Bit as bool;
        /// The position's origin is known, and the soft limits are for it.
        homed_value: Bit as bool;
        /// Another axis wants all to stop.
        group_stop: Bit as bool;
        /// Another axis has its emergency stop.
        group_emergency_stop: Bit as bool;
        /// Per cause: 1 outputs off, 0 quick stop. See *Causes*.
        off_causes: Bits(16) as u16;
        /// Ticks from HOLD until the brake is open.
        brake_release_ticks: Bits(16) as u16, "ticks";
        /// Ticks from applying the brake until it holds.
        brake_apply_ticks: Bits(16) as u16, "ticks";
        /// Ticks from the command's standstill to that of the shaped command: the shaper's longest delay.
        settle_ticks: Bits(16) as u16, "ticks";
        /// Upper soft limit. Both 0: no soft limits.
        soft_limit_plus: Signed(32) as i32, "counts, Q24.8";
        /// Lower soft limit.
        soft_limit_minus: Signed(32) as i32, "counts, Q24.8";
        /// Tied: no soft limits unless `homed`.
        limits_after_homing: Bit as bool;
        /// Largest following error; 0: not watched.
        following_error_limit: Bits(32) as u32, "counts, Q16.16";
        /// Largest deviation, in its unit; 0: not watched.
        deviation_limit: Bits(32) as u32;
        /// Longest saturation, in ticks in a row; 0: not watched.
        saturation_ticks: Bits(16) as u16, "ticks";
        /// The command above which the position must move.
        lost_command: Bits(32) as u32, "command units, Q20.12";
        /// Ticks without a motion the command's way; 0: not watched.
        lost_ticks: Bits(16) as u16, "ticks";
        /// Tied: a motion against the command is as none, so that a feedback of the wrong sign is found.
        watches_direction: Bit as bool;
        /// Ticks without a kick; 0: no watchdog.
        watchdog_ticks: Bits(16) as u16, "ticks";
        /// Tied: a rotary axis, whose positions wrap; no range is left.
        modulo: Bit as bool;
        /// Measured; live.
        position: Signed(32) as i32, "counts";
        /// Motor against scale; read at the tick.
        deviation: Signed(32) as i32;
        /// Of `segments`: its `state`.
        segments_state: Bits(2) as u8;
        /// Of `segments`: its `empty`.
        segments_empty: Bit as bool;
        /// Of `segments`: its `valid`.
        segments_valid: Bit as bool;
        /// Of `segments`: its `underrun`.
        segments_underrun: Bit as bool;
        /// Of `segments`: its `overflow`.
        segments_overflow: Bit as bool;
        /// Of `segments`: its `tick_missed`.
        segments_tick_missed: Bit as bool;
        /// Of `segments`: its `out_of_range`.
        segments_out_of_range: Bit as bool;
        /// Of `segments`: its `velocity`.
        command_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// Of the shaper: `y_0`.
        reference_position: Signed(32) as i32, "counts, Q24.8";
        /// Of the shaper: `y_1`.
        reference_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// Of the shaper: its `saturated`.
        shaper_saturated: Bit as bool;
        /// Of the shaper: its `overrun`.
        shaper_overrun: Bit as bool;
        /// Of the controller: e.
        error: Signed(32) as i32, "counts, Q16.16";
        /// Of the controller: its `command`.
        command: Signed(32) as i32, "command units, Q20.12";
        /// Of the controller: its `limited_ticks`.
        limited_ticks: Bits(16) as u16, "ticks";
        /// Of the controller: its `saturated_high`; bit 0 is e's.
        saturated_high: Bits(7) as u8;
        /// The same, at the lower end.
        saturated_low: Bits(7) as u8;
        /// Of the controller: its `overrun`.
        controller_overrun: Bit as bool;
        /// Of the PWM: its `tripped`.
        pwm_tripped: Bit as bool;
        /// Of the pulse counter: its `illegal`.
        encoder_illegal: Bit as bool;
        /// Of the pulse counter: its `disagreement`.
        encoder_disagreement: Bit as bool;
        /// Of the pulse counter: its `velocity_missed`.
        velocity_missed: Bit as bool;
        /// Of the scale's pulse counter: its `illegal`.
        scale_illegal: Bit as bool;
        /// Of the scale's pulse counter: its `disagreement`.
        scale_disagreement: Bit as bool;
    }

    /// The output ports, all of them registers or functions of registers.
    outputs Outputs {
        /// What the axis is doing: 0 OFF, 1 READY, 2 HOLD, 3 RUN, 4 QUICK_STOP, 5 FAULT.
        state: Bits(3) as SupervisorState;
        /// Sticky: what went wrong. See *Causes*.
        causes: Bits(17) as u32;
        /// To the drive.
        drive_enable: Bit as bool;
        /// To the brake: high opens it.
        brake_release: Bit as bool;
        /// To the PWM.
        pwm_enable: Bit as bool;
        /// To the PWM's filtered fault: low is an emergency stop.
        pwm_trip_n: Bit as bool;
        /// To `segments`: its `enable`.
        segments_enable: Bit as bool;
        /// To `segments`: its `preset`; while the outputs are off.
        segments_preset: Bit as bool;
        /// To `segments`: its `quick_stop`; until it stops.
        segments_quick_stop: Bit as bool;
        /// To `segments`: its `restart`; in HOLD until it holds.
        segments_restart: Bit as bool;
        /// To the shaper: its `start`; until the first sample after the outputs went on.
        shaper_start: Bit as bool;
        /// To the controller; as `shaper_start`.
        clear_integral: Bit as bool;
        /// One clock after `clear_faults`: to the flags and the trip that causes come from.
        clear_sources: Bit as bool;
        /// To the stage: a fault, or a quick stop because of one.
        wants_group_stop: Bit as bool;
        /// To the stage: this axis's own line.
        emergency_stop: Bit as bool;
        /// A `start` would lead to RUN at the next tick; as of the clock before.
        can_start: Bit as bool;
        /// The host has homed the axis, and its position has not been in doubt since then.
        homed: Bit as bool;
        /// The position at the last tick.
        captured_position: Signed(32) as i32, "counts";
        /// Filtered line.
        level_emergency_stop_n: Bit as bool;
        /// Filtered line.
        level_limit_plus_n: Bit as bool;
        /// Filtered line.
        level_limit_minus_n: Bit as bool;
        /// Filtered line.
        level_drive_ready: Bit as bool;
        /// Filtered line.
        level_home: Bit as bool;
        /// One clock: READY to HOLD.
        enabled: Bit as bool;
        /// One clock: HOLD to RUN.
        started: Bit as bool;
        /// One clock: to QUICK_STOP.
        stopping: Bit as bool;
        /// One clock: RUN or QUICK_STOP to HOLD.
        halted: Bit as bool;
        /// One clock: HOLD to OFF.
        disabled: Bit as bool;
        /// One clock: to FAULT.
        faulted: Bit as bool;
        /// One clock: a `start` that led to nothing.
        refused: Bit as bool;
    }
}
