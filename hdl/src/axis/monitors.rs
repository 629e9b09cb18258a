//! What is watched at ticks: limits, soft limits, errors against their limits, and what has lasted too long.
//!
//! At the tick everything is taken as it is, a clock later it is compared, and the result is registered: no comparison is
//! on the way to the state.

use crate::prelude::*;
use posicast_model::rtl::axis::Cause;

#[derive(LogicBlock)]
pub(super) struct Monitors {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) on: Signal<In, Bit>,
    pub(super) kicked: Signal<In, Bit>,
    pub(super) on_limit_plus: Signal<In, Bit>,
    pub(super) on_limit_minus: Signal<In, Bit>,
    pub(super) soft_limit_plus: Signal<In, Signed<32>>,
    pub(super) soft_limit_minus: Signal<In, Signed<32>>,
    pub(super) following_error_limit: Signal<In, Bits<32>>,
    pub(super) deviation_limit: Signal<In, Bits<32>>,
    pub(super) saturation_ticks: Signal<In, Bits<16>>,
    pub(super) lost_command: Signal<In, Bits<32>>,
    pub(super) lost_ticks: Signal<In, Bits<16>>,
    pub(super) watchdog_ticks: Signal<In, Bits<16>>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) deviation: Signal<In, Signed<32>>,
    pub(super) command_velocity: Signal<In, Signed<32>>,
    pub(super) reference_position: Signal<In, Signed<32>>,
    pub(super) reference_velocity: Signal<In, Signed<32>>,
    pub(super) error: Signal<In, Signed<32>>,
    pub(super) command: Signal<In, Signed<32>>,
    pub(super) limited_ticks: Signal<In, Bits<16>>,
    pub(super) causes: Signal<Out, Bits<16>>,
    pub(super) captured_position: Signal<Out, Signed<32>>,

    captured: Dff<Signed<32>>,
    was_on_plus: Dff<Bit>,
    was_on_minus: Dff<Bit>,
    was_past_plus: Dff<Bit>,
    was_past_minus: Dff<Bit>,
    still_ticks: Dff<Bits<16>>,
    unkicked_ticks: Dff<Bits<16>>,

    looks: Dff<Bit>,
    was_on: Dff<Bit>,
    on_plus: Dff<Bit>,
    on_minus: Dff<Bit>,
    forward: Dff<Bit>,
    backward: Dff<Bit>,
    shaped_forward: Dff<Bit>,
    shaped_backward: Dff<Bit>,
    past_plus: Dff<Bit>,
    past_minus: Dff<Bit>,
    same_position: Dff<Bit>,
    saturated: Dff<Bit>,
    error_size: Dff<Bits<32>>,
    deviation_size: Dff<Bits<32>>,
    command_size: Dff<Bits<32>>,
    counts: Dff<Bit>,
    counts_on: Dff<Bit>,
    stands: Dff<Bit>,
    found: Dff<Bits<16>>,

    command_velocity_bits: Signal<Local, Bits<32>>,
    reference_velocity_bits: Signal<Local, Bits<32>>,
    has_soft_limits: Signal<Local, Bit>,
    error_bits: Signal<Local, Bits<32>>,
    deviation_bits: Signal<Local, Bits<32>>,
    command_bits: Signal<Local, Bits<32>>,
    limit_plus: Signal<Local, Bit>,
    limit_minus: Signal<Local, Bit>,
    soft_plus: Signal<Local, Bit>,
    soft_minus: Signal<Local, Bit>,
    error_trip: Signal<Local, Bit>,
    deviation_trip: Signal<Local, Bit>,
    lost_trip: Signal<Local, Bit>,
    watchdog_trip: Signal<Local, Bit>,
    by_limit_plus: Signal<Local, Bits<16>>,
    by_limit_minus: Signal<Local, Bits<16>>,
    by_soft_plus: Signal<Local, Bits<16>>,
    by_soft_minus: Signal<Local, Bits<16>>,
    by_error_trip: Signal<Local, Bits<16>>,
    by_deviation_trip: Signal<Local, Bits<16>>,
    by_saturation_trip: Signal<Local, Bits<16>>,
    by_lost_trip: Signal<Local, Bits<16>>,
    by_watchdog_trip: Signal<Local, Bits<16>>,

    nil: Constant<Signed<32>>,
    no_ticks: Constant<Bits<16>>,
    one_tick: Constant<Bits<16>>,
    no_causes: Constant<Bits<16>>,
    of_limit_plus: Constant<Bits<16>>,
    of_limit_minus: Constant<Bits<16>>,
    of_soft_plus: Constant<Bits<16>>,
    of_soft_minus: Constant<Bits<16>>,
    of_error_trip: Constant<Bits<16>>,
    of_deviation_trip: Constant<Bits<16>>,
    of_saturation_trip: Constant<Bits<16>>,
    of_lost_trip: Constant<Bits<16>>,
    of_watchdog_trip: Constant<Bits<16>>,
}

