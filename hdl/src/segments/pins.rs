//! The command FIFO's ports as raw bit patterns.

use super::kernel::Segments;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for Segments {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            tick,
            enable,
            write,
            word,
            data,
            flush,
            quick_stop,
            restart,
            preset,
            preset_position,
            stop_deceleration,
            low_water,
            clear_flags,
            modulo,
            feed_hold,
        ] = inputs
        else {
            return;
        };
        let bit = |value: u64| value & 1 != 0;
        self.rst.next = bit(rst);
        self.tick.next = bit(tick);
        self.enable.next = bit(enable);
        self.write.next = bit(write);
        self.word.next = from_u64(word);
        self.data.next = from_u64(data);
        self.flush.next = bit(flush);
        self.quick_stop.next = bit(quick_stop);
        self.restart.next = bit(restart);
        self.preset.next = bit(preset);
        self.preset_position.next = from_i64(preset_position as i64);
        self.stop_deceleration.next = from_u64(stop_deceleration);
        self.low_water.next = from_u64(low_water);
        self.clear_flags.next = bit(clear_flags);
        self.modulo.next = bit(modulo);
        self.feed_hold.next = bit(feed_hold);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.position.val()).into(),
            unsigned_cast(self.velocity.val()).into(),
            unsigned_cast(self.acceleration.val()).into(),
            u64::from(self.valid.val()),
            self.state.val().into(),
            self.level.val().into(),
            u64::from(self.low.val()),
            u64::from(self.empty.val()),
            u64::from(self.notify.val()),
            u64::from(self.done.val()),
            u64::from(self.underrun.val()),
            u64::from(self.overflow.val()),
            u64::from(self.refused.val()),
            u64::from(self.malformed.val()),
            u64::from(self.tick_missed.val()),
            u64::from(self.out_of_range.val()),
            u64::from(self.rests.val()),
            u64::from(self.held.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
