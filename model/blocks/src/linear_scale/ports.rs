//! The ports of the linear scale.

use crate::ports;

ports! {
    linear_scale_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: takes both positions.
        tick: Bit as bool;
        /// Position of the motor, changing at any time.
        motor_position: Signed(32) as i32, "counts";
        /// Position of the scale, changing at any time.
        scale_position: Signed(32) as i32, "counts";
        /// Q16.16 counts of the motor per tick.
        motor_velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// One clock: `motor_velocity` is new.
        velocity_valid: Bit as bool;
        /// One clock: the deviation counts from now on, and is 0 here.
        align: Bit as bool;
        /// Constant: mantissa of the ratio, from `ScaleRatio`.
        ratio_mantissa: Signed(18) as i32;
        /// Constant: shift of the ratio, from `ScaleRatio`.
        ratio_shift: Bits(5) as u8;
        /// Constant: 1 the position loop runs on the scale, 0 the scale is only compared.
        use_scale: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Motor minus scale since `align`, in counts of the loop. Read it from `deviation_valid` to the next tick.
        deviation: Signed(32) as i32, "counts";
        /// One clock: `deviation` is that of the last tick.
        deviation_valid: Bit as bool;
        /// Position of the counter that the loop runs on, one clock late.
        position: Signed(32) as i32, "counts";
        /// Velocity of that counter in Q16.16 counts per tick. Read it from the end of its computation to the next
        /// `velocity_valid`.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
    }
}
