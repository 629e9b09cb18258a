//! The pins of the shaper for motion, as raw bit patterns.

use super::motion::MotionShaper;
use crate::prelude::*;
use crate::simulation::Pins;

impl<
    const W: usize,
    const P: usize,
    const ACC: usize,
    const A: usize,
    const T: usize,
    const COUNT: usize,
    const SUM: usize,
    const WORD: usize,
    const C: usize,
    const H: usize,
> Pins for MotionShaper<W, P, ACC, A, T, COUNT, SUM, WORD, C, H>
{
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.strobe.next = next() & 1 != 0;
        self.start.next = next() & 1 != 0;
        for x in &mut self.x {
            x.next = from_i64(next() as i64);
        }
        self.clear_flags.next = next() & 1 != 0;
        self.tap_write.next = next() & 1 != 0;
        self.tap_bank.next = from_u64(next());
        self.tap_index.next = from_u64(next());
        self.tap_coefficient.next = from_i64(next() as i64);
        self.tap_delay.next = from_u64(next());
        self.swap.next = next() & 1 != 0;
        self.swap_bank.next = from_u64(next());
        self.swap_how.next = from_u64(next());
    }

    fn read(&self, outputs: &mut [u64]) {
        let words = self.y.iter().map(|y| unsigned_cast(y.val()).into());
        let flags = [
            u64::from(self.valid.val()),
            u64::from(self.saturated.val()),
            u64::from(self.busy.val()),
            u64::from(self.overrun.val()),
            u64::from(self.swap_pending.val()),
            self.bank.val().into(),
            u64::from(self.refused.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(words.chain(flags)) {
            *output = value;
        }
    }
}
