//! The ports of the linear scale.

use crate::rtl::ports;

ports! {
    linear_scale_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: both positions are taken.
        tick: Bit as bool;
        /// Counts of the motor, live.
        motor_position: Signed(32) as i32, "counts";
        /// Counts of the scale, live.
        scale_position: Signed(32) as i32, "counts";
        /// Q16.16 counts of the motor per tick.
        motor_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// One clock: `motor_velocity` is new.
        velocity_valid: Bit as bool;
        /// One clock: from now on the deviation is 0.
        align: Bit as bool;
        /// Mantissa of the ratio, of `ScaleRatio`; tied.
        ratio_mantissa: Signed(18) as i32;
        /// Shift of the ratio, of `ScaleRatio`; tied.
        ratio_shift: Bits(5) as u8;
        /// Tied: 1 the position loop runs on the scale, 0 the scale is watched.
        use_scale: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Motor less scale since `align`, counts of the loop. Read it from `deviation_valid` to the next tick.
        deviation: Signed(32) as i32, "counts";
        /// One clock: `deviation` is that of the last tick.
        deviation_valid: Bit as bool;
        /// Of the counter that the loop runs on, live, a clock late.
        position: Signed(32) as i32, "counts";
        /// Q16.16 counts of that counter per tick. Read it from the end of its pass to the next `velocity_valid`.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
    }
}
