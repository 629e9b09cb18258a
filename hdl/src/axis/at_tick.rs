//! Holds a word as it was at the last tick, from that clock on.

use crate::prelude::*;

kernel! {
    pub(super) struct AtTick;

    inputs { rst: Bit, tick: Bit, word: Signed<32> }
    outputs { stands: Signed<32> }
    registers { word_q: Signed<32> }
    wires { now: Signed<32> }
}

impl Logic for AtTick {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_at_tick");
        self.now.next = self.word_q.q.val();
        if self.tick.val() {
            self.now.next = self.word.val();
        }
        self.word_q.d.next = self.now.val();
        self.stands.next = self.now.val();
    }
}
