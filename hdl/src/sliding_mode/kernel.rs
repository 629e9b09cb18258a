//! The controller: what a step multiplies, and what becomes of its sum.
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
use posicast_model::rtl::sliding_mode::Saturation;

#[derive(LogicBlock)]
pub(super) struct SlidingMode {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) law: Signal<In, Bits<2>>,
    pub(super) modulo: Signal<In, Bit>,
    pub(super) position_reference: Signal<In, Signed<32>>,
    pub(super) velocity_reference: Signal<In, Signed<32>>,
    pub(super) acceleration_reference: Signal<In, Signed<32>>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) velocity: Signal<In, Signed<32>>,
    pub(super) setting: Signal<In, Bits<32>>,
    pub(super) clear_integral: Signal<In, Bit>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) setting_address: Signal<Out, Bits<4>>,
    pub(super) error: Signal<Out, Signed<32>>,
    pub(super) sliding: Signal<Out, Signed<32>>,
    pub(super) command: Signal<Out, Signed<32>>,
    pub(super) duty: Signal<Out, Signed<18>>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) limited_high: Signal<Out, Bit>,
    pub(super) limited_low: Signal<Out, Bit>,
    pub(super) limited_ticks: Signal<Out, Bits<16>>,
    pub(super) saturated_high: Signal<Out, Bits<7>>,
    pub(super) saturated_low: Signal<Out, Bits<7>>,
    pub(super) overrun: Signal<Out, Bit>,
    pub(super) ends: Signal<Out, Bit>,

    sequencer: Sequencer,
    tracking: Tracking,
    operands: Operands,
    scaled_product: ScaledProduct,
    accumulator: Accumulator,
    limiter: Limiter,
    integral: Integral,
    cut_high: Sticky,
    cut_low: Sticky,

    sliding_q: Dff<Signed<32>>,
    duty_q: Dff<Signed<18>>,
    opposes: Dff<Bit>,

    reads: Signal<Local, Bit>,
    settles: Signal<Local, Bit>,
    takes_fraction: Signal<Local, Bit>,
    at_limit: Signal<Local, Bit>,
    to_integral: Signal<Local, Bit>,
    to_duty: Signal<Local, Bit>,
    error_bits: Signal<Local, Bits<24>>,
    as_it_is: Signal<Local, Bit>,
    begins_sum: Signal<Local, Bit>,
    keeps: Signal<Local, Bit>,
    what: Signal<Local, Bits<7>>,
    high: Signal<Local, Bit>,
    low: Signal<Local, Bit>,

    of_reference: Constant<Bits<5>>,
    of_velocity: Constant<Bits<5>>,
    rate_again: Constant<Bits<5>>,
    surface: Constant<Bits<5>>,
    boundary: Constant<Bits<5>>,
    on_rest: Constant<Bits<5>>,
    on_rate: Constant<Bits<5>>,
    fade: Constant<Bits<5>>,
    coulomb: Constant<Bits<5>>,
    on_feedback: Constant<Bits<5>>,
    on_velocity: Constant<Bits<5>>,
    limit: Constant<Bits<5>>,
    to_sum: Constant<Bits<5>>,
    duty_step: Constant<Bits<5>>,
    no_flags: Constant<Bits<7>>,
    of_rate: Constant<Bits<7>>,
    of_sliding: Constant<Bits<7>>,
    of_feedback: Constant<Bits<7>>,
    of_integral: Constant<Bits<7>>,
    of_command: Constant<Bits<7>>,
    of_duty: Constant<Bits<7>>,
}

