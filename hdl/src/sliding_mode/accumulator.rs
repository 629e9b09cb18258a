//! Sums of scaled products, exact but for the one rounding of each product; and the sum cut to the words that take it.
//!
//! At `add` the accumulator becomes base + product: the base is 0 with `begin_sum`, de with `begin_rate`, else the sum so far.
//! A one below the base makes the product's lowest bit, half an LSB, round up: one adder does both.
//!
//! The sum is cut to 32 bits; to the 26 of a fraction with `as_fraction`, to the 18 of the duty with `as_duty`.
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
    pub(super) as_fraction: Signal<In, Bit>,
    pub(super) as_duty: Signal<In, Bit>,
    pub(super) word: Signal<Out, Signed<32>>,
    pub(super) high: Signal<Out, Bit>,
    pub(super) low: Signal<Out, Bit>,

    sum_q: Dff<Signed<52>>,

    rate: Signal<Local, Signed<52>>,
    base: Signal<Local, Bits<52>>,
    product: Signal<Local, Signed<53>>,
    total: Signal<Local, Bits<53>>,
    negative: Signal<Local, Bit>,
    sum: Signal<Local, Bits<52>>,
    upper: Signal<Local, Bits<21>>,
    middle: Signal<Local, Bits<7>>,
    lower: Signal<Local, Bits<9>>,
    upper_differs: Signal<Local, Bit>,
    middle_differs: Signal<Local, Bit>,
    lower_differs: Signal<Local, Bit>,
    cut: Signal<Local, Bit>,
    largest: Signal<Local, Bits<32>>,

    nothing: Constant<Bits<52>>,
    half: Constant<Bits<53>>,
    largest_word: Constant<Bits<32>>,
    largest_fraction: Constant<Bits<32>>,
    largest_duty: Constant<Bits<32>>,
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
            as_fraction: Signal::default(),
            as_duty: Signal::default(),
            word: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            sum_q: Dff::default(),
            rate: Signal::default(),
            base: Signal::default(),
            product: Signal::default(),
            total: Signal::default(),
            negative: Signal::default(),
            sum: Signal::default(),
            upper: Signal::default(),
            middle: Signal::default(),
            lower: Signal::default(),
            upper_differs: Signal::default(),
            middle_differs: Signal::default(),
            lower_differs: Signal::default(),
            cut: Signal::default(),
            largest: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            half: Constant::new(from_u64(1)),
            largest_word: Constant::new(from_u64((1 << 31) - 1)),
            largest_fraction: Constant::new(from_u64((1 << 25) - 1)),
            largest_duty: Constant::new(from_u64((1 << 17) - 1)),
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

        comment!("Cut: what lies above the sign must be as the sign");
        self.sum.next = unsigned_cast(self.sum_q.q.val());
        self.negative.next = self.sum_q.q.val().get_bit(51);
        self.upper.next = self.sum.val().get_bits::<21>(31);
        self.middle.next = self.sum.val().get_bits::<7>(25);
        self.lower.next = self.sum.val().get_bits::<9>(17);
        self.upper_differs.next = !self.upper.val().all() & self.upper.val().any();
        self.middle_differs.next = !self.middle.val().all() & self.middle.val().any();
        self.lower_differs.next = !self.lower.val().all() & self.lower.val().any();
        self.cut.next = self.upper_differs.val()
            | (self.middle_differs.val() & (self.as_fraction.val() | self.as_duty.val()))
            | (self.lower_differs.val() & self.as_duty.val());
        self.largest.next = self.largest_word.val();
        if self.as_fraction.val() {
            self.largest.next = self.largest_fraction.val();
        }
        if self.as_duty.val() {
            self.largest.next = self.largest_duty.val();
        }
        self.word.next = self.sum_q.q.val().get_bits::<32>(0);
        if self.cut.val() {
            self.word.next = signed_cast(self.largest.val());
            if self.negative.val() {
                self.word.next = signed_cast(!self.largest.val());
            }
        }
        self.high.next = self.cut.val() & !self.negative.val();
        self.low.next = self.cut.val() & self.negative.val();
    }
}