impl Default for Monitors {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            on: Signal::default(),
            kicked: Signal::default(),
            on_limit_plus: Signal::default(),
            on_limit_minus: Signal::default(),
            soft_limit_plus: Signal::default(),
            soft_limit_minus: Signal::default(),
            following_error_limit: Signal::default(),
            deviation_limit: Signal::default(),
            saturation_ticks: Signal::default(),
            lost_command: Signal::default(),
            lost_ticks: Signal::default(),
            watchdog_ticks: Signal::default(),
            position: Signal::default(),
            deviation: Signal::default(),
            command_velocity: Signal::default(),
            reference_position: Signal::default(),
            reference_velocity: Signal::default(),
            error: Signal::default(),
            command: Signal::default(),
            limited_ticks: Signal::default(),
            causes: Signal::default(),
            captured_position: Signal::default(),
            captured: Dff::default(),
            was_on_plus: Dff::default(),
            was_on_minus: Dff::default(),
            was_past_plus: Dff::default(),
            was_past_minus: Dff::default(),
            still_ticks: Dff::default(),
            unkicked_ticks: Dff::default(),
            looks: Dff::default(),
            was_on: Dff::default(),
            on_plus: Dff::default(),
            on_minus: Dff::default(),
            forward: Dff::default(),
            backward: Dff::default(),
            shaped_forward: Dff::default(),
            shaped_backward: Dff::default(),
            past_plus: Dff::default(),
            past_minus: Dff::default(),
            same_position: Dff::default(),
            saturated: Dff::default(),
            error_size: Dff::default(),
            deviation_size: Dff::default(),
            command_size: Dff::default(),
            counts: Dff::default(),
            counts_on: Dff::default(),
            stands: Dff::default(),
            found: Dff::default(),
            command_velocity_bits: Signal::default(),
            reference_velocity_bits: Signal::default(),
            has_soft_limits: Signal::default(),
            error_bits: Signal::default(),
            deviation_bits: Signal::default(),
            command_bits: Signal::default(),
            limit_plus: Signal::default(),
            limit_minus: Signal::default(),
            soft_plus: Signal::default(),
            soft_minus: Signal::default(),
            error_trip: Signal::default(),
            deviation_trip: Signal::default(),
            lost_trip: Signal::default(),
            watchdog_trip: Signal::default(),
            by_limit_plus: Signal::default(),
            by_limit_minus: Signal::default(),
            by_soft_plus: Signal::default(),
            by_soft_minus: Signal::default(),
            by_error_trip: Signal::default(),
            by_deviation_trip: Signal::default(),
            by_saturation_trip: Signal::default(),
            by_lost_trip: Signal::default(),
            by_watchdog_trip: Signal::default(),
            nil: Constant::new(from_i64(0)),
            no_ticks: Constant::new(from_u64(0)),
            one_tick: Constant::new(from_u64(1)),
            no_causes: Constant::new(from_u64(0)),
            of_limit_plus: Constant::new(from_u64(u64::from(Cause::LimitPlus.bit()))),
            of_limit_minus: Constant::new(from_u64(u64::from(Cause::LimitMinus.bit()))),
            of_soft_plus: Constant::new(from_u64(u64::from(Cause::SoftLimitPlus.bit()))),
            of_soft_minus: Constant::new(from_u64(u64::from(Cause::SoftLimitMinus.bit()))),
            of_error_trip: Constant::new(from_u64(u64::from(Cause::FollowingError.bit()))),
            of_deviation_trip: Constant::new(from_u64(u64::from(Cause::Deviation.bit()))),
            of_saturation_trip: Constant::new(from_u64(u64::from(Cause::Saturation.bit()))),
            of_lost_trip: Constant::new(from_u64(u64::from(Cause::EncoderLost.bit()))),
            of_watchdog_trip: Constant::new(from_u64(u64::from(Cause::Watchdog.bit()))),
        }
    }
}

