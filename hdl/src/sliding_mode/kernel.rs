//! The controller: selects the operand of each step, and the word that takes its sum.
//!
//! | step | operand | times | sum so far | taken by |
//! |---|---|---|---|---|
//! | 0, 1 | dr, velocity | 1, −1 | 0, as it is | held: de |
//! | 2 | held: de | 1 | 0 | |
//! | 3 | e | | as it is | s |
//! | 4 | the word: s | | 0 | the word: fraction, of the boundary layer |
//! | 5 | the word: fraction; PID: integral; PD: nothing | | 0 | |
//! | 6 | s; PD, PID: e | | as it is | |
//! | 7 | held: de | | as it is | held: feedback |
//! | 8 | dr | | 0 | the word: fraction, of the Coulomb term |
//! | 9 | the word: fraction | | 0 | |
//! | 10, 11, 12 | held: feedback, ddr, dr | | as it is | |
//! | 13 | velocity | | as it is | held: sum |
//! | 14 | integral (the setting is the limit) | 1 | 0 | command, from held |
//! | 15 | e | 1 | as it is | integral |
//! | 16 | held: command | | 0 | duty |

use super::accumulator::Accumulator;
use super::integral::Integral;
use super::limiter::Limiter;
use super::operands::Operands;
use super::scaled_product::ScaledProduct;
use super::sequencer::Sequencer;
use super::sticky::Sticky;
use super::tracking::Tracking;
use crate::prelude::*;
use posicast_blocks::sliding_mode::Saturation;

kernel! {
    pub(super) struct SlidingMode;
    ports posicast_blocks::sliding_mode_ports;

    parts {
        sequencer: Sequencer,
        tracking: Tracking,
        operands: Operands,
        scaled_product: ScaledProduct,
        accumulator: Accumulator,
        limiter: Limiter,
        integral: Integral,
        cut_high: Sticky,
        cut_low: Sticky,
    }
    registers { sliding_q: Signed<32>, duty_q: Signed<18>, opposes: Bit }
    wires {
        reads: Bit, settles: Bit, takes_fraction: Bit, at_limit: Bit, to_integral: Bit, to_duty: Bit,
        error_bits: Bits<24>, as_it_is: Bit, begins_sum: Bit, keeps: Bit, what: Bits<7>, high: Bit, low: Bit,
    }
    constants {
        of_reference: Bits<5> = from_u64(0),
        of_velocity: Bits<5> = from_u64(1),
        rate_again: Bits<5> = from_u64(2),
        surface: Bits<5> = from_u64(3),
        boundary: Bits<5> = from_u64(4),
        on_rest: Bits<5> = from_u64(5),
        on_rate: Bits<5> = from_u64(7),
        fade: Bits<5> = from_u64(8),
        coulomb: Bits<5> = from_u64(9),
        on_feedback: Bits<5> = from_u64(10),
        on_velocity: Bits<5> = from_u64(13),
        limit: Bits<5> = from_u64(14),
        to_sum: Bits<5> = from_u64(15),
        duty_step: Bits<5> = from_u64(16),
        no_flags: Bits<7> = from_u64(0),
        of_rate: Bits<7> = flag(Saturation::ErrorRate),
        of_sliding: Bits<7> = flag(Saturation::Sliding),
        of_feedback: Bits<7> = flag(Saturation::Feedback),
        of_integral: Bits<7> = flag(Saturation::Integral),
        of_command: Bits<7> = flag(Saturation::Command),
        of_duty: Bits<7> = flag(Saturation::Duty),
    }
    connect {
        sequencer: start, law, clear_flags;
        tracking: modulo, position_reference, position;
        operands from sequencer: step, linear, integrates;
        operands from tracking: tracking_error;
        operands from limiter: held;
        operands: velocity_reference, acceleration_reference, velocity;
        operands, integral from accumulator: word;
        scaled_product from operands: operand;
        accumulator from scaled_product: scaled;
        limiter from accumulator: word, cut, negative;
        integral: clear_integral;
        integral from limiter: limited_high, limited_low;
        cut_high, cut_low: clear_flags, what;
        outputs from sequencer: overrun, ends;
    }
}

/// Flag bit of a value that can saturate.
fn flag(what: Saturation) -> Bits<7> {
    from_u64(u64::from(what.bit()))
}

impl Logic for SlidingMode {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sliding_mode");

        self.reads.next = self.sequencer.reads.val();
        self.settles.next = self.sequencer.settles.val();
        self.takes_fraction.next =
            (self.sequencer.step.val() == self.boundary.val()) | (self.sequencer.step.val() == self.fade.val());
        self.at_limit.next = self.sequencer.step.val() == self.limit.val();
        self.to_integral.next = self.sequencer.step.val() == self.to_sum.val();
        self.to_duty.next = self.sequencer.step.val() == self.duty_step.val();

        self.tracking.capture.next = self.sequencer.begins.val();
        self.error_bits.next = unsigned_cast(self.tracking.tracking_error.val());

