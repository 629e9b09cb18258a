//! Sums of scaled products, exact but for the one rounding of each product; and the sum cut to the words that take it.
//!
//! At `add` the accumulator becomes base + product: the base is 0 with `begin_sum`, de with `begin_rate`, else the sum so far.
//! A one below the base makes the product's lowest bit, half an LSB, round up: one adder does both.
//!
//! Five products of 49 bits and a word fit 52 bits: the accumulator never overflows.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Accumulator {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) add: Signal<In, Bit>,
    pub(super) begin_sum: Signal<In, Bit>,
    pub(super) begin_rate: Signal<In, Bit>,
    pub(super) error_rate: Signal<In, Signed<32>>,
    pub(super) scaled: Signal<In, Signed<51>>,
    pub(super) word: Signal<Out, Signed<32>>,
    pub(super) word_high: Signal<Out, Bit>,
    pub(super) word_low: Signal<Out, Bit>,
    pub(super) fraction: Signal<Out, Signed<26>>,
    pub(super) duty: Signal<Out, Signed<18>>,
    pub(super) duty_high: Signal<Out, Bit>,
    pub(super) duty_low: Signal<Out, Bit>,

    sum_q: Dff<Signed<52>>,

    rate: Signal<Local, Signed<52>>,
    base: Signal<Local, Bits<52>>,
    product: Signal<Local, Signed<53>>,
    total: Signal<Local, Bits<53>>,
    negative: Signal<Local, Bit>,
    above_word: Signal<Local, Bits<21>>,
    above_fraction: Signal<Local, Bits<27>>,
    above_duty: Signal<Local, Bits<35>>,
    sum: Signal<Local, Bits<52>>,
    word_fits: Signal<Local, Bit>,
    fraction_fits: Signal<Local, Bit>,
    duty_fits: Signal<Local, Bit>,

    nothing: Constant<Bits<52>>,
    half: Constant<Bits<53>>,
    largest_word: Constant<Signed<32>>,
    least_word: Constant<Signed<32>>,
    largest_fraction: Constant<Signed<26>>,
    least_fraction: Constant<Signed<26>>,
    largest_duty: Constant<Signed<18>>,
    least_duty: Constant<Signed<18>>,
}

impl Default for Accumulator {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            add: Signal::default(),
            begin_sum: Signal::default(),
            begin_rate: Signal::default(),
            error_rate: Signal::default(),
            scaled: Signal::default(),
            word: Signal::default(),
            word_high: Signal::default(),
            word_low: Signal::default(),
            fraction: Signal::default(),
            duty: Signal::default(),
            duty_high: Signal::default(),
            duty_low: Signal::default(),
            sum_q: Dff::default(),
            rate: Signal::default(),
            base: Signal::default(),
            product: Signal::default(),
            total: Signal::default(),
            negative: Signal::default(),
            above_word: Signal::default(),
            above_fraction: Signal::default(),
            above_duty: Signal::default(),
            sum: Signal::default(),
            word_fits: Signal::default(),
            fraction_fits: Signal::default(),
            duty_fits: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            half: Constant::new(from_u64(1)),
            largest_word: Constant::new(from_i64((1 << 31) - 1)),
            least_word: Constant::new(from_i64(-(1 << 31))),
            largest_fraction: Constant::new(from_i64((1 << 25) - 1)),
            least_fraction: Constant::new(from_i64(-(1 << 25))),
            largest_duty: Constant::new(from_i64((1 << 17) - 1)),
            least_duty: Constant::new(from_i64(-(1 << 17))),
        }
    }
}

impl Logic for Accumulator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module accumulator");
        comment!("@about base + product, and the sum cut to words");
        dff_setup!(self, clk, sum_q);

        comment!("Add; a one below the base rounds half up");
        self.rate.next = signed_bit_cast::<52, 32>(self.error_rate.val());
        self.base.next = unsigned_cast(self.sum_q.q.val());
        if self.begin_sum.val() {
            self.base.next = self.nothing.val();
        }
        if self.begin_rate.val() {
            self.base.next = unsigned_cast(self.rate.val());
        }
        self.product.next = signed_bit_cast::<53, 51>(self.scaled.val());
        self.total.next =
            ((bit_cast::<53, 52>(self.base.val()) << 1) | self.half.val()) + unsigned_cast(self.product.val());
        if self.add.val() {
            self.sum_q.d.next = signed_cast(self.total.val().get_bits::<52>(1));
        }

        comment!("Cut: what lies above a word's sign is as that");
        self.sum.next = unsigned_cast(self.sum_q.q.val());
        self.negative.next = self.sum_q.q.val().get_bit(51);
        self.above_word.next = self.sum.val().get_bits::<21>(31);
        self.word_fits.next = self.above_word.val().all() | !self.above_word.val().any();
        self.above_fraction.next = self.sum.val().get_bits::<27>(25);
        self.fraction_fits.next = self.above_fraction.val().all() | !self.above_fraction.val().any();
        self.above_duty.next = self.sum.val().get_bits::<35>(17);
        self.duty_fits.next = self.above_duty.val().all() | !self.above_duty.val().any();

        self.word.next = self.sum_q.q.val().get_bits::<32>(0);
        if !self.word_fits.val() {
            self.word.next = self.largest_word.val();
            if self.negative.val() {
                self.word.next = self.least_word.val();
            }
        }
        self.fraction.next = self.sum_q.q.val().get_bits::<26>(0);
        if !self.fraction_fits.val() {
            self.fraction.next = self.largest_fraction.val();
            if self.negative.val() {
                self.fraction.next = self.least_fraction.val();
            }
        }
        self.duty.next = self.sum_q.q.val().get_bits::<18>(0);
        if !self.duty_fits.val() {
            self.duty.next = self.largest_duty.val();
            if self.negative.val() {
                self.duty.next = self.least_duty.val();
            }
        }
        self.word_high.next = !self.word_fits.val() & !self.negative.val();
        self.word_low.next = !self.word_fits.val() & self.negative.val();
        self.duty_high.next = !self.duty_fits.val() & !self.negative.val();
        self.duty_low.next = !self.duty_fits.val() & self.negative.val();
    }
}
