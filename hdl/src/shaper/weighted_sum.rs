//! Computes `y = saturate( (Σ coefficient · sample + 2^(F−1)) >> F )`, exactly except for the one rounding.
//!
//! `begin_pass` loads the half for rounding into the accumulator. A coefficient comes one clock before its sample, and
//! its product three clocks after the sample; `add` marks the products that are added. If `blank` is high with a
//! coefficient, its sample counts as 0. `finish` comes in the clock after the last `add` and moves the result to `y`,
//! which holds it. `start` sets `y` to `x`.
//!
//! The result fits its word if the accumulator's bits from the word's sign bit up are equal.
//!
//! 2^T products of W + 18 bits fit in ACC = W + 18 + T bits, including the half: the accumulator never overflows.

use super::product::Product;
use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;

kernel! {
    /// Sizes: W word bits, P = W + 18 product bits, ACC = P + T accumulator bits; U as in [`Product`].
    pub(super) struct WeightedSum<const W: usize, const P: usize, const ACC: usize, const U: usize>
        (config: &ShaperConfig);

    inputs {
        rst: Bit,
        begin_pass: Bit,
        coefficient: Signed<18>,
        blank: Bit,
        sample: Signed<W>,
        add: Bit,
        finish: Bit,
        start: Bit,
        x: Signed<W>,
        clear_flags: Bit,
    }
    outputs { y: Signed<W>, saturated: Bit }
    parts { product: Product<W, P, U> }
    registers { coefficient_q: Signed<18>, accumulator: Signed<ACC>, y_q: Signed<W>, saturated_q: Bit }
    wires { wide_product: Signed<ACC>, sign_bits: Bits<ACC> }
    constants {
        no_coefficient: Signed<18> = from_i64(0),
        half: Signed<ACC> = from_i64(1 << (config.coefficient_fraction() - 1)),
        sign_mask: Bits<ACC> = from_u64(u64::MAX << (config.coefficient_fraction() + config.word_bits() - 1)),
        all_clear: Bits<ACC> = from_u64(0),
        top_bit: Bits<6> = from_u64(ACC as u64 - 1),
        y_max: Signed<W> = from_i64(config.word_max()),
        y_min: Signed<W> = from_i64(config.word_min()),
        fraction: Bits<5> = from_u64(u64::from(config.coefficient_fraction())),
    }
    connect {
        product: sample;
    }
}

impl<const W: usize, const P: usize, const ACC: usize, const U: usize> Logic for WeightedSum<W, P, ACC, U> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module weighted_sum_${width x}x${width half}_f${value fraction}");

        comment!("Multiply and accumulate, exactly");
        self.coefficient_q.d.next = self.coefficient.val();
        if self.blank.val() {
            self.coefficient_q.d.next = self.no_coefficient.val();
        }
        self.product.coefficient.next = self.coefficient_q.q.val();
        self.wide_product.next = signed_bit_cast::<ACC, P>(self.product.product.val());
        if self.add.val() {
            self.accumulator.d.next = self.accumulator.q.val() + self.wide_product.val();
        }
        if self.begin_pass.val() {
            self.accumulator.d.next = self.half.val();
        }

        comment!("Shift by F bits and saturate");
        if self.clear_flags.val() {
            self.saturated_q.d.next = false;
        }
        self.sign_bits.next = unsigned_cast(self.accumulator.q.val()) & self.sign_mask.val();
        if self.finish.val() {
            self.y_q.d.next = self.accumulator.q.val().get_bits::<W>(self.fraction.val().index());
            if (self.sign_bits.val() != self.all_clear.val()) & (self.sign_bits.val() != self.sign_mask.val()) {
                self.saturated_q.d.next = true;
                self.y_q.d.next = self.y_max.val();
                if self.accumulator.q.val().get_bit(self.top_bit.val().index()) {
                    self.y_q.d.next = self.y_min.val();
                }
            }
        }
        if self.start.val() {
            self.y_q.d.next = self.x.val();
        }

        comment!("Outputs");
        self.y.next = self.y_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