        comment!("Operand of a step, and its factor");
        self.operands.sliding.next = self.sliding_q.q.val();
        self.operands.integral.next = self.integral.value.val();
        self.as_it_is.next =
            (self.sequencer.step.val() < self.surface.val()) | self.at_limit.val() | self.to_integral.val();
        self.scaled_product.read.next = self.reads.val();
        self.scaled_product.load.next = self.sequencer.loads.val();
        self.scaled_product.shift.next = self.sequencer.shifts.val();
        self.scaled_product.unit.next = self.as_it_is.val();
        self.scaled_product.minus.next = self.sequencer.step.val() == self.of_velocity.val();
        self.scaled_product.gain.next = self.setting.val().get_bits::<23>(0);

        self.begins_sum.next = (self.sequencer.step.val() == self.of_reference.val())
            | (self.sequencer.step.val() == self.rate_again.val())
            | (self.sequencer.step.val() == self.boundary.val())
            | (self.sequencer.step.val() == self.on_rest.val())
            | (self.sequencer.step.val() == self.fade.val())
            | (self.sequencer.step.val() == self.coulomb.val())
            | (self.sequencer.step.val() == self.limit.val())
            | (self.sequencer.step.val() == self.duty_step.val());
        self.accumulator.empty.next = self.sequencer.empties.val() & self.begins_sum.val();
        self.accumulator.add.next = self.sequencer.adds.val();
        self.accumulator.check.next = self.sequencer.checks.val() & !self.at_limit.val();
        self.accumulator.as_fraction.next = self.takes_fraction.val();
        self.accumulator.as_duty.next = self.to_duty.val();

        self.keeps.next = (self.sequencer.step.val() == self.of_velocity.val())
            | (self.sequencer.step.val() == self.on_rate.val())
            | (self.sequencer.step.val() == self.on_velocity.val());
        self.limiter.keep.next = self.settles.val() & self.keeps.val();
        self.limiter.take.next = self.reads.val() & self.at_limit.val();
        self.limiter.count.next = self.settles.val() & self.to_integral.val();
        self.limiter.limit.next = self.setting.val().get_bits::<31>(0);

        comment!("The integral's sign is opposite to the feedback's");
        if self.reads.val() & (self.sequencer.step.val() == self.on_rest.val()) {
            self.opposes.d.next = self.setting.val().get_bit(17);
        }
        if self.reads.val() & (self.sequencer.step.val() == self.on_feedback.val()) {
            self.opposes.d.next = self.opposes.q.val() ^ self.setting.val().get_bit(17);
        }
        self.integral.open.next = self.sequencer.marks.val() & (self.sequencer.step.val() == self.on_velocity.val());
        self.integral.enable.next = self.sequencer.integrates.val() & self.to_integral.val();
        self.integral.settle.next = self.settles.val();
        self.integral.falls.next = self.error_bits.val().get_bit(23);
        self.integral.opposes.next = self.opposes.q.val();

        comment!("Destination of a word, and its saturation flag");
        if self.settles.val() & (self.sequencer.step.val() == self.surface.val()) {
            self.sliding_q.d.next = self.accumulator.word.val();
        }
        if self.settles.val() & self.to_duty.val() {
            self.duty_q.d.next = self.accumulator.word.val().get_bits::<18>(0);
        }
        self.what.next = self.no_flags.val();
        if self.sequencer.marks.val() {
            if self.sequencer.step.val() == self.of_velocity.val() {
                self.what.next = self.of_rate.val();
            }
            if self.sequencer.step.val() == self.surface.val() {
                self.what.next = self.of_sliding.val();
            }
            if self.sequencer.step.val() == self.on_rate.val() {
                self.what.next = self.of_feedback.val();
            }
            if self.at_limit.val() {
                self.what.next = self.of_command.val();
            }
            if self.integral.takes.val() {
                self.what.next = self.of_integral.val();
            }
            if self.to_duty.val() {
                self.what.next = self.of_duty.val();
            }
        }
        self.high.next = self.accumulator.cut.val() & !self.accumulator.negative.val();
        self.low.next = self.accumulator.cut.val() & self.accumulator.negative.val();
        if self.at_limit.val() {
            self.high.next = self.limiter.limited_high.val();
            self.low.next = self.limiter.limited_low.val();
        }
        self.cut_high.tracking_error.next = self.tracking.high.val();
        self.cut_high.is_cut.next = self.high.val();
        self.cut_low.tracking_error.next = self.tracking.low.val();
        self.cut_low.is_cut.next = self.low.val();

        comment!("Outputs");
        self.setting_address.next = self.sequencer.setting_address.val();
        self.error.next = signed_cast(bit_cast::<32, 24>(self.error_bits.val()) << 8);
        self.sliding.next = self.sliding_q.q.val();
        self.command.next = self.limiter.command.val();
        self.duty.next = self.duty_q.q.val();
        self.valid.next = self.sequencer.valid.val();
        self.busy.next = self.sequencer.busy.val();
        self.limited_high.next = self.limiter.limited_high.val();
        self.limited_low.next = self.limiter.limited_low.val();
        self.limited_ticks.next = self.limiter.limited_ticks.val();
        self.saturated_high.next = self.cut_high.flags.val();
        self.saturated_low.next = self.cut_low.flags.val();
    }
}
