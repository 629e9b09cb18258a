//! The linear scale's ports as raw bit patterns.

use super::kernel::LinearScale;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for LinearScale {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
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
        ] = inputs
        else {
            return;
        };
        let bit = |value: u64| value & 1 != 0;
        self.rst.next = bit(rst);
        self.tick.next = bit(tick);
        self.motor_position.next = from_i64(motor_position as i64);
        self.scale_position.next = from_i64(scale_position as i64);
        self.motor_velocity.next = from_i64(motor_velocity as i64);
        self.velocity_valid.next = bit(velocity_valid);
        self.align.next = bit(align);
        self.ratio_mantissa.next = from_i64(ratio_mantissa as i64);
        self.ratio_shift.next = from_u64(ratio_shift);
        self.use_scale.next = bit(use_scale);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.deviation.val()).into(),
            u64::from(self.deviation_valid.val()),
            unsigned_cast(self.position.val()).into(),
            unsigned_cast(self.velocity.val()).into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
