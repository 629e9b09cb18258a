//! The ports of the axis's supervisor.

use super::transition::SupervisorState;
use crate::ports;
use crate::ports::choices;

choices!(SupervisorState: Off, Ready, Hold, Run, QuickStop, Fault);

ports! {
    axis_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// Asynchronous line; low, as with a broken wire: emergency stop.
        emergency_stop_n: Bit as bool;
        /// Asynchronous line; low, as with a broken wire: the axis is on limit switch +.
        limit_plus_n: Bit as bool;
        /// Asynchronous line; low, as with a broken wire: the axis is on limit switch −.
        limit_minus_n: Bit as bool;
        /// Asynchronous line; low, as with a broken wire: the drive is not ready.
        drive_ready: Bit as bool;
        /// Asynchronous line of the home switch, which is only filtered.
        home: Bit as bool;
        /// Longest pulse on a line that is ignored.
        filter_clocks: Bits(6) as u8, "clocks";
        /// High: outputs on. Low: outputs off, after a quick stop and the brake. It must be low once before READY.
        enable: Bit as bool;
        /// One clock: go from HOLD to RUN at the next tick.
        start: Bit as bool;
        /// One clock: quick stop, then HOLD.
        stop: Bit as bool;
        /// One clock: clear the causes that are over, eight clocks later.
        clear_faults: Bit as bool;
        /// One clock: `kick_word` is written to the watchdog.
        kick: Bit as bool;
        /// Word for the watchdog; only `0x4b49434b` (`KICK` in ASCII) counts.
        kick_word: Bits(32) as u32;
        /// One clock: write `homed_value` to `homed`.
        write_homed: Bit as bool;
        /// Value for `homed`: whether the position's origin, to which the soft limits refer, is known.
        homed_value: Bit as bool;
        /// Another axis wants all axes to stop.
        group_stop: Bit as bool;
        /// Another axis has its emergency stop.
        group_emergency_stop: Bit as bool;
        /// One bit per cause: 1 switches the outputs off, 0 leads to a quick stop. See *Causes*.
        off_causes: Bits(16) as u16;
        /// Ticks from entering HOLD until the brake is open.
        brake_release_ticks: Bits(16) as u16, "ticks";
        /// Ticks from applying the brake until it holds.
        brake_apply_ticks: Bits(16) as u16, "ticks";
        /// Time from the command's standstill to that of the shaped command: the shaper's longest delay.
        settle_ticks: Bits(16) as u16, "ticks";
        /// Upper soft limit. With both limits 0 there are no soft limits.
        soft_limit_plus: Signed(32) as i32, "counts, Q24.8";
        /// Lower soft limit.
        soft_limit_minus: Signed(32) as i32, "counts, Q24.8";
        /// Constant; high: the soft limits act only while `homed`.
        limits_after_homing: Bit as bool;
        /// Largest following error; 0 disables the check.
        following_error_limit: Bits(32) as u32, "counts, Q16.16";
        /// Largest deviation, in its unit; 0 disables the check.
        deviation_limit: Bits(32) as u32;
        /// Longest time with the command clamped at every tick; 0 disables the check.
        saturation_ticks: Bits(16) as u16, "ticks";
        /// Command above which the position must move.
        lost_command: Bits(32) as u32, "command units, Q20.12";
        /// Longest time without motion in the command's direction; 0 disables the check.
        lost_ticks: Bits(16) as u16, "ticks";
        /// Constant; high: a motion against the command does not count as motion, so that a feedback of the wrong
        /// sign is detected.
        watches_direction: Bit as bool;
        /// Longest time without a kick; 0 disables the watchdog.
        watchdog_ticks: Bits(16) as u16, "ticks";
        /// Constant; high: a rotary axis, whose positions wrap, so that no range can be left.
        modulo: Bit as bool;
        /// Measured position, changing at any time.
        position: Signed(32) as i32, "counts";
        /// Difference between motor and scale; read at the tick.
        deviation: Signed(32) as i32;
        /// `state` of `segments`.
        segments_state: Bits(2) as u8;
        /// `empty` of `segments`.
        segments_empty: Bit as bool;
        /// `valid` of `segments`.
        segments_valid: Bit as bool;
        /// `underrun` of `segments`.
        segments_underrun: Bit as bool;
        /// `overflow` of `segments`.
        segments_overflow: Bit as bool;
        /// `tick_missed` of `segments`.
        segments_tick_missed: Bit as bool;
        /// `out_of_range` of `segments`.
        segments_out_of_range: Bit as bool;
        /// `velocity` of `segments`.
        command_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// `y_0` of the shaper.
        reference_position: Signed(32) as i32, "counts, Q24.8";
        /// `y_1` of the shaper.
        reference_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// `saturated` of the shaper.
        shaper_saturated: Bit as bool;
        /// `overrun` of the shaper.
        shaper_overrun: Bit as bool;
        /// Error e of the controller.
        error: Signed(32) as i32, "counts, Q16.16";
        /// `command` of the controller.
        command: Signed(32) as i32, "command units, Q20.12";
        /// `limited_ticks` of the controller.
        limited_ticks: Bits(16) as u16, "ticks";
        /// `saturated_high` of the controller; bit 0 is that of e.
        saturated_high: Bits(7) as u8;
        /// `saturated_low` of the controller; bit 0 is that of e.
        saturated_low: Bits(7) as u8;
        /// `overrun` of the controller.
        controller_overrun: Bit as bool;
        /// `tripped` of the PWM.
        pwm_tripped: Bit as bool;
        /// `illegal` of the pulse counter.
        encoder_illegal: Bit as bool;
        /// `disagreement` of the pulse counter.
        encoder_disagreement: Bit as bool;
        /// `velocity_missed` of the pulse counter.
        velocity_missed: Bit as bool;
        /// `illegal` of the scale's pulse counter.
        scale_illegal: Bit as bool;
        /// `disagreement` of the scale's pulse counter.
        scale_disagreement: Bit as bool;
    }

    /// The output ports, all of them registers or functions of registers.
    outputs Outputs {
        /// State of the axis: 0 OFF, 1 READY, 2 HOLD, 3 RUN, 4 QUICK_STOP, 5 FAULT.
        state: Bits(3) as SupervisorState;
        /// Sticky: the causes of a fault. See *Causes*.
        causes: Bits(17) as u32;
        /// To the drive: high enables it.
        drive_enable: Bit as bool;
        /// To the brake: high opens it.
        brake_release: Bit as bool;
        /// To the PWM: high enables it.
        pwm_enable: Bit as bool;
        /// To the PWM's filtered fault: low during an emergency stop.
        pwm_trip_n: Bit as bool;
        /// To `enable` of `segments`.
        segments_enable: Bit as bool;
        /// To `preset` of `segments`; high while the outputs are off.
        segments_preset: Bit as bool;
        /// To `quick_stop` of `segments`; high until the command has stopped.
        segments_quick_stop: Bit as bool;
        /// To `restart` of `segments`; high in HOLD until the segments hold.
        segments_restart: Bit as bool;
        /// To `start` of the shaper; high until the first sample after the outputs went on.
        shaper_start: Bit as bool;
        /// To the controller; as `shaper_start`.
        clear_integral: Bit as bool;
        /// One clock after `clear_faults`: clears the flags and the trip that causes come from.
        clear_sources: Bit as bool;
        /// To the stage: a fault, or a quick stop because of one.
        wants_group_stop: Bit as bool;
        /// To the stage: the emergency stop line of this axis.
        emergency_stop: Bit as bool;
        /// In the clock before, a `start` would have led to RUN at the next tick.
        can_start: Bit as bool;
        /// The host has homed the axis, and its position has not been in doubt since then.
        homed: Bit as bool;
        /// The position at the last tick.
        captured_position: Signed(32) as i32, "counts";
        /// Filtered line `emergency_stop_n`.
        level_emergency_stop_n: Bit as bool;
        /// Filtered line `limit_plus_n`.
        level_limit_plus_n: Bit as bool;
        /// Filtered line `limit_minus_n`.
        level_limit_minus_n: Bit as bool;
        /// Filtered line `drive_ready`.
        level_drive_ready: Bit as bool;
        /// Filtered line `home`.
        level_home: Bit as bool;
        /// One clock: the axis went from READY to HOLD.
        enabled: Bit as bool;
        /// One clock: the axis went from HOLD to RUN.
        started: Bit as bool;
        /// One clock: the axis went to QUICK_STOP.
        stopping: Bit as bool;
        /// One clock: the axis went from RUN or QUICK_STOP to HOLD.
        halted: Bit as bool;
        /// One clock: the axis went from HOLD to OFF.
        disabled: Bit as bool;
        /// One clock: the axis went to FAULT.
        faulted: Bit as bool;
        /// One clock: a `start` was refused.
        refused: Bit as bool;
    }
}
