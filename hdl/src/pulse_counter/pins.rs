//! The pulse counter's ports as raw bit patterns.

use super::kernel::PulseCounter;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for PulseCounter {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            a,
            b,
            z,
            a_n,
            b_n,
            z_n,
            differential,
            filter_clocks,
            mode,
            swap,
            invert,
            index_arm,
            index_always,
            index_presets,
            index_gate,
            preset,
            preset_value,
            clear_flags,
            tick,
            time_stamp,
            velocity_m,
            smoothing,
            timeout,
            quotient_valid,
            quotient,
        ] = inputs
        else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.a.next = a & 1 != 0;
        self.b.next = b & 1 != 0;
        self.z.next = z & 1 != 0;
        self.a_n.next = a_n & 1 != 0;
        self.b_n.next = b_n & 1 != 0;
        self.z_n.next = z_n & 1 != 0;
        self.differential.next = differential & 1 != 0;
        self.filter_clocks.next = from_u64(filter_clocks);
        self.mode.next = from_u64(mode);
        self.swap.next = swap & 1 != 0;
        self.invert.next = invert & 1 != 0;
        self.index_arm.next = index_arm & 1 != 0;
        self.index_always.next = index_always & 1 != 0;
        self.index_presets.next = index_presets & 1 != 0;
        self.index_gate.next = from_u64(index_gate);
        self.preset.next = preset & 1 != 0;
        self.preset_value.next = from_i64(preset_value as i64);
        self.clear_flags.next = clear_flags & 1 != 0;
        self.tick.next = tick & 1 != 0;
        self.time_stamp.next = from_u64(time_stamp);
        self.velocity_m.next = velocity_m & 1 != 0;
        self.smoothing.next = from_u64(smoothing);
        self.timeout.next = from_u64(timeout);
        self.quotient_valid.next = quotient_valid & 1 != 0;
        self.quotient.next = from_i64(quotient as i64);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.count.val()).into(),
            unsigned_cast(self.origin.val()).into(),
            unsigned_cast(self.position.val()).into(),
            unsigned_cast(self.index_count.val()).into(),
            u64::from(self.index_seen.val()),
            u64::from(self.index_armed.val()),
            self.illegal_count.val().into(),
            u64::from(self.illegal.val()),
            u64::from(self.disagreement.val()),
            u64::from(self.level_a.val()),
            u64::from(self.level_b.val()),
            u64::from(self.level_z.val()),
            unsigned_cast(self.steps.val()).into(),
            self.elapsed.val().into(),
            u64::from(self.velocity_pending.val()),
            unsigned_cast(self.velocity.val()).into(),
            u64::from(self.velocity_valid.val()),
            u64::from(self.velocity_missed.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
