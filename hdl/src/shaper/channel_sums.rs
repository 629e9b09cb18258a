//! Computes `saturate( (Σ coefficient · sample + 2^(F−1)) >> F )` of every channel, one after the other, and outputs
//! all results in one clock.
//!
//! `begin_pass` is the strobe. A `boundary` comes before the products of the first channel, and after those of each
//! channel: it stores the sum of the channel that ends, and loads the accumulator with the half for rounding. Products
//! between two boundaries are added; the product in the clock of a boundary is ignored. At the last boundary all
//! outputs change, and `valid` is high for one clock.
//!
//! A sample is that of `sample_channel`. It counts as 0 if `blank` was high one clock before. Its product comes four
//! clocks after it.
//!
//! The result fits its word if the accumulator's bits from the word's sign bit up are equal. If it does not, its
//! register is cleared, which takes no logic, and a flag shows whether the result is above or below the word.
//!
//! For a position that wraps, the samples are differences from its newest word: the accumulator begins with that word
//! times 2^F, and the sum is taken modulo 2^W.
//!
//! 2 · 2^T + 1 products of W + 18 bits fit in ACC = W + 19 + T bits, including the half: the accumulator never
//! overflows.

use super::product::Product;
use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;

kernel! {
    /// Sizes: W word bits, P = W + 18 product bits, ACC = P + T + 1 accumulator bits, C channels, H = C − 1 results
    /// that wait for the last one.
    pub(super) struct ChannelSums<const W: usize, const P: usize, const ACC: usize, const C: usize, const H: usize>
        (config: &ShaperConfig);

    inputs {
        rst: Bit,
        begin_pass: Bit,
        coefficient: Signed<18>,
        sample[C]: Signed<W>,
        blank: Bit,
        sample_channel: Bits<2>,
        newest: Signed<W>,
        boundary: Bit,
        start: Bit,
        x[C]: Signed<W>,
        clear_flags: Bit,
    }
    outputs { y[C]: Signed<W>, valid: Bit, busy: Bit, saturated: Bit }
    parts { product: Product<W, P, 1> }
    registers {
        coefficient_read: Signed<18>, coefficient_q: Signed<18>, blank_read: Bit, sample_q: Signed<W>,
        accumulator: Signed<ACC>, channel: Bits<2>, held[H]: Bits<W>, held_above[H]: Bit, held_below[H]: Bit,
        clamped: Bit, y_q[C]: Signed<W>, valid_q: Bit, busy_q: Bit, saturated_q: Bit,
    }
    wires {
        wide_product: Signed<ACC>, operand: Signed<W>, position: Bits<W>, position_scaled: Bits<ACC>,
        accumulator_bits: Bits<ACC>, sign_bits: Bits<ACC>, before_first: Bit, wraps: Bit, beyond: Bit,
        above: Bit, below: Bit, result: Bits<W>, cut_off: Bit, shows: Bit,
    }
    constants {
        half: Signed<ACC> = from_i64(1 << (config.coefficient_fraction() - 1)),
        no_sample: Signed<W> = from_i64(0),
        sign_mask: Bits<ACC> = from_u64(u64::MAX << (config.coefficient_fraction() + config.word_bits() - 1)),
        all_clear: Bits<ACC> = from_u64(0),
        top_bit: Bits<6> = from_u64(ACC as u64 - 1),
        y_max: Bits<W> = from_u64(config.word_max() as u64),
        y_min: Bits<W> = from_u64(config.word_min() as u64),
        no_result: Bits<W> = from_u64(0),
        fraction: Bits<5> = from_u64(u64::from(config.coefficient_fraction())),
        modulo: Bit = config.motion().is_some_and(|motion| motion.modulo),
        first_channel: Bits<2> = from_u64(0),
        one_channel: Bits<2> = from_u64(1),
        last_channel: Bits<2> = from_u64(C as u64 - 1),
        no_channel: Bits<2> = from_u64(3),
    }
}

