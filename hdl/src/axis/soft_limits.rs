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
    connect {
        reference_bytes, plus_bytes, minus_bytes: turn;
        above, below: compares, signs;
        plus_limited, minus_limited: compares;
        plus_limited from plus_bytes: part;
        minus_limited from minus_bytes: part;
    }
}

impl Logic for SoftLimits {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_soft_limits");
        self.reference_bytes.word.next = unsigned_cast(self.reference_position.val());
        self.plus_bytes.word.next = unsigned_cast(self.soft_limit_plus.val());
        self.minus_bytes.word.next = unsigned_cast(self.soft_limit_minus.val());
        self.above.inverts.next = false;
        self.above.number.next = self.reference_bytes.part.val();
        self.above.other.next = self.plus_bytes.part.val();
        self.below.inverts.next = false;
        self.below.number.next = self.minus_bytes.part.val();
        self.below.other.next = self.reference_bytes.part.val();
        self.limited.next = (self.plus_limited.nonzero.val() | self.minus_limited.nonzero.val()) & !self.waits.val();
        self.past_plus.next = self.limited.val() & self.above.larger.val();
        self.past_minus.next = self.limited.val() & self.below.larger.val();
    }
}
