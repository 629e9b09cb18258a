//! Half a word nibble by nibble, lowest first: what a comparison takes in four clocks.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct Nibbles {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) turn: Signal<In, Bits<2>>,
    pub(super) word: Signal<In, Bits<16>>,
    pub(super) part: Signal<Out, Bits<4>>,

    part_q: Dff<Bits<4>>,

    low: Signal<Local, Bits<4>>,
    high: Signal<Local, Bits<4>>,
}

impl Logic for Nibbles {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_nibbles");
        comment!("@about Nibbles of half a word, lowest first.");
        dff_setup!(self, clk, part_q);
        self.low.next = self.word.val().get_bits::<4>(0);
        self.high.next = self.word.val().get_bits::<4>(8);
        if self.turn.val().get_bit(0) {
            self.low.next = self.word.val().get_bits::<4>(4);
            self.high.next = self.word.val().get_bits::<4>(12);
        }
        self.part_q.d.next = self.low.val();
        if self.turn.val().get_bit(1) {
            self.part_q.d.next = self.high.val();
        }
        self.part.next = self.part_q.q.val();
    }
}
