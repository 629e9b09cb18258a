//! Compares the shaped position with both soft limits. The limits are disabled if both are 0, or while `waits` is high.

use super::bytes::Bytes;
use super::larger::Larger;
use super::nonzero::Nonzero;
use crate::prelude::*;

kernel! {
    pub(super) struct SoftLimits;

    inputs {
        rst: Bit,
        turn: Bits<2>,
        compares: Bit,
        signs: Bit,
        reference_position: Signed<32>,
        soft_limit_plus: Signed<32>,
        soft_limit_minus: Signed<32>,
        /// High: neither limit is in force yet.
        waits: Bit,
    }
    outputs { past_plus: Bit, past_minus: Bit }
    parts {
        reference_bytes: Bytes,
        plus_bytes: Bytes,
        minus_bytes: Bytes,
        above: Larger,
        below: Larger,
        plus_limited: Nonzero,
        minus_limited: Nonzero,
    }
    wires { limited: Bit }
}

impl Logic for SoftLimits {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_soft_limits");
        self.reference_bytes.clk.next = self.clk.val();
        self.reference_bytes.rst.next = self.rst.val();
        self.reference_bytes.turn.next = self.turn.val();
        self.reference_bytes.word.next = unsigned_cast(self.reference_position.val());
        self.plus_bytes.clk.next = self.clk.val();
        self.plus_bytes.rst.next = self.rst.val();
        self.plus_bytes.turn.next = self.turn.val();
        self.plus_bytes.word.next = unsigned_cast(self.soft_limit_plus.val());
        self.minus_bytes.clk.next = self.clk.val();
        self.minus_bytes.rst.next = self.rst.val();
        self.minus_bytes.turn.next = self.turn.val();
        self.minus_bytes.word.next = unsigned_cast(self.soft_limit_minus.val());
        self.above.clk.next = self.clk.val();
        self.above.rst.next = self.rst.val();
        self.above.compares.next = self.compares.val();
        self.above.signs.next = self.signs.val();
        self.above.inverts.next = false;
        self.above.number.next = self.reference_bytes.part.val();
        self.above.other.next = self.plus_bytes.part.val();
        self.below.clk.next = self.clk.val();
        self.below.rst.next = self.rst.val();
        self.below.compares.next = self.compares.val();
        self.below.signs.next = self.signs.val();
        self.below.inverts.next = false;
        self.below.number.next = self.minus_bytes.part.val();
        self.below.other.next = self.reference_bytes.part.val();
        self.plus_limited.clk.next = self.clk.val();
        self.plus_limited.rst.next = self.rst.val();
        self.plus_limited.compares.next = self.compares.val();
        self.plus_limited.part.next = self.plus_bytes.part.val();
        self.minus_limited.clk.next = self.clk.val();
        self.minus_limited.rst.next = self.rst.val();
        self.minus_limited.compares.next = self.compares.val();
        self.minus_limited.part.next = self.minus_bytes.part.val();
        self.limited.next = (self.plus_limited.nonzero.val() | self.minus_limited.nonzero.val()) & !self.waits.val();
        self.past_plus.next = self.limited.val() & self.above.larger.val();
        self.past_minus.next = self.limited.val() & self.below.larger.val();
    }
}
