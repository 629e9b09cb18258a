//! Holds the value that a word had at the last tick; in the clock of a tick it already has the new value.

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
