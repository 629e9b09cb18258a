//! The excitation's ports as raw bit patterns.

use super::kernel::Excitation;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for Excitation {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            valid,
            y_0,
            y_1,
            y_2,
            enable,
            allowed,
            kind,
            amplitude,
            amplitude_limit,
            period_ticks,
            sweep,
            duration_ticks,
            modulo,
        ] = inputs
        else {
            return;
        };
        let bit = |value: u64| value & 1 != 0;
        self.rst.next = bit(rst);
        self.valid.next = bit(valid);
        self.y_0.next = from_i64(y_0 as i64);
        self.y_1.next = from_i64(y_1 as i64);
        self.y_2.next = from_i64(y_2 as i64);
        self.enable.next = bit(enable);
        self.allowed.next = bit(allowed);
        self.kind.next = from_u64(kind);
        self.amplitude.next = from_u64(amplitude);
        self.amplitude_limit.next = from_u64(amplitude_limit);
        self.period_ticks.next = from_u64(period_ticks);
        self.sweep.next = from_u64(sweep);
        self.duration_ticks.next = from_u64(duration_ticks);
        self.modulo.next = bit(modulo);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.position_reference.val()).into(),
            unsigned_cast(self.velocity_reference.val()).into(),
            unsigned_cast(self.acceleration_reference.val()).into(),
            u64::from(self.reference_valid.val()),
            unsigned_cast(self.excitation_value.val()).into(),
            u64::from(self.excitation_active.val()),
            u64::from(self.excitation_done.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