impl Logic for Monitors {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_monitors");
        comment!("@about Limits, errors and times, at ticks.");
        dff_setup!(
            self,
            clk,
            captured,
            was_on_plus,
            was_on_minus,
            was_past_plus,
            was_past_minus,
            still_ticks,
            unkicked_ticks,
            looks,
            was_on,
            on_plus,
            on_minus,
            forward,
            backward,
            shaped_forward,
            shaped_backward,
            past_plus,
            past_minus,
            same_position,
            saturated,
            error_size,
            deviation_size,
            command_size,
            counts,
            counts_on,
            stands,
            found
        );

        comment!("Clock 1: what the tick shows");
        self.looks.d.next = self.tick.val();
        self.command_velocity_bits.next = unsigned_cast(self.command_velocity.val());
        self.reference_velocity_bits.next = unsigned_cast(self.reference_velocity.val());
        self.error_bits.next = unsigned_cast(self.error.val());
        self.deviation_bits.next = unsigned_cast(self.deviation.val());
        self.command_bits.next = unsigned_cast(self.command.val());
        self.has_soft_limits.next =
            (self.soft_limit_plus.val() != self.nil.val()) | (self.soft_limit_minus.val() != self.nil.val());
        if self.tick.val() {
            self.captured.d.next = self.position.val();
            self.same_position.d.next = self.position.val() == self.captured.q.val();
            self.was_on.d.next = self.on.val();
            self.on_plus.d.next = self.on_limit_plus.val();
            self.on_minus.d.next = self.on_limit_minus.val();
            self.forward.d.next =
                self.command_velocity_bits.val().any() & !self.command_velocity_bits.val().get_bit(31);
            self.backward.d.next = self.command_velocity_bits.val().get_bit(31);
            self.shaped_forward.d.next =
                self.reference_velocity_bits.val().any() & !self.reference_velocity_bits.val().get_bit(31);
            self.shaped_backward.d.next = self.reference_velocity_bits.val().get_bit(31);
            self.past_plus.d.next =
                self.has_soft_limits.val() & (self.reference_position.val() > self.soft_limit_plus.val());
            self.past_minus.d.next =
                self.has_soft_limits.val() & (self.reference_position.val() < self.soft_limit_minus.val());
            self.saturated.d.next =
                self.saturation_ticks.val().any() & (self.limited_ticks.val() >= self.saturation_ticks.val());
            comment!("Sizes, of a negative -x - 1: no carry");
            self.error_size.d.next = self.error_bits.val();
            if self.error_bits.val().get_bit(31) {
                self.error_size.d.next = !self.error_bits.val();
            }
            self.deviation_size.d.next = self.deviation_bits.val();
            if self.deviation_bits.val().get_bit(31) {
                self.deviation_size.d.next = !self.deviation_bits.val();
            }
            self.command_size.d.next = self.command_bits.val();
            if self.command_bits.val().get_bit(31) {
                self.command_size.d.next = !self.command_bits.val();
            }
        }

