//! Splits half a word into nibbles, lowest first, which a comparison takes in four clocks.

use crate::prelude::*;

kernel! {
    pub(super) struct Nibbles;

    inputs { rst: Bit, turn: Bits<2>, word: Bits<16> }
    outputs { part: Bits<4> }
    registers { part_q: Bits<4> }
    wires { low: Bits<4>, high: Bits<4> }
}

impl Logic for Nibbles {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_nibbles");
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
