//! Every channel's `saturate( (Σ coefficient · sample + 2^(F−1)) >> F )`, one channel after the other, shown together.
//!
//! As [`super::weighted_sum`], with a `finish` per channel: a channel's first `add` may come in the clock of the `finish` of
//! the one before. A sample goes through a register of its own before it is one: `sample_channel` comes a clock after it, and
//! the product stands four clocks after it. After that of the last channel all outputs change in one clock, and `valid` shows it.
//!
//! A position that wraps gets differences to its newest word as samples: the accumulator begins with that word times 2^F,
//! and the sum is taken modulo 2^W.
//!
//! 2 · 2^T + 1 products of W + 18 bits fit in ACC = W + 19 + T bits, the half included: the accumulator never overflows.

use super::product::Product;
use crate::prelude::*;
use posicast_model::rtl::shaper::ShaperConfig;

/// W word, P = W + 18 product, ACC = P + T + 1 accumulator bits, C channels.
#[derive(LogicBlock)]
pub(super) struct ChannelSums<const W: usize, const P: usize, const ACC: usize, const C: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) begin_pass: Signal<In, Bit>,
    pub(super) coefficient: Signal<In, Signed<18>>,
    pub(super) sample: [Signal<In, Signed<W>>; C],
    pub(super) sample_channel: Signal<In, Bits<2>>,
    pub(super) newest: Signal<In, Signed<W>>,
    pub(super) add: Signal<In, Bit>,
    pub(super) finish: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) x: [Signal<In, Signed<W>>; C],
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) y: [Signal<Out, Signed<W>>; C],
    pub(super) valid: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) saturated: Signal<Out, Bit>,

    product: Product<W, P, 1>,

    coefficient_read: Dff<Signed<18>>,
    coefficient_q: Dff<Signed<18>>,
    sample_q: [Dff<Signed<W>>; C],
    accumulator: Dff<Signed<ACC>>,
    channel: Dff<Bits<2>>,
    held: [Dff<Signed<W>>; C],
    clamped: Dff<Bit>,
    complete: Dff<Bit>,
    y_q: [Dff<Signed<W>>; C],
    valid_q: Dff<Bit>,
    busy_q: Dff<Bit>,
    saturated_q: Dff<Bit>,

    wide_product: Signal<Local, Signed<ACC>>,
    addend: Signal<Local, Signed<ACC>>,
    base: Signal<Local, Signed<ACC>>,
    operand: Signal<Local, Signed<W>>,
    position: Signal<Local, Bits<W>>,
    position_scaled: Signal<Local, Bits<ACC>>,
    sign_bits: Signal<Local, Bits<ACC>>,
    wraps: Signal<Local, Bit>,
    beyond: Signal<Local, Bit>,
    result: Signal<Local, Signed<W>>,

    half: Constant<Signed<ACC>>,
    no_product: Constant<Signed<ACC>>,
    sign_mask: Constant<Bits<ACC>>,
    all_clear: Constant<Bits<ACC>>,
    top_bit: Constant<Bits<6>>,
    y_max: Constant<Signed<W>>,
    y_min: Constant<Signed<W>>,
    fraction: Constant<Bits<5>>,
    modulo: Constant<Bit>,
    first_channel: Constant<Bits<2>>,
    one_channel: Constant<Bits<2>>,
    last_channel: Constant<Bits<2>>,
}

impl<const W: usize, const P: usize, const ACC: usize, const C: usize> ChannelSums<W, P, ACC, C> {
    pub(super) fn new(config: &ShaperConfig) -> Self {
        let fraction = config.coefficient_fraction();
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            begin_pass: Signal::default(),
            coefficient: Signal::default(),
            sample: std::array::from_fn(|_| Signal::default()),
            sample_channel: Signal::default(),
            newest: Signal::default(),
            add: Signal::default(),
            finish: Signal::default(),
            start: Signal::default(),
            x: std::array::from_fn(|_| Signal::default()),
            clear_flags: Signal::default(),
            y: std::array::from_fn(|_| Signal::default()),
            valid: Signal::default(),
            busy: Signal::default(),
            saturated: Signal::default(),
            product: Product::default(),
            coefficient_read: Dff::default(),
            coefficient_q: Dff::default(),
            sample_q: std::array::from_fn(|_| Dff::default()),
            accumulator: Dff::default(),
            channel: Dff::default(),
            held: std::array::from_fn(|_| Dff::default()),
            clamped: Dff::default(),
            complete: Dff::default(),
            y_q: std::array::from_fn(|_| Dff::default()),
            valid_q: Dff::default(),
            busy_q: Dff::default(),
            saturated_q: Dff::default(),
            wide_product: Signal::default(),
            addend: Signal::default(),
            base: Signal::default(),
            operand: Signal::default(),
            position: Signal::default(),
            position_scaled: Signal::default(),
            sign_bits: Signal::default(),
            wraps: Signal::default(),
            beyond: Signal::default(),
            result: Signal::default(),
            half: Constant::new(from_i64(1 << (fraction - 1))),
            no_product: Constant::new(from_i64(0)),
            sign_mask: Constant::new(from_u64(u64::MAX << (fraction + config.word_bits() - 1))),
            all_clear: Constant::new(from_u64(0)),
            top_bit: Constant::new(from_u64(ACC as u64 - 1)),
            y_max: Constant::new(from_i64(config.word_max())),
            y_min: Constant::new(from_i64(config.word_min())),
            fraction: Constant::new(from_u64(u64::from(fraction))),
            modulo: Constant::new(config.motion().is_some_and(|motion| motion.modulo)),
            first_channel: Constant::new(from_u64(0)),
            one_channel: Constant::new(from_u64(1)),
            last_channel: Constant::new(from_u64(C as u64 - 1)),
        }
    }
}

