//! The controller: which operand a step multiplies, and what becomes of its sum.
//!
//! | step | operand | sum so far | taken by |
//! |---|---|---|---|
//! | 0 | e | de | s |
//! | 1 | s | 0 | fraction, of the boundary layer |
//! | 2 | de | 0 | |
//! | 3 | s; PD, PID: e | as it is | |
//! | 4 | fraction; PID: integral; PD: nothing | as it is | feedback |
//! | 5 | dr | 0 | fraction, of the Coulomb term |
//! | 6 | feedback | 0 | |
//! | 7, 8, 9, 10 | ddr, dr, velocity, fraction | as it is | |
//! | 11 | (the setting is the limit) | | command, integral |
//! | 12 | command | 0 | duty |

use super::accumulator::Accumulator;
use super::integral::Integral;
use super::limiter::Limiter;
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

    sequencer: Sequencer,
    tracking: Tracking,
    scaled_product: ScaledProduct,
    accumulator: Accumulator,
    limiter: Limiter,
    integral: Integral,
    cut_high: Sticky,
    cut_low: Sticky,

    sliding_q: Dff<Signed<32>>,
    fraction: Dff<Signed<26>>,
    feedback: Dff<Signed<32>>,
    duty_q: Dff<Signed<18>>,
    opposes: Dff<Bit>,
    operand_q: Dff<Signed<32>>,

    reads: Signal<Local, Bit>,
    settles: Signal<Local, Bit>,
    takes_fraction: Signal<Local, Bit>,
    at_limit: Signal<Local, Bit>,
    operand: Signal<Local, Signed<32>>,
    error_word: Signal<Local, Signed<32>>,
    error_bits: Signal<Local, Bits<24>>,
    fraction_word: Signal<Local, Signed<32>>,
    what: Signal<Local, Bits<7>>,
    high: Signal<Local, Bit>,
    low: Signal<Local, Bit>,

    surface: Constant<Bits<4>>,
    boundary: Constant<Bits<4>>,
    on_rate: Constant<Bits<4>>,
    on_error: Constant<Bits<4>>,
    on_rest: Constant<Bits<4>>,
    fade: Constant<Bits<4>>,
    on_feedback: Constant<Bits<4>>,
    on_acceleration: Constant<Bits<4>>,
    on_reference: Constant<Bits<4>>,
    on_velocity: Constant<Bits<4>>,
    coulomb: Constant<Bits<4>>,
    limit: Constant<Bits<4>>,
    to_duty: Constant<Bits<4>>,
    nothing: Constant<Signed<32>>,
    no_flags: Constant<Bits<7>>,
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
            sequencer: Sequencer::default(),
            tracking: Tracking::default(),
            scaled_product: ScaledProduct::default(),
            accumulator: Accumulator::default(),
            limiter: Limiter::default(),
            integral: Integral::default(),
            cut_high: Sticky::default(),
            cut_low: Sticky::default(),
            sliding_q: Dff::default(),
            fraction: Dff::default(),
            feedback: Dff::default(),
            duty_q: Dff::default(),
            opposes: Dff::default(),
            operand_q: Dff::default(),
            reads: Signal::default(),
            settles: Signal::default(),
            takes_fraction: Signal::default(),
            at_limit: Signal::default(),
            operand: Signal::default(),
            error_word: Signal::default(),
            error_bits: Signal::default(),
            fraction_word: Signal::default(),
            what: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            surface: Constant::new(from_u64(0)),
            boundary: Constant::new(from_u64(1)),
            on_rate: Constant::new(from_u64(2)),
            on_error: Constant::new(from_u64(3)),
            on_rest: Constant::new(from_u64(4)),
            fade: Constant::new(from_u64(5)),
            on_feedback: Constant::new(from_u64(6)),
            on_acceleration: Constant::new(from_u64(7)),
            on_reference: Constant::new(from_u64(8)),
            on_velocity: Constant::new(from_u64(9)),
            coulomb: Constant::new(from_u64(10)),
            limit: Constant::new(from_u64(11)),
            to_duty: Constant::new(from_u64(12)),
            nothing: Constant::new(from_i64(0)),
            no_flags: Constant::new(from_u64(0)),
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
        dff_setup!(self, clk, sliding_q, fraction, feedback, duty_q, opposes, operand_q);

        self.sequencer.clk.next = self.clk.val();
        self.sequencer.rst.next = self.rst.val();
        self.sequencer.start.next = self.start.val();
        self.sequencer.law.next = self.law.val();
        self.sequencer.clear_flags.next = self.clear_flags.val();
        self.reads.next = self.sequencer.reads.val() & self.sequencer.busy.val();
        self.settles.next = self.sequencer.settles.val();
        self.takes_fraction.next =
            (self.sequencer.step.val() == self.boundary.val()) | (self.sequencer.step.val() == self.fade.val());
        self.at_limit.next = self.sequencer.step.val() == self.limit.val();

        self.tracking.clk.next = self.clk.val();
        self.tracking.rst.next = self.rst.val();
        self.tracking.capture.next = self.sequencer.begins.val();
        self.tracking.modulo.next = self.modulo.val();
        self.tracking.position_reference.next = self.position_reference.val();
        self.tracking.velocity_reference.next = self.velocity_reference.val();
        self.tracking.position.next = self.position.val();
        self.tracking.velocity.next = self.velocity.val();
        self.error_bits.next = unsigned_cast(self.tracking.tracking_error.val());
        self.error_word.next = signed_cast(bit_cast::<32, 24>(self.error_bits.val()) << 8);
        self.fraction_word.next = signed_bit_cast::<32, 26>(self.fraction.q.val());

        comment!("What a step multiplies, a clock before its gain");
        self.operand.next = self.limiter.command.val();
        if self.sequencer.step.val() == self.surface.val() {
            self.operand.next = self.error_word.val();
        }
        if self.sequencer.step.val() == self.boundary.val() {
            self.operand.next = self.sliding_q.q.val();
        }
        if self.sequencer.step.val() == self.on_rate.val() {
            self.operand.next = self.tracking.error_rate.val();
        }
        if self.sequencer.step.val() == self.on_error.val() {
            self.operand.next = self.sliding_q.q.val();
            if self.sequencer.linear.val() {
                self.operand.next = self.error_word.val();
            }
        }
        if self.sequencer.step.val() == self.on_rest.val() {
            self.operand.next = self.fraction_word.val();
            if self.sequencer.linear.val() {
                self.operand.next = self.nothing.val();
            }
            if self.sequencer.integrates.val() {
                self.operand.next = self.integral.value.val();
            }
        }
        if (self.sequencer.step.val() == self.fade.val()) | (self.sequencer.step.val() == self.on_reference.val()) {
            self.operand.next = self.velocity_reference.val();
        }
        if self.sequencer.step.val() == self.on_feedback.val() {
            self.operand.next = self.feedback.q.val();
        }
        if self.sequencer.step.val() == self.on_acceleration.val() {
            self.operand.next = self.acceleration_reference.val();
        }
        if self.sequencer.step.val() == self.on_velocity.val() {
            self.operand.next = self.velocity.val();
        }
        if self.sequencer.step.val() == self.coulomb.val() {
            self.operand.next = self.fraction_word.val();
        }

        self.operand_q.d.next = self.operand.val();

        self.scaled_product.clk.next = self.clk.val();
        self.scaled_product.rst.next = self.rst.val();
        self.scaled_product.read.next = self.reads.val();
        self.scaled_product.load.next = self.sequencer.loads.val();
        self.scaled_product.shift.next = self.sequencer.shifts.val();
        self.scaled_product.operand.next = self.operand_q.q.val();
        self.scaled_product.gain.next = self.setting.val().get_bits::<23>(0);

        self.accumulator.clk.next = self.clk.val();
        self.accumulator.rst.next = self.rst.val();
        self.accumulator.add.next = self.sequencer.adds.val();
        self.accumulator.begin_rate.next = self.sequencer.step.val() == self.surface.val();
        self.accumulator.begin_sum.next = (self.sequencer.step.val() == self.boundary.val())
            | (self.sequencer.step.val() == self.on_rate.val())
            | (self.sequencer.step.val() == self.fade.val())
            | (self.sequencer.step.val() == self.on_feedback.val())
            | (self.sequencer.step.val() == self.to_duty.val());
        self.accumulator.as_fraction.next = self.takes_fraction.val();
        self.accumulator.as_duty.next = self.sequencer.step.val() == self.to_duty.val();
        self.accumulator.error_rate.next = self.tracking.error_rate.val();
        self.accumulator.scaled.next = self.scaled_product.scaled.val();

        self.limiter.clk.next = self.clk.val();
        self.limiter.rst.next = self.rst.val();
        self.limiter.take.next = self.reads.val() & self.at_limit.val();
        self.limiter.count.next = self.settles.val() & self.at_limit.val();
        self.limiter.limit.next = self.setting.val().get_bits::<31>(0);
        self.limiter.word.next = self.accumulator.word.val();
        self.limiter.word_high.next = self.accumulator.high.val();
        self.limiter.word_low.next = self.accumulator.low.val();

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
        self.integral.update.next = self.sequencer.integrates.val() & self.settles.val() & self.at_limit.val();
        self.integral.tracking_error.next = self.tracking.tracking_error.val();
        self.integral.opposes.next = self.opposes.q.val();
        self.integral.limited_high.next = self.limiter.limited_high.val();
        self.integral.limited_low.next = self.limiter.limited_low.val();

        comment!("What becomes of a sum, and the flag of its cut");
        self.what.next = self.no_flags.val();
        self.high.next = self.accumulator.high.val();
        self.low.next = self.accumulator.low.val();
        if self.settles.val() {
            if self.sequencer.step.val() == self.surface.val() {
                self.sliding_q.d.next = self.accumulator.word.val();
                self.what.next = self.of_sliding.val();
            }
            if self.takes_fraction.val() {
                self.fraction.d.next = self.accumulator.word.val().get_bits::<26>(0);
            }
            if self.sequencer.step.val() == self.on_rest.val() {
                self.feedback.d.next = self.accumulator.word.val();
                self.what.next = self.of_feedback.val();
            }
            if self.at_limit.val() {
                self.what.next = self.of_integral.val();
                self.high.next = self.integral.high.val();
                self.low.next = self.integral.low.val();
            }
            if self.sequencer.step.val() == self.to_duty.val() {
                self.duty_q.d.next = self.accumulator.word.val().get_bits::<18>(0);
                self.what.next = self.of_duty.val();
            }
        }
        if self.limiter.decides.val() {
            self.what.next = self.of_command.val();
            self.high.next = self.limiter.high.val();
            self.low.next = self.limiter.low.val();
        }

        self.cut_high.clk.next = self.clk.val();
        self.cut_high.rst.next = self.rst.val();
        self.cut_high.clear_flags.next = self.clear_flags.val();
        self.cut_high.tracking_error.next = self.tracking.error_high.val();
        self.cut_high.error_rate.next = self.tracking.rate_high.val();
        self.cut_high.what.next = self.what.val();
        self.cut_high.is_cut.next = self.high.val();
        self.cut_low.clk.next = self.clk.val();
        self.cut_low.rst.next = self.rst.val();
        self.cut_low.clear_flags.next = self.clear_flags.val();
        self.cut_low.tracking_error.next = self.tracking.error_low.val();
        self.cut_low.error_rate.next = self.tracking.rate_low.val();
        self.cut_low.what.next = self.what.val();
        self.cut_low.is_cut.next = self.low.val();

        comment!("Outputs");
        self.setting_address.next = self.sequencer.setting_address.val();
        self.error.next = self.error_word.val();
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
    }
}