impl Default for SlidingMode {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            start: Signal::default(),
            law: Signal::default(),
            modulo: Signal::default(),
            position_reference: Signal::default(),
            velocity_reference: Signal::default(),
            acceleration_reference: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            setting: Signal::default(),
            clear_integral: Signal::default(),
            clear_flags: Signal::default(),
            setting_address: Signal::default(),
            error: Signal::default(),
            sliding: Signal::default(),
            command: Signal::default(),
            duty: Signal::default(),
            valid: Signal::default(),
            busy: Signal::default(),
            limited_high: Signal::default(),
            limited_low: Signal::default(),
            limited_ticks: Signal::default(),
            saturated_high: Signal::default(),
            saturated_low: Signal::default(),
            overrun: Signal::default(),
            ends: Signal::default(),
            sequencer: Sequencer::default(),
            tracking: Tracking::default(),
            operands: Operands::default(),
            scaled_product: ScaledProduct::default(),
            accumulator: Accumulator::default(),
            limiter: Limiter::default(),
            integral: Integral::default(),
            cut_high: Sticky::default(),
            cut_low: Sticky::default(),
            sliding_q: Dff::default(),
            duty_q: Dff::default(),
            opposes: Dff::default(),
            reads: Signal::default(),
            settles: Signal::default(),
            takes_fraction: Signal::default(),
            at_limit: Signal::default(),
            to_integral: Signal::default(),
            to_duty: Signal::default(),
            error_bits: Signal::default(),
            as_it_is: Signal::default(),
            begins_sum: Signal::default(),
            keeps: Signal::default(),
            what: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            of_reference: Constant::new(from_u64(0)),
            of_velocity: Constant::new(from_u64(1)),
            rate_again: Constant::new(from_u64(2)),
            surface: Constant::new(from_u64(3)),
            boundary: Constant::new(from_u64(4)),
            on_rest: Constant::new(from_u64(5)),
            on_rate: Constant::new(from_u64(7)),
            fade: Constant::new(from_u64(8)),
            coulomb: Constant::new(from_u64(9)),
            on_feedback: Constant::new(from_u64(10)),
            on_velocity: Constant::new(from_u64(13)),
            limit: Constant::new(from_u64(14)),
            to_sum: Constant::new(from_u64(15)),
            duty_step: Constant::new(from_u64(16)),
            no_flags: Constant::new(from_u64(0)),
            of_rate: Constant::new(flag(Saturation::ErrorRate)),
            of_sliding: Constant::new(flag(Saturation::Sliding)),
            of_feedback: Constant::new(flag(Saturation::Feedback)),
            of_integral: Constant::new(flag(Saturation::Integral)),
            of_command: Constant::new(flag(Saturation::Command)),
            of_duty: Constant::new(flag(Saturation::Duty)),
        }
    }
}

/// The bit of what can saturate.
fn flag(what: Saturation) -> Bits<7> {
    from_u64(u64::from(what.bit()))
}

impl Logic for SlidingMode {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sliding_mode");
        dff_setup!(self, clk, sliding_q, duty_q, opposes);

        self.sequencer.clk.next = self.clk.val();
        self.sequencer.rst.next = self.rst.val();
        self.sequencer.start.next = self.start.val();
        self.sequencer.law.next = self.law.val();
        self.sequencer.clear_flags.next = self.clear_flags.val();
        self.reads.next = self.sequencer.reads.val();
        self.settles.next = self.sequencer.settles.val();
        self.takes_fraction.next =
            (self.sequencer.step.val() == self.boundary.val()) | (self.sequencer.step.val() == self.fade.val());
        self.at_limit.next = self.sequencer.step.val() == self.limit.val();
        self.to_integral.next = self.sequencer.step.val() == self.to_sum.val();
        self.to_duty.next = self.sequencer.step.val() == self.duty_step.val();

        self.tracking.clk.next = self.clk.val();
        self.tracking.rst.next = self.rst.val();
        self.tracking.capture.next = self.sequencer.begins.val();
        self.tracking.modulo.next = self.modulo.val();
        self.tracking.position_reference.next = self.position_reference.val();
        self.tracking.position.next = self.position.val();
        self.error_bits.next = unsigned_cast(self.tracking.tracking_error.val());

        comment!("What a step multiplies, and by what");
        self.operands.clk.next = self.clk.val();
        self.operands.rst.next = self.rst.val();
        self.operands.step.next = self.sequencer.step.val();
        self.operands.linear.next = self.sequencer.linear.val();
        self.operands.integrates.next = self.sequencer.integrates.val();
        self.operands.tracking_error.next = self.tracking.tracking_error.val();
        self.operands.sliding.next = self.sliding_q.q.val();
        self.operands.held.next = self.limiter.held.val();
        self.operands.integral.next = self.integral.value.val();
        self.operands.velocity_reference.next = self.velocity_reference.val();
        self.operands.acceleration_reference.next = self.acceleration_reference.val();
        self.operands.velocity.next = self.velocity.val();
        self.operands.word.next = self.accumulator.word.val();
        self.as_it_is.next =
            (self.sequencer.step.val() < self.surface.val()) | self.at_limit.val() | self.to_integral.val();
        self.scaled_product.clk.next = self.clk.val();
        self.scaled_product.rst.next = self.rst.val();
        self.scaled_product.read.next = self.reads.val();
        self.scaled_product.load.next = self.sequencer.loads.val();
        self.scaled_product.shift.next = self.sequencer.shifts.val();
        self.scaled_product.unit.next = self.as_it_is.val();
        self.scaled_product.minus.next = self.sequencer.step.val() == self.of_velocity.val();
        self.scaled_product.operand.next = self.operands.operand.val();
        self.scaled_product.gain.next = self.setting.val().get_bits::<23>(0);