impl<const W: usize, const P: usize, const ACC: usize, const C: usize, const H: usize> Logic
    for ChannelSums<W, P, ACC, C, H>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module channel_sums_${width x$0}x${width half}x${count x}_f${value fraction}${if modulo _modulo}");
        for i in 0..H {
            self.held[i].d.next = self.held[i].q.val();
            self.held_above[i].d.next = self.held_above[i].q.val();
            self.held_below[i].d.next = self.held_below[i].q.val();
        }
        for i in 0..C {
            self.y_q[i].d.next = self.y_q[i].q.val();
        }

        comment!("Sample of the channel; 0 if there was none");
        self.blank_read.d.next = self.blank.val();
        self.sample_q.d.next = self.sample[0].val();
        for i in 1..C {
            if self.sample_channel.val() == i.to_bits() {
                self.sample_q.d.next = self.sample[i].val();
            }
        }
        if self.blank_read.q.val() {
            self.sample_q.d.next = self.no_sample.val();
        }

        comment!("A wrapping position: difference from the newest");
        self.operand.next = self.sample_q.q.val();
        if self.modulo.val() & (self.sample_channel.val() == self.first_channel.val()) {
            self.operand.next = self.sample_q.q.val() - self.newest.val();
        }

        comment!("Multiply and accumulate, exactly");
        self.coefficient_read.d.next = self.coefficient.val();
        self.coefficient_q.d.next = self.coefficient_read.q.val();
        self.product.sample.next = self.operand.val();
        self.product.coefficient.next = self.coefficient_q.q.val();
        self.wide_product.next = signed_bit_cast::<ACC, P>(self.product.product.val());
        self.before_first.next = self.channel.q.val() == self.no_channel.val();
        self.position.next = unsigned_cast(self.newest.val());
        self.position_scaled.next = bit_cast::<ACC, W>(self.position.val()) << self.fraction.val();
        if self.busy_q.q.val() {
            self.accumulator.d.next = self.accumulator.q.val() + self.wide_product.val();
        }
        if self.boundary.val() {
            self.accumulator.d.next = self.half.val();
        }
        if self.boundary.val() & self.before_first.val() & self.modulo.val() {
            self.accumulator.d.next = signed_cast(self.position_scaled.val()) + self.half.val();
        }

        comment!("Shift by F bits; detect what does not fit");
        self.wraps.next = self.modulo.val() & (self.channel.q.val() == self.first_channel.val());
        self.accumulator_bits.next = unsigned_cast(self.accumulator.q.val());
        self.sign_bits.next = self.accumulator_bits.val() & self.sign_mask.val();
        self.beyond.next = (self.sign_bits.val() != self.all_clear.val())
            & (self.sign_bits.val() != self.sign_mask.val())
            & !self.wraps.val();
        self.below.next = self.beyond.val() & self.accumulator.q.val().get_bit(self.top_bit.val().index());
        self.above.next = self.beyond.val() & !self.accumulator.q.val().get_bit(self.top_bit.val().index());
        self.result.next = self.accumulator_bits.val().get_bits::<W>(self.fraction.val().index());

        comment!("Results of the channels, until the last is ready");
        self.cut_off.next = self.start.val() | self.begin_pass.val();
        self.shows.next = self.boundary.val() & (self.channel.q.val() == self.last_channel.val()) & !self.cut_off.val();
        for i in 0..H {
            if self.boundary.val() & (self.channel.q.val() == i.to_bits()) {
                self.held[i].d.next = self.result.val();
                self.held_above[i].d.next = self.above.val();
                self.held_below[i].d.next = self.below.val();
            }
            if self.boundary.val() & (self.channel.q.val() == i.to_bits()) & self.beyond.val() {
                self.held[i].d.next = self.no_result.val();
            }
        }
        if self.boundary.val() {
            self.clamped.d.next = (self.clamped.q.val() | self.beyond.val()) & !self.before_first.val();
            self.channel.d.next = self.channel.q.val() + self.one_channel.val();
        }

        comment!("All outputs in one clock");
        if self.clear_flags.val() {
            self.saturated_q.d.next = false;
        }
        self.valid_q.d.next = self.shows.val();
        if self.shows.val() {
            for i in 0..H {
                self.y_q[i].d.next = signed_cast(self.held[i].q.val());
                if self.held_above[i].q.val() {
                    self.y_q[i].d.next = signed_cast(self.held[i].q.val() | self.y_max.val());
                }
                if self.held_below[i].q.val() {
                    self.y_q[i].d.next = signed_cast(self.held[i].q.val() | self.y_min.val());
                }
            }
            for i in H..C {
                self.y_q[i].d.next = signed_cast(self.result.val());
                if self.above.val() {
                    self.y_q[i].d.next = signed_cast(self.y_max.val());
                }
            }
            self.busy_q.d.next = false;
            if self.clamped.q.val() | self.beyond.val() {
                self.saturated_q.d.next = true;
            }
        }
        if self.start.val() {
            for i in 0..C {
                self.y_q[i].d.next = self.x[i].val();
            }
        }
        for i in H..C {
            if self.shows.val() & self.below.val() {
                self.y_q[i].d.next = signed_cast(self.y_min.val());
            }
        }

        comment!("A start or a new pass abandons a running one");
        if self.cut_off.val() {
            self.channel.d.next = self.no_channel.val();
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
