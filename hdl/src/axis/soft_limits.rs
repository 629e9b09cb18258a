//! The shaped position against both soft limits; none where both are 0.

use super::bytes::Bytes;
use super::larger::Larger;
use super::nonzero::Nonzero;
use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct SoftLimits {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) turn: Signal<In, Bits<2>>,
    pub(super) compares: Signal<In, Bit>,
    pub(super) signs: Signal<In, Bit>,
    pub(super) reference_position: Signal<In, Signed<32>>,
    pub(super) soft_limit_plus: Signal<In, Signed<32>>,
    pub(super) soft_limit_minus: Signal<In, Signed<32>>,
    pub(super) past_plus: Signal<Out, Bit>,
    pub(super) past_minus: Signal<Out, Bit>,

    reference_bytes: Bytes,
    plus_bytes: Bytes,
    minus_bytes: Bytes,
    above: Larger,
    below: Larger,
    plus_limited: Nonzero,
    minus_limited: Nonzero,

    limited: Signal<Local, Bit>,
}

impl Logic for SoftLimits {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_soft_limits");
        comment!("@about The shaped position, two soft limits.");
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
        self.limited.next = self.plus_limited.nonzero.val() | self.minus_limited.nonzero.val();
        self.past_plus.next = self.limited.val() & self.above.larger.val();
        self.past_minus.next = self.limited.val() & self.below.larger.val();
    }
}
