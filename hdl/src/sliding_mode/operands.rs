//! The operand of a step: one of eight words, selected a clock before.
//!
//! Each word has a select bit, and the selected words are combined by OR: two words per LUT. The table of `kernel`
//! shows which step takes which word.

use crate::prelude::*;

kernel! {
    pub(super) struct Operands;

    inputs {
        rst: Bit,
        step: Bits<5>,
        linear: Bit,
        integrates: Bit,
        tracking_error: Signed<24>,
        sliding: Signed<32>,
        held: Signed<32>,
        integral: Signed<32>,
        velocity_reference: Signed<32>,
        acceleration_reference: Signed<32>,
        velocity: Signed<32>,
        word: Signed<32>,
    }
    outputs { operand: Signed<32> }
    registers {
        takes_error: Bit, takes_sliding: Bit, takes_held: Bit, takes_integral: Bit, takes_reference: Bit,
        takes_acceleration: Bit, takes_velocity: Bit, takes_word: Bit,
    }
    wires {
        error_bits: Bits<24>, from_error: Bits<32>, from_sliding: Bits<32>, from_held: Bits<32>,
        from_integral: Bits<32>, from_reference: Bits<32>, from_acceleration: Bits<32>,
        from_velocity: Bits<32>, from_word: Bits<32>,
    }
    constants {
        nothing: Bits<32> = from_u64(0),
        of_reference: Bits<5> = from_u64(0),
        of_velocity: Bits<5> = from_u64(1),
        rate_again: Bits<5> = from_u64(2),
        surface: Bits<5> = from_u64(3),
        boundary: Bits<5> = from_u64(4),
        on_rest: Bits<5> = from_u64(5),
        on_error: Bits<5> = from_u64(6),
        on_rate: Bits<5> = from_u64(7),
        fade: Bits<5> = from_u64(8),
        coulomb: Bits<5> = from_u64(9),
        on_feedback: Bits<5> = from_u64(10),
        on_acceleration: Bits<5> = from_u64(11),
        on_reference: Bits<5> = from_u64(12),
        on_velocity: Bits<5> = from_u64(13),
        limit: Bits<5> = from_u64(14),
        to_sum: Bits<5> = from_u64(15),
        to_duty: Bits<5> = from_u64(16),
    }
}

impl Logic for Operands {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module operands");

        comment!("Select bits of the words");
        self.takes_error.d.next = (self.step.val() == self.surface.val())
            | (self.step.val() == self.to_sum.val())
            | ((self.step.val() == self.on_error.val()) & self.linear.val());
        self.takes_sliding.d.next = (self.step.val() == self.on_error.val()) & !self.linear.val();
        self.takes_held.d.next = (self.step.val() == self.rate_again.val())
            | (self.step.val() == self.on_rate.val())
            | (self.step.val() == self.on_feedback.val())
            | (self.step.val() == self.to_duty.val());
        self.takes_integral.d.next =
            (self.step.val() == self.limit.val()) | ((self.step.val() == self.on_rest.val()) & self.integrates.val());
        self.takes_reference.d.next = (self.step.val() == self.of_reference.val())
            | (self.step.val() == self.fade.val())
            | (self.step.val() == self.on_reference.val());
        self.takes_acceleration.d.next = self.step.val() == self.on_acceleration.val();
        self.takes_velocity.d.next =
            (self.step.val() == self.of_velocity.val()) | (self.step.val() == self.on_velocity.val());
        self.takes_word.d.next = (self.step.val() == self.boundary.val())
            | (self.step.val() == self.coulomb.val())
            | ((self.step.val() == self.on_rest.val()) & !self.linear.val());

        comment!("The selected word, or 0");
        self.error_bits.next = unsigned_cast(self.tracking_error.val());
        self.from_error.next = self.nothing.val();
        if self.takes_error.q.val() {
            self.from_error.next = bit_cast::<32, 24>(self.error_bits.val()) << 8;
        }
        self.from_sliding.next = self.nothing.val();
        if self.takes_sliding.q.val() {
            self.from_sliding.next = unsigned_cast(self.sliding.val());
        }
        self.from_held.next = self.nothing.val();
        if self.takes_held.q.val() {
            self.from_held.next = unsigned_cast(self.held.val());
        }
        self.from_integral.next = self.nothing.val();
        if self.takes_integral.q.val() {
            self.from_integral.next = unsigned_cast(self.integral.val());
        }
        self.from_reference.next = self.nothing.val();
        if self.takes_reference.q.val() {
            self.from_reference.next = unsigned_cast(self.velocity_reference.val());
        }
        self.from_acceleration.next = self.nothing.val();
        if self.takes_acceleration.q.val() {
            self.from_acceleration.next = unsigned_cast(self.acceleration_reference.val());
        }
        self.from_velocity.next = self.nothing.val();
        if self.takes_velocity.q.val() {
            self.from_velocity.next = unsigned_cast(self.velocity.val());
        }
        self.from_word.next = self.nothing.val();
        if self.takes_word.q.val() {
            self.from_word.next = unsigned_cast(self.word.val());
        }
        self.operand.next = signed_cast(
            self.from_error.val()
                | self.from_sliding.val()
                | self.from_held.val()
                | self.from_integral.val()
                | self.from_reference.val()
                | self.from_acceleration.val()
                | self.from_velocity.val()
                | self.from_word.val(),
        );
    }
}
