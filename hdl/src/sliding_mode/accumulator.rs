//! Sums scaled products, exactly except for the one rounding of each product, and saturates the sum to the words that
//! take it.
//!
//! `add` adds the product to the sum, `empty` begins a new one. A one below the sum makes the product's lowest bit,
//! half an LSB, round up: one adder does both.
//!
//! At `check` the word becomes the sum, saturated to 32 bits; with `as_fraction` to the 26 of a fraction, with
//! `as_duty` to the 18 of the duty. The word is registered, so the choice between a sum and its limits exists once.
//!
//! Five products of 49 bits and a word fit 52 bits: the accumulator never overflows.

use crate::prelude::*;

kernel! {
    pub(super) struct Accumulator;

    inputs { rst: Bit, empty: Bit, add: Bit, check: Bit, scaled: Signed<51>, as_fraction: Bit, as_duty: Bit }
    outputs { word: Signed<32>, cut: Bit, negative: Bit }
    registers { sum_q: Signed<52>, word_q: Signed<32>, cut_q: Bit, negative_q: Bit }
    wires {
        base: Bits<52>, product: Signed<53>, total: Bits<53>, sum_negative: Bit, upper: Bits<21>,
        middle: Bits<7>, lower: Bits<9>, upper_differs: Bit, middle_differs: Bit, lower_differs: Bit,
        passes: Bit, largest: Bits<32>,
    }
    constants {
        nothing: Signed<52> = from_i64(0),
        half: Bits<53> = from_u64(1),
        largest_word: Bits<32> = from_u64((1 << 31) - 1),
        largest_fraction: Bits<32> = from_u64((1 << 25) - 1),
        largest_duty: Bits<32> = from_u64((1 << 17) - 1),
    }
}

impl Logic for Accumulator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module accumulator");

        comment!("Add; a one below the base rounds half up");
        self.product.next = signed_bit_cast::<53, 51>(self.scaled.val());
        self.base.next = unsigned_cast(self.sum_q.q.val());
        self.total.next =
            ((bit_cast::<53, 52>(self.base.val()) << 1) | self.half.val()) + unsigned_cast(self.product.val());
        if self.add.val() {
            self.sum_q.d.next = signed_cast(self.total.val().get_bits::<52>(1));
        }
        if self.empty.val() {
            self.sum_q.d.next = self.nothing.val();
        }

        comment!("Saturated unless all bits above equal the sign");
        self.sum_negative.next = self.sum_q.q.val().get_bit(51);
        self.upper.next = self.base.val().get_bits::<21>(31);
        self.middle.next = self.base.val().get_bits::<7>(25);
        self.lower.next = self.base.val().get_bits::<9>(17);
        self.upper_differs.next = !self.upper.val().all() & self.upper.val().any();
        self.middle_differs.next = !self.middle.val().all() & self.middle.val().any();
        self.lower_differs.next = !self.lower.val().all() & self.lower.val().any();
        self.passes.next = self.upper_differs.val()
            | (self.middle_differs.val() & (self.as_fraction.val() | self.as_duty.val()))
            | (self.lower_differs.val() & self.as_duty.val());
        self.largest.next = self.largest_word.val();
        if self.as_fraction.val() {
            self.largest.next = self.largest_fraction.val();
        }
        if self.as_duty.val() {
            self.largest.next = self.largest_duty.val();
        }
        if self.check.val() {
            self.cut_q.d.next = self.passes.val();
            self.negative_q.d.next = self.sum_negative.val();
            self.word_q.d.next = self.sum_q.q.val().get_bits::<32>(0);
            if self.passes.val() {
                self.word_q.d.next = signed_cast(self.largest.val());
                if self.sum_negative.val() {
                    self.word_q.d.next = signed_cast(!self.largest.val());
                }
            }
        }
        self.word.next = self.word_q.q.val();
        self.cut.next = self.cut_q.q.val();
        self.negative.next = self.negative_q.q.val();
    }
}
