//! A word as it stood at the last tick, from that clock on.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct AtTick {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) stands: Signal<Out, Signed<32>>,

    word_q: Dff<Signed<32>>,

    now: Signal<Local, Signed<32>>,
}

impl Logic for AtTick {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_at_tick");
        comment!("@about A word as it stood at the last tick.");
        dff_setup!(self, clk, word_q);
        self.now.next = self.word_q.q.val();
        if self.tick.val() {
            self.now.next = self.word.val();
        }
        self.word_q.d.next = self.now.val();
        self.stands.next = self.now.val();
    }
}
