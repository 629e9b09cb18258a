//! Splits a word into bytes, lowest first, which a comparison takes in four clocks.

use crate::prelude::*;

kernel! {
    pub(super) struct Bytes;

    inputs { rst: Bit, turn: Bits<2>, word: Bits<32> }
    outputs { part: Bits<8> }
    registers { part_q: Bits<8> }
    wires { low: Bits<8>, high: Bits<8> }
}

impl Logic for Bytes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_bytes");
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