impl<const W: usize, const P: usize, const ACC: usize, const C: usize> Logic for ChannelSums<W, P, ACC, C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module channel_sums");
        comment!("@about y = rounded, saturated sum of products,");
        comment!("@about channel by channel, shown together.");
        comment!("@about A coefficient comes a clock before its");
        comment!("@about sample, the product 4 clocks after that.");
        dff_setup!(
            self,
            clk,
            coefficient_read,
            coefficient_q,
            accumulator,
            channel,
            clamped,
            complete,
            valid_q,
            busy_q,
            saturated_q
        );
        for i in 0..C {
            self.sample_q[i].clock.next = self.clk.val();
            self.sample_q[i].rst.next = self.rst.val();
            self.sample_q[i].d.next = self.sample[i].val();
            self.held[i].clock.next = self.clk.val();
            self.held[i].rst.next = self.rst.val();
            self.held[i].d.next = self.held[i].q.val();
            self.y_q[i].clock.next = self.clk.val();
            self.y_q[i].rst.next = self.rst.val();
            self.y_q[i].d.next = self.y_q[i].q.val();
        }

        comment!("A position that wraps: the way to the newest");
        self.operand.next = self.sample_q[0].q.val();
        if self.modulo.val() & (self.sample_channel.val() == self.first_channel.val()) {
            self.operand.next = self.sample_q[0].q.val() - self.newest.val();
        }
        for i in 1..C {
            if self.sample_channel.val() == i.to_bits() {
                self.operand.next = self.sample_q[i].q.val();
            }
        }

        comment!("Multiply and accumulate, exactly");
        self.coefficient_read.d.next = self.coefficient.val();
        self.coefficient_q.d.next = self.coefficient_read.q.val();
        self.product.clk.next = self.clk.val();
        self.product.rst.next = self.rst.val();
        self.product.sample.next = self.operand.val();
        self.product.coefficient.next = self.coefficient_q.q.val();
        self.wide_product.next = signed_bit_cast::<ACC, P>(self.product.product.val());
        self.addend.next = self.no_product.val();
        if self.add.val() {
            self.addend.next = self.wide_product.val();
        }
        self.base.next = self.accumulator.q.val();
        if self.finish.val() {
            self.base.next = self.half.val();
        }
        self.position.next = unsigned_cast(self.x[0].val());
        self.position_scaled.next = bit_cast::<ACC, W>(self.position.val()) << self.fraction.val();
        self.accumulator.d.next = self.base.val() + self.addend.val();
        if self.begin_pass.val() {
            self.accumulator.d.next = self.half.val();
        }
        if self.begin_pass.val() & self.modulo.val() {
            self.accumulator.d.next = signed_cast(self.position_scaled.val()) + self.half.val();
        }

        comment!("Shift by F bits and saturate");
        self.wraps.next = self.modulo.val() & (self.channel.q.val() == self.first_channel.val());
        self.sign_bits.next = unsigned_cast(self.accumulator.q.val()) & self.sign_mask.val();
        self.beyond.next = (self.sign_bits.val() != self.all_clear.val())
            & (self.sign_bits.val() != self.sign_mask.val())
            & !self.wraps.val();
        self.result.next = self.accumulator.q.val().get_bits::<W>(self.fraction.val().index());
        if self.beyond.val() {
            self.result.next = self.y_max.val();
            if self.accumulator.q.val().get_bit(self.top_bit.val().index()) {
                self.result.next = self.y_min.val();
            }
        }

        comment!("Each channel's result, until the last is there");
        self.complete.d.next = false;
        if self.finish.val() {
            for i in 0..C {
                if self.channel.q.val() == i.to_bits() {
                    self.held[i].d.next = self.result.val();
                }
            }
            self.clamped.d.next = self.clamped.q.val() | self.beyond.val();
            self.channel.d.next = self.channel.q.val() + self.one_channel.val();
            self.complete.d.next = self.channel.q.val() == self.last_channel.val();
        }

        comment!("All outputs in one clock");
        if self.clear_flags.val() {
            self.saturated_q.d.next = false;
        }
        self.valid_q.d.next = false;
        if self.complete.q.val() & !(self.start.val() | self.begin_pass.val()) {
            for i in 0..C {
                self.y_q[i].d.next = self.held[i].q.val();
            }
            self.valid_q.d.next = true;
            self.busy_q.d.next = false;
            if self.clamped.q.val() {
                self.saturated_q.d.next = true;
            }
        }
        if self.start.val() {
            for i in 0..C {
                self.y_q[i].d.next = self.x[i].val();
            }
        }

        comment!("A start or a new pass cuts off what runs");
        if self.start.val() | self.begin_pass.val() {
            self.channel.d.next = self.first_channel.val();
            self.clamped.d.next = false;
            self.complete.d.next = false;
            self.busy_q.d.next = self.begin_pass.val();
        }

        comment!("Outputs");
        for i in 0..C {
            self.y[i].next = self.y_q[i].q.val();
        }
        self.valid.next = self.valid_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
