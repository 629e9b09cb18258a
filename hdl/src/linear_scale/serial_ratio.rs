//! Computes differences, product, rounding and deviation, all lowest bit first, one bit per clock.
//!
//! ```text
//! phase           0 …            31 …                           63
//! operand bit     difference        its sign
//! product bit     p0 p1 …
//! rounded         from phase `ratio_shift` on: p + carry; the first carry is the bit before
//! register        shifts down until its 32 bits are in           bits above must be like the highest
//! ```
//!
//! With the operand sign-extended, the product's 64 lowest bits need no correction for a negative operand: `partial`
//! adds the mantissa or 0, outputs its lowest bit and shifts down.

use crate::prelude::*;

kernel! {
    pub(super) struct SerialRatio;

    inputs {
        rst: Bit,
        runs: Bit,
        of_position: Bit,
        use_scale: Bit,
        ratio_mantissa: Signed<18>,
        ratio_shift: Bits<5>,
        operand_bit: Bit,
        operand_reference_bit: Bit,
        other_bit: Bit,
        other_reference_bit: Bit,
    }
    outputs {
        takes_operand: Bit,
        takes_other: Bit,
        moves: Bit,
        result_bit: Bit,
        last: Bit,
        overflows: Bit,
        negative: Bit,
    }
    registers {
        phase: Bits<6>, partial: Signed<18>, held_operand: Bit, operand_borrow: Bit, held_other: Bit,
        other_borrow: Bit, round_up: Bit, borrow: Bit, begun_q: Bit, ended_q: Bit, overflow: Bit,
        highest: Bit,
    }
    wires {
        at_shift: Bit, begun: Bit, moving: Bit, ends: Bit, operand_bit_now: Bit, operand_less: Bit,
        addend: Signed<19>, wide_partial: Signed<19>, sum: Signed<19>, sum_bits: Bits<19>, product_bit: Bit,
        rounded_bit: Bit, other_now: Bit, other_less: Bit, minuend: Bit, subtrahend: Bit, difference: Bit,
        beyond: Bit,
    }
    constants {
        nil: Signed<19> = from_i64(0),
        no_partial: Signed<18> = from_i64(0),
        first_phase: Bits<6> = from_u64(0),
        one_phase: Bits<6> = from_u64(1),
    }
}

impl Logic for SerialRatio {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module serial_ratio");

        comment!("32 bits from bit ratio_shift on are the result");
        self.at_shift.next = self.phase.q.val().get_bits::<5>(0) == self.ratio_shift.val();
        self.begun.next = self.begun_q.q.val() | self.at_shift.val();
        self.moving.next = !(self.phase.q.val().get_bit(5) & (self.at_shift.val() | self.ended_q.q.val()));
        self.ends.next = self.runs.val() & self.phase.q.val().all();

        comment!("Operand minus its reference, then sign extension");
        self.operand_less.next = self.operand_reference_bit.val() & self.of_position.val();
        self.operand_bit_now.next = self.operand_bit.val() ^ self.operand_less.val() ^ self.operand_borrow.q.val();
        if self.phase.q.val().get_bit(5) {
            self.operand_bit_now.next = self.held_operand.q.val();
        }

        comment!("Times the mantissa");
        self.addend.next = self.nil.val();
        if self.operand_bit_now.val() {
            self.addend.next = signed_bit_cast::<19, 18>(self.ratio_mantissa.val());
        }
        self.wide_partial.next = signed_bit_cast::<19, 18>(self.partial.q.val());
        self.sum.next = self.wide_partial.val() + self.addend.val();
        self.sum_bits.next = unsigned_cast(self.sum.val());
        self.product_bit.next = self.sum_bits.val().get_bit(0);

        comment!("Round half up: add the bit below the result");
        self.rounded_bit.next = self.product_bit.val() ^ self.round_up.q.val();

        comment!("The other position minus its reference, likewise");
        self.other_less.next = self.other_reference_bit.val() & self.of_position.val();
        self.other_now.next =
            (self.other_bit.val() & self.of_position.val()) ^ self.other_less.val() ^ self.other_borrow.q.val();
        if !self.moving.val() {
            self.other_now.next = self.held_other.q.val();
        }

        comment!("Motor minus scale");
        self.minuend.next = self.other_now.val();
        self.subtrahend.next = self.rounded_bit.val();
        if self.use_scale.val() {
            self.minuend.next = self.rounded_bit.val();
            self.subtrahend.next = self.other_now.val();
        }
        self.difference.next = self.minuend.val() ^ self.subtrahend.val() ^ self.borrow.q.val();

        comment!("Beyond 32 bits: a bit above differs from the top");
        self.beyond.next =
            self.overflow.q.val() | (!self.moving.val() & (self.difference.val() ^ self.highest.q.val()));

        comment!("All are cleared at the start of a computation");
        self.phase.d.next = self.first_phase.val();
        self.partial.d.next = self.no_partial.val();
        self.operand_borrow.d.next = false;
        self.other_borrow.d.next = false;
        self.round_up.d.next = false;
        self.borrow.d.next = false;
        self.begun_q.d.next = false;
        self.ended_q.d.next = false;
        self.overflow.d.next = false;
        if self.runs.val() & !self.ends.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
            self.partial.d.next = signed_cast(self.sum_bits.val().get_bits::<18>(1));
            self.operand_borrow.d.next = (!self.operand_bit.val() & self.operand_less.val())
                | (!(self.operand_bit.val() ^ self.operand_less.val()) & self.operand_borrow.q.val());
            self.other_borrow.d.next = self.begun.val()
                & ((!self.other_bit.val() & self.other_less.val())
                    | (!(self.other_bit.val() ^ self.other_less.val()) & self.other_borrow.q.val()));
            self.round_up.d.next = self.product_bit.val() & (self.round_up.q.val() | !self.begun.val());
            self.borrow.d.next = self.begun.val()
                & ((!self.minuend.val() & self.subtrahend.val())
                    | (!(self.minuend.val() ^ self.subtrahend.val()) & self.borrow.q.val()));
            self.begun_q.d.next = self.begun.val();
            self.ended_q.d.next = !self.moving.val();
            self.overflow.d.next = self.beyond.val();
        }
        self.held_operand.d.next = self.operand_bit_now.val();
        self.held_other.d.next = self.other_now.val();
        if self.moving.val() {
            self.highest.d.next = self.difference.val();
        }

        comment!("Outputs");
        self.takes_operand.next = !self.phase.q.val().get_bit(5);
        self.takes_other.next = self.begun.val() & self.moving.val();
        self.moves.next = self.moving.val();
        self.result_bit.next = self.difference.val() & self.begun.val();
        self.last.next = self.ends.val();
        self.overflows.next = self.beyond.val();
        self.negative.next = self.difference.val();
    }
}
