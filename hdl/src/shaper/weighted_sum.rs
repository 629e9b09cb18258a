//! `y = saturate( (Σ coefficient · sample + 2^(F−1)) >> F )`, exact up to the one rounding.
//!
//! `begin` puts the half that rounds into the accumulator. A coefficient comes one clock before its sample, its product
//! stands three clocks after the sample; `add` marks the products that count. A sample that is `blank` counts as 0: told in
//! the clock of its coefficient, that is 0 instead. `finish` comes in the clock after the last `add` and moves the result to
//! `y`, which holds it. `start` sets `y` to `x`.
//!
//! The result fits its word if the bits of the accumulator from the word's sign bit up are equal.
//!
//! 2^T products of W + 18 bits fit in ACC = W + 18 + T bits, the half included: the accumulator never overflows.

use super::product::Product;
use crate::prelude::*;
use posicast_model::rtl::shaper::ShaperConfig;

/// W word, P = W + 18 product, ACC = P + T accumulator bits; U of [`Product`].
#[derive(LogicBlock)]
pub(super) struct WeightedSum<const W: usize, const P: usize, const ACC: usize, const U: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) begin_pass: Signal<In, Bit>,
    pub(super) coefficient: Signal<In, Signed<18>>,
    pub(super) blank: Signal<In, Bit>,
    pub(super) sample: Signal<In, Signed<W>>,
    pub(super) add: Signal<In, Bit>,
    pub(super) finish: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) x: Signal<In, Signed<W>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) y: Signal<Out, Signed<W>>,
    pub(super) saturated: Signal<Out, Bit>,

    product: Product<W, P, U>,

    coefficient_q: Dff<Signed<18>>,
    accumulator: Dff<Signed<ACC>>,
    y_q: Dff<Signed<W>>,
    saturated_q: Dff<Bit>,

    wide_product: Signal<Local, Signed<ACC>>,
    sign_bits: Signal<Local, Bits<ACC>>,

    no_coefficient: Constant<Signed<18>>,
    half: Constant<Signed<ACC>>,
    sign_mask: Constant<Bits<ACC>>,
    all_clear: Constant<Bits<ACC>>,
    top_bit: Constant<Bits<6>>,
    y_max: Constant<Signed<W>>,
    y_min: Constant<Signed<W>>,
    fraction: Constant<Bits<5>>,
}

impl<const W: usize, const P: usize, const ACC: usize, const U: usize> WeightedSum<W, P, ACC, U> {
    pub(super) fn new(config: &ShaperConfig) -> Self {
        let fraction = config.coefficient_fraction();
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            begin_pass: Signal::default(),
            coefficient: Signal::default(),
            blank: Signal::default(),
            sample: Signal::default(),
            add: Signal::default(),
            finish: Signal::default(),
            start: Signal::default(),
            x: Signal::default(),
            clear_flags: Signal::default(),
            y: Signal::default(),
            saturated: Signal::default(),
            product: Product::default(),
            coefficient_q: Dff::default(),
            accumulator: Dff::default(),
            y_q: Dff::default(),
            saturated_q: Dff::default(),
            wide_product: Signal::default(),
            sign_bits: Signal::default(),
            no_coefficient: Constant::new(from_i64(0)),
            half: Constant::new(from_i64(1 << (fraction - 1))),
            sign_mask: Constant::new(from_u64(u64::MAX << (fraction + config.word_bits() - 1))),
            all_clear: Constant::new(from_u64(0)),
            top_bit: Constant::new(from_u64(ACC as u64 - 1)),
            y_max: Constant::new(from_i64(config.word_max())),
            y_min: Constant::new(from_i64(config.word_min())),
            fraction: Constant::new(from_u64(u64::from(fraction))),
        }
    }
}

impl<const W: usize, const P: usize, const ACC: usize, const U: usize> Logic for WeightedSum<W, P, ACC, U> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module weighted_sum_${width x}x${width half}_f${value fraction}");
        comment!("@about y = rounded, saturated sum of products.");
        comment!("@about A coefficient comes a clock before its");
        comment!("@about sample, the product 3 clocks after that.");
        dff_setup!(self, clk, coefficient_q, accumulator, y_q, saturated_q);

        comment!("Multiply and accumulate, exactly");
        self.coefficient_q.d.next = self.coefficient.val();
        if self.blank.val() {
            self.coefficient_q.d.next = self.no_coefficient.val();
        }
        self.product.clk.next = self.clk.val();
        self.product.rst.next = self.rst.val();
        self.product.sample.next = self.sample.val();
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
