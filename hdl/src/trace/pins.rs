//! The trace memory's ports as raw bit patterns.

use super::kernel::Trace;
use crate::prelude::*;
use crate::simulation::Pins;

impl<const A: usize, const R: usize> Pins for Trace<A, R> {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.strobe.next = next() & 1 != 0;
        for signal in &mut self.signal {
            signal.next = from_i64(next() as i64);
        }
        self.select_0.next = from_u64(next());
        self.select_1.next = from_u64(next());
        self.select_2.next = from_u64(next());
        self.select_3.next = from_u64(next());
        self.signals.next = from_u64(next());
        self.decimation.next = from_u64(next());
        self.trigger_select.next = from_u64(next());
        self.trigger_mode.next = from_u64(next());
        self.trigger_level.next = from_i64(next() as i64);
        self.trigger_event.next = next() & 1 != 0;
        self.pre_trigger.next = from_u64(next());
        self.arm.next = next() & 1 != 0;
        self.halt.next = next() & 1 != 0;
        self.read_address.next = from_u64(next());
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            self.data.val().into(),
            self.state.val().into(),
            self.rows.val().into(),
            self.trigger_row.val().into(),
            u64::from(self.missed.val()),
            u64::from(self.done.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
