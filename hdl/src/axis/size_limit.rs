//! Compares the magnitude of a number with a limit. The magnitude of a negative x is taken as -x - 1, its complement,
//! which needs no carry.

use super::bytes::Bytes;
use super::larger::Larger;
use super::nonzero::Nonzero;
use crate::prelude::*;

kernel! {
    pub(super) struct SizeLimit;

    inputs {
        rst: Bit,
        tick: Bit,
        turn: Bits<2>,
        compares: Bit,
        number: Signed<32>,
        limit: Bits<32>,
        /// High: 0 is a real limit. Low: 0 disables the check.
        zero_counts: Bit,
    }
    outputs { exceeds: Bit }
    parts { number_bytes: Bytes, limit_bytes: Bytes, larger: Larger, limited: Nonzero }
    registers { negative: Bit }
    wires { number_bits: Bits<32> }
    connect {
        number_bytes, limit_bytes: turn;
        larger, limited: compares;
        limited from limit_bytes: part;
    }
}

impl Logic for SizeLimit {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_size_limit");
        self.number_bits.next = unsigned_cast(self.number.val());
        if self.tick.val() {
            self.negative.d.next = self.number_bits.val().get_bit(31);
        }
        self.number_bytes.word.next = self.number_bits.val();
        self.limit_bytes.word.next = self.limit.val();
        self.larger.signs.next = false;
        self.larger.inverts.next = self.negative.q.val();
        self.larger.number.next = self.number_bytes.part.val();
        self.larger.other.next = self.limit_bytes.part.val();
        self.exceeds.next = self.larger.larger.val() & (self.limited.nonzero.val() | self.zero_counts.val());
    }
}
