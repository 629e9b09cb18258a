//! Takes a new level once it has lasted for more than `filter_clocks` clocks; until `ready`, the level follows the
//! input.
//!
//! It counts down from `filter_clocks`, which it loads in every clock without a difference, so that it needs only a
//! comparison with 0.

use crate::prelude::*;

kernel! {
    pub(crate) struct GlitchFilter;

    inputs { rst: Bit, input_level: Bit, ready: Bit, filter_clocks: Bits<6> }
    outputs { level: Bit }
    registers { level_q: Bit, left: Bits<6> }
    constants { no_clocks: Bits<6> = from_u64(0), one_clock: Bits<6> = from_u64(1) }
}

impl Logic for GlitchFilter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module glitch_filter");
        self.left.d.next = self.left.q.val() - self.one_clock.val();
        if self.input_level.val() == self.level_q.q.val() {
            self.left.d.next = self.filter_clocks.val();
        }
        if !self.ready.val() | (self.left.q.val() == self.no_clocks.val()) {
            self.level_q.d.next = self.input_level.val();
            self.left.d.next = self.filter_clocks.val();
        }
        self.level.next = self.level_q.q.val();
    }
}