        comment!("Clock 2: compared");
        comment!("A switch bounces when left: newly needs a way");
        self.limit_plus.next =
            self.on_plus.q.val() & (self.forward.q.val() | (!self.was_on_plus.q.val() & self.shaped_forward.q.val()));
        self.limit_minus.next = self.on_minus.q.val()
            & (self.backward.q.val() | (!self.was_on_minus.q.val() & self.shaped_backward.q.val()));
        self.soft_plus.next = self.past_plus.q.val() & (self.forward.q.val() | !self.was_past_plus.q.val());
        self.soft_minus.next = self.past_minus.q.val() & (self.backward.q.val() | !self.was_past_minus.q.val());
        self.error_trip.next =
            self.following_error_limit.val().any() & (self.error_size.q.val() > self.following_error_limit.val());
        self.deviation_trip.next =
            self.deviation_limit.val().any() & (self.deviation_size.q.val() > self.deviation_limit.val());
        self.lost_trip.next = self.lost_ticks.val().any() & (self.still_ticks.q.val() >= self.lost_ticks.val());
        self.watchdog_trip.next =
            self.watchdog_ticks.val().any() & (self.unkicked_ticks.q.val() >= self.watchdog_ticks.val());
        if self.looks.q.val() {
            self.was_on_plus.d.next = self.on_plus.q.val();
            self.was_on_minus.d.next = self.on_minus.q.val();
            self.was_past_plus.d.next = self.past_plus.q.val();
            self.was_past_minus.d.next = self.past_minus.q.val();
        }

        comment!("Clock 3: ticks in a row");
        self.counts.d.next = self.looks.q.val();
        self.counts_on.d.next = self.was_on.q.val();
        self.stands.d.next =
            self.was_on.q.val() & self.same_position.q.val() & (self.command_size.q.val() > self.lost_command.val());
        if self.counts.q.val() {
            if !self.still_ticks.q.val().all() {
                self.still_ticks.d.next = self.still_ticks.q.val() + self.one_tick.val();
            }
            if !self.unkicked_ticks.q.val().all() {
                self.unkicked_ticks.d.next = self.unkicked_ticks.q.val() + self.one_tick.val();
            }
            if !self.stands.q.val() {
                self.still_ticks.d.next = self.no_ticks.val();
            }
            if !self.counts_on.q.val() {
                self.unkicked_ticks.d.next = self.no_ticks.val();
            }
        }
        if self.kicked.val() {
            self.unkicked_ticks.d.next = self.no_ticks.val();
        }

        comment!("The causes of this tick");
        self.by_limit_plus.next = self.no_causes.val();
        if self.limit_plus.val() {
            self.by_limit_plus.next = self.of_limit_plus.val();
        }
        self.by_limit_minus.next = self.no_causes.val();
        if self.limit_minus.val() {
            self.by_limit_minus.next = self.of_limit_minus.val();
        }
        self.by_soft_plus.next = self.no_causes.val();
        if self.soft_plus.val() {
            self.by_soft_plus.next = self.of_soft_plus.val();
        }
        self.by_soft_minus.next = self.no_causes.val();
        if self.soft_minus.val() {
            self.by_soft_minus.next = self.of_soft_minus.val();
        }
        self.by_error_trip.next = self.no_causes.val();
        if self.error_trip.val() {
            self.by_error_trip.next = self.of_error_trip.val();
        }
        self.by_deviation_trip.next = self.no_causes.val();
        if self.deviation_trip.val() {
            self.by_deviation_trip.next = self.of_deviation_trip.val();
        }
        self.by_saturation_trip.next = self.no_causes.val();
        if self.saturated.q.val() {
            self.by_saturation_trip.next = self.of_saturation_trip.val();
        }
        self.by_lost_trip.next = self.no_causes.val();
        if self.lost_trip.val() {
            self.by_lost_trip.next = self.of_lost_trip.val();
        }
        self.by_watchdog_trip.next = self.no_causes.val();
        if self.watchdog_trip.val() {
            self.by_watchdog_trip.next = self.of_watchdog_trip.val();
        }
        self.found.d.next = self.no_causes.val();
        if self.looks.q.val() & self.was_on.q.val() {
            self.found.d.next = self.by_limit_plus.val()
                | self.by_limit_minus.val()
                | self.by_soft_plus.val()
                | self.by_soft_minus.val()
                | self.by_error_trip.val()
                | self.by_deviation_trip.val()
                | self.by_saturation_trip.val()
                | self.by_lost_trip.val()
                | self.by_watchdog_trip.val();
        }
        self.causes.next = self.found.q.val();
        self.captured_position.next = self.captured.q.val();
    }
}