        self.begins_sum.next = (self.sequencer.step.val() == self.of_reference.val())
            | (self.sequencer.step.val() == self.rate_again.val())
            | (self.sequencer.step.val() == self.boundary.val())
            | (self.sequencer.step.val() == self.on_rest.val())
            | (self.sequencer.step.val() == self.fade.val())
            | (self.sequencer.step.val() == self.coulomb.val())
            | (self.sequencer.step.val() == self.limit.val())
            | (self.sequencer.step.val() == self.duty_step.val());
        self.accumulator.clk.next = self.clk.val();
        self.accumulator.rst.next = self.rst.val();
        self.accumulator.empty.next = self.sequencer.empties.val() & self.begins_sum.val();
        self.accumulator.add.next = self.sequencer.adds.val();
        self.accumulator.check.next = self.sequencer.checks.val() & !self.at_limit.val();
        self.accumulator.scaled.next = self.scaled_product.scaled.val();
        self.accumulator.as_fraction.next = self.takes_fraction.val();
        self.accumulator.as_duty.next = self.to_duty.val();

        self.keeps.next = (self.sequencer.step.val() == self.of_velocity.val())
            | (self.sequencer.step.val() == self.on_rate.val())
            | (self.sequencer.step.val() == self.on_velocity.val());
        self.limiter.clk.next = self.clk.val();
        self.limiter.rst.next = self.rst.val();
        self.limiter.keep.next = self.settles.val() & self.keeps.val();
        self.limiter.take.next = self.reads.val() & self.at_limit.val();
        self.limiter.count.next = self.settles.val() & self.to_integral.val();
        self.limiter.limit.next = self.setting.val().get_bits::<31>(0);
        self.limiter.word.next = self.accumulator.word.val();
        self.limiter.cut.next = self.accumulator.cut.val();
        self.limiter.negative.next = self.accumulator.negative.val();

        comment!("The integral works against the feedback's sign");
        if self.reads.val() & (self.sequencer.step.val() == self.on_rest.val()) {
            self.opposes.d.next = self.setting.val().get_bit(17);
        }
        if self.reads.val() & (self.sequencer.step.val() == self.on_feedback.val()) {
            self.opposes.d.next = self.opposes.q.val() ^ self.setting.val().get_bit(17);
        }
        self.integral.clk.next = self.clk.val();
        self.integral.rst.next = self.rst.val();
        self.integral.clear_integral.next = self.clear_integral.val();
        self.integral.open.next = self.sequencer.marks.val() & (self.sequencer.step.val() == self.on_velocity.val());
        self.integral.enable.next = self.sequencer.integrates.val() & self.to_integral.val();
        self.integral.settle.next = self.settles.val();
        self.integral.word.next = self.accumulator.word.val();
        self.integral.falls.next = self.error_bits.val().get_bit(23);
        self.integral.opposes.next = self.opposes.q.val();
        self.integral.limited_high.next = self.limiter.limited_high.val();
        self.integral.limited_low.next = self.limiter.limited_low.val();

        comment!("Who takes a word, and the flag of its cut");
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
        self.cut_high.clk.next = self.clk.val();
        self.cut_high.rst.next = self.rst.val();
        self.cut_high.clear_flags.next = self.clear_flags.val();
        self.cut_high.tracking_error.next = self.tracking.high.val();
        self.cut_high.what.next = self.what.val();
        self.cut_high.is_cut.next = self.high.val();
        self.cut_low.clk.next = self.clk.val();
        self.cut_low.rst.next = self.rst.val();
        self.cut_low.clear_flags.next = self.clear_flags.val();
        self.cut_low.tracking_error.next = self.tracking.low.val();
        self.cut_low.what.next = self.what.val();
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
        self.overrun.next = self.sequencer.overrun.val();
        self.ends.next = self.sequencer.ends.val();
    }
}
