//! The controller's ports as raw bit patterns.

use super::kernel::SlidingMode;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for SlidingMode {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            start,
            law,
            modulo,
            position_reference,
            velocity_reference,
            acceleration_reference,
            position,
            velocity,
            setting,
            clear_integral,
            clear_flags,
        ] = inputs
        else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.start.next = start & 1 != 0;
        self.law.next = from_u64(law);
        self.modulo.next = modulo & 1 != 0;
        self.position_reference.next = from_i64(position_reference as i64);
        self.velocity_reference.next = from_i64(velocity_reference as i64);
        self.acceleration_reference.next = from_i64(acceleration_reference as i64);
        self.position.next = from_i64(position as i64);
        self.velocity.next = from_i64(velocity as i64);
        self.setting.next = from_u64(setting);
        self.clear_integral.next = clear_integral & 1 != 0;
        self.clear_flags.next = clear_flags & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown: [u64; 14] = [
            self.setting_address.val().into(),
            unsigned_cast(self.error.val()).into(),
            unsigned_cast(self.sliding.val()).into(),
            unsigned_cast(self.command.val()).into(),
            unsigned_cast(self.duty.val()).into(),
            self.valid.val().into(),
            self.busy.val().into(),
            self.limited_high.val().into(),
            self.limited_low.val().into(),
            self.limited_ticks.val().into(),
            self.saturated_high.val().into(),
            self.saturated_low.val().into(),
            self.overrun.val().into(),
            self.ends.val().into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
