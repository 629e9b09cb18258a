//! A word byte by byte, lowest first: what a comparison takes in four clocks.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct Bytes {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) turn: Signal<In, Bits<2>>,
    pub(super) word: Signal<In, Bits<32>>,
    pub(super) part: Signal<Out, Bits<8>>,

    part_q: Dff<Bits<8>>,

    low: Signal<Local, Bits<8>>,
    high: Signal<Local, Bits<8>>,
}

impl Logic for Bytes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_bytes");
        comment!("@about Bytes of a word, lowest first.");
        dff_setup!(self, clk, part_q);
        self.low.next = self.word.val().get_bits::<8>(0);
        self.high.next = self.word.val().get_bits::<8>(16);
        if self.turn.val().get_bit(0) {
            self.low.next = self.word.val().get_bits::<8>(8);
            self.high.next = self.word.val().get_bits::<8>(24);
        }
        self.part_q.d.next = self.low.val();
        if self.turn.val().get_bit(1) {
            self.part_q.d.next = self.high.val();
        }
        self.part.next = self.part_q.q.val();
    }
}
