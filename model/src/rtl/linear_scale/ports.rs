//! The ports of the linear scale.

use super::{MANTISSA_BITS, SHIFT_BITS};
use crate::rtl::shaper::wrap;
use crate::rtl::{PlainRow, Port, ports_of};

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: the tick. Both positions are taken.
    pub tick: bool,
    /// Counts of the motor, live.
    pub motor_position: i32,
    /// Counts of the scale, live.
    pub scale_position: i32,
    /// Q16.16 counts of the motor per tick.
    pub motor_velocity: i32,
    /// One clock: `motor_velocity` is new.
    pub velocity_valid: bool,
    /// One clock: from now on the deviation is 0.
    pub align: bool,
    /// Tied: 18 bits.
    pub ratio_mantissa: i32,
    /// Tied: 5 bits.
    pub ratio_shift: u8,
    /// Tied: the position loop runs on the scale; else the scale is only watched.
    pub use_scale: bool,
}

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Motor less scale since `align`, in counts of the loop. To be read from `deviation_valid` to the next tick: in between it
    /// is being computed.
    pub deviation: i32,
    /// One clock: `deviation` is that of the last tick.
    pub deviation_valid: bool,
    /// Of the counter that the loop runs on, a clock late.
    pub position: i32,
    /// Q16.16 counts of that counter per tick, by the motor.
    pub velocity: i32,
}

/// Input ports in port order, with their widths.
const INPUTS: [PlainRow; 10] = [
    ("rst", 1, false),
    ("tick", 1, false),
    ("motor_position", 32, true),
    ("scale_position", 32, true),
    ("motor_velocity", 32, true),
    ("velocity_valid", 1, false),
    ("align", 1, false),
    ("ratio_mantissa", MANTISSA_BITS, true),
    ("ratio_shift", SHIFT_BITS, false),
    ("use_scale", 1, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [PlainRow; 4] = [
    ("deviation", 32, true),
    ("deviation_valid", 1, false),
    ("position", 32, true),
    ("velocity", 32, true),
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
            motor_position,
            scale_position,
            motor_velocity,
            velocity_valid,
            align,
            ratio_mantissa,
            ratio_shift,
            use_scale,
        ] = *raw;
        Self {
            rst: bit(rst),
            tick: bit(tick),
            motor_position: motor_position as i32,
            scale_position: scale_position as i32,
            motor_velocity: motor_velocity as i32,
            velocity_valid: bit(velocity_valid),
            align: bit(align),
            ratio_mantissa: wrap(ratio_mantissa as i64, MANTISSA_BITS) as i32,
            ratio_shift: (ratio_shift & 31) as u8,
            use_scale: bit(use_scale),
        }
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            u64::from(self.deviation as u32),
            u64::from(self.deviation_valid),
            u64::from(self.position as u32),
            u64::from(self.velocity as u32),
        ]
    }
}
