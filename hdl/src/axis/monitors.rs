//! What is watched at ticks: limits, soft limits, errors against their limits, and what has lasted too long.
//!
//! Numbers go by bytes, from the tick on, and are compared twice: a limit that a host writes meanwhile is no cause. What both
//! rounds find is registered: no comparison is on the way to the state. Bytes are taken in clocks 0 to 3 and 5 to 8 after the
//! tick, compared a clock later, looked at in clocks 5 and 10, and causes in clock 11.

use super::at_tick::AtTick;
use super::lasts::Lasts;
use super::nibbles::Nibbles;
use super::size_limit::SizeLimit;
use super::soft_limits::SoftLimits;
use super::tick_count::TickCount;
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
    pub(super) velocity_drive: Signal<In, Bit>,
    pub(super) watchdog_ticks: Signal<In, Bits<16>>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) deviation: Signal<In, Signed<32>>,
    pub(super) command_velocity: Signal<In, Signed<32>>,
    pub(super) reference_position: Signal<In, Signed<32>>,
    pub(super) reference_velocity: Signal<In, Signed<32>>,
    pub(super) error: Signal<In, Signed<32>>,
    pub(super) command: Signal<In, Signed<32>>,
    pub(super) limited_ticks: Signal<In, Bits<16>>,
    pub(super) causes: Signal<Out, Bits<17>>,
    pub(super) captured_position: Signal<Out, Signed<32>>,

    captured: Dff<Signed<32>>,
    was_on_plus: Dff<Bit>,
    was_on_minus: Dff<Bit>,
    was_past_plus: Dff<Bit>,
    was_past_minus: Dff<Bit>,

    soft_limits: SoftLimits,
    error_limit: SizeLimit,
    deviation_at_tick: AtTick,
    deviations: SizeLimit,
    commands: SizeLimit,
    limited_nibbles: Nibbles,
    saturating: Lasts,
    still: TickCount,
    unkicked: TickCount,

    turn: Dff<Bits<2>>,
    compares: Dff<Bit>,
    looks: Dff<Bit>,
    again: Dff<Bit>,
    tells: Dff<Bit>,
    kick_waits: Dff<Bit>,

    was_on: Dff<Bit>,
    on_plus: Dff<Bit>,
    on_minus: Dff<Bit>,
    forward: Dff<Bit>,
    backward: Dff<Bit>,
    shaped_forward: Dff<Bit>,
    shaped_backward: Dff<Bit>,
    drive_backward: Dff<Bit>,
    still_since: Dff<Signed<32>>,
    still_backward: Dff<Bit>,
    motion: Dff<Signed<32>>,
    not_forward: Dff<Bit>,
    not_backward: Dff<Bit>,
    found: Dff<Bits<17>>,

    command_velocity_bits: Signal<Local, Bits<32>>,
    command_bits: Signal<Local, Bits<32>>,
    motion_bits: Signal<Local, Bits<32>>,
    motion_above: Signal<Local, Bits<30>>,
    not_its_way: Signal<Local, Bit>,
    reference_velocity_bits: Signal<Local, Bits<32>>,
    takes: Signal<Local, Bit>,
    last_byte: Signal<Local, Bit>,
    over: Signal<Local, Bit>,
    stands: Signal<Local, Bit>,
    is_kicked: Signal<Local, Bit>,
    limit_plus: Signal<Local, Bit>,
    limit_minus: Signal<Local, Bit>,
    soft_plus: Signal<Local, Bit>,
    soft_minus: Signal<Local, Bit>,
    by_limit_plus: Signal<Local, Bits<17>>,
    by_limit_minus: Signal<Local, Bits<17>>,
    by_soft_plus: Signal<Local, Bits<17>>,
    by_soft_minus: Signal<Local, Bits<17>>,
    by_error_trip: Signal<Local, Bits<17>>,
    by_deviation_trip: Signal<Local, Bits<17>>,
    by_saturation_trip: Signal<Local, Bits<17>>,
    by_lost_trip: Signal<Local, Bits<17>>,
    by_watchdog_trip: Signal<Local, Bits<17>>,
    shown: Signal<Local, Bits<17>>,

    one_turn: Constant<Bits<2>>,
    no_causes: Constant<Bits<17>>,
    of_limit_plus: Constant<Bits<17>>,
    of_limit_minus: Constant<Bits<17>>,
    of_soft_plus: Constant<Bits<17>>,
    of_soft_minus: Constant<Bits<17>>,
    of_error_trip: Constant<Bits<17>>,
    of_deviation_trip: Constant<Bits<17>>,
    of_saturation_trip: Constant<Bits<17>>,
    of_lost_trip: Constant<Bits<17>>,
    of_watchdog_trip: Constant<Bits<17>>,
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
            velocity_drive: Signal::default(),
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
            soft_limits: SoftLimits::default(),
            error_limit: SizeLimit::default(),
            deviation_at_tick: AtTick::default(),
            deviations: SizeLimit::default(),
            commands: SizeLimit::default(),
            limited_nibbles: Nibbles::default(),
            saturating: Lasts::default(),
            still: TickCount::default(),
            unkicked: TickCount::default(),
            turn: Dff::default(),
            compares: Dff::default(),
            looks: Dff::default(),
            again: Dff::default(),
            tells: Dff::default(),
            kick_waits: Dff::default(),
            was_on: Dff::default(),
            on_plus: Dff::default(),
            on_minus: Dff::default(),
            forward: Dff::default(),
            backward: Dff::default(),
            shaped_forward: Dff::default(),
            shaped_backward: Dff::default(),
            drive_backward: Dff::default(),
            still_since: Dff::default(),
            still_backward: Dff::default(),
            motion: Dff::default(),
            not_forward: Dff::default(),
            not_backward: Dff::default(),
            found: Dff::default(),
            command_velocity_bits: Signal::default(),
            command_bits: Signal::default(),
            motion_bits: Signal::default(),
            motion_above: Signal::default(),
            not_its_way: Signal::default(),
            reference_velocity_bits: Signal::default(),
            takes: Signal::default(),
            last_byte: Signal::default(),
            over: Signal::default(),
            stands: Signal::default(),
            is_kicked: Signal::default(),
            limit_plus: Signal::default(),
            limit_minus: Signal::default(),
            soft_plus: Signal::default(),
            soft_minus: Signal::default(),
            by_limit_plus: Signal::default(),
            by_limit_minus: Signal::default(),
            by_soft_plus: Signal::default(),
            by_soft_minus: Signal::default(),
            by_error_trip: Signal::default(),
            by_deviation_trip: Signal::default(),
            by_saturation_trip: Signal::default(),
            by_lost_trip: Signal::default(),
            by_watchdog_trip: Signal::default(),
            shown: Signal::default(),
            one_turn: Constant::new(from_u64(1)),
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
            turn,
            compares,
            looks,
            again,
            tells,
            kick_waits,
            was_on,
            on_plus,
            on_minus,
            forward,
            backward,
            shaped_forward,
            shaped_backward,
            drive_backward,
            still_since,
            still_backward,
            motion,
            not_forward,
            not_backward,
            found
        );

        comment!("Two rounds of four bytes, a clock between them");
        self.takes.next = self.tick.val() | (self.looks.q.val() & !self.again.q.val()) | self.turn.q.val().any();
        if self.takes.val() {
            self.turn.d.next = self.turn.q.val() + self.one_turn.val();
        }
        self.compares.d.next = self.takes.val();
        self.last_byte.next = self.compares.q.val() & !self.takes.val();
        self.looks.d.next = self.last_byte.val();
        self.over.next = self.looks.q.val() & self.again.q.val();
        if self.looks.q.val() {
            self.again.d.next = !self.again.q.val();
        }
        self.tells.d.next = self.over.val() & self.was_on.q.val();

        comment!("What the tick shows");
        self.command_bits.next = unsigned_cast(self.command.val());
        self.command_velocity_bits.next = unsigned_cast(self.command_velocity.val());
        self.reference_velocity_bits.next = unsigned_cast(self.reference_velocity.val());
        if self.tick.val() {
            self.captured.d.next = self.position.val();
            self.drive_backward.d.next = self.command_bits.val().get_bit(31);
            self.was_on.d.next = self.on.val();
            self.on_plus.d.next = self.on_limit_plus.val();
            self.on_minus.d.next = self.on_limit_minus.val();
            self.forward.d.next =
                self.command_velocity_bits.val().any() & !self.command_velocity_bits.val().get_bit(31);
            self.backward.d.next = self.command_velocity_bits.val().get_bit(31);
            self.shaped_forward.d.next =
                self.reference_velocity_bits.val().any() & !self.reference_velocity_bits.val().get_bit(31);
            self.shaped_backward.d.next = self.reference_velocity_bits.val().get_bit(31);
        }

        comment!("A switch bounces when left: newly needs a way");
        self.limit_plus.next =
            self.on_plus.q.val() & (self.forward.q.val() | (!self.was_on_plus.q.val() & self.shaped_forward.q.val()));
        self.limit_minus.next = self.on_minus.q.val()
            & (self.backward.q.val() | (!self.was_on_minus.q.val() & self.shaped_backward.q.val()));
        self.soft_limits.clk.next = self.clk.val();
        self.soft_limits.rst.next = self.rst.val();
        self.soft_limits.turn.next = self.turn.q.val();
        self.soft_limits.compares.next = self.compares.q.val();
        self.soft_limits.signs.next = self.last_byte.val();
        self.soft_limits.reference_position.next = self.reference_position.val();
        self.soft_limits.soft_limit_plus.next = self.soft_limit_plus.val();
        self.soft_limits.soft_limit_minus.next = self.soft_limit_minus.val();
        self.soft_plus.next = self.soft_limits.past_plus.val() & (self.forward.q.val() | !self.was_past_plus.q.val());
        self.soft_minus.next =
            self.soft_limits.past_minus.val() & (self.backward.q.val() | !self.was_past_minus.q.val());
        if self.over.val() {
            self.was_on_plus.d.next = self.on_plus.q.val();
            self.was_on_minus.d.next = self.on_minus.q.val();
            self.was_past_plus.d.next = self.soft_limits.past_plus.val();
            self.was_past_minus.d.next = self.soft_limits.past_minus.val();
        }

        comment!("Sizes and times");
        self.error_limit.clk.next = self.clk.val();
        self.error_limit.rst.next = self.rst.val();
        self.error_limit.tick.next = self.tick.val();
        self.error_limit.turn.next = self.turn.q.val();
        self.error_limit.compares.next = self.compares.q.val();
        self.error_limit.number.next = self.error.val();
        self.error_limit.limit.next = self.following_error_limit.val();
        self.error_limit.zero_counts.next = false;
        comment!("A scale computes the next one from the tick on");
        self.deviation_at_tick.clk.next = self.clk.val();
        self.deviation_at_tick.rst.next = self.rst.val();
        self.deviation_at_tick.tick.next = self.tick.val();
        self.deviation_at_tick.word.next = self.deviation.val();
        self.deviations.clk.next = self.clk.val();
        self.deviations.rst.next = self.rst.val();
        self.deviations.tick.next = self.tick.val();
        self.deviations.turn.next = self.turn.q.val();
        self.deviations.compares.next = self.compares.q.val();
        self.deviations.number.next = self.deviation_at_tick.stands.val();
        self.deviations.limit.next = self.deviation_limit.val();
        self.deviations.zero_counts.next = false;
        self.commands.clk.next = self.clk.val();
        self.commands.rst.next = self.rst.val();
        self.commands.tick.next = self.tick.val();
        self.commands.turn.next = self.turn.q.val();
        self.commands.compares.next = self.compares.q.val();
        self.commands.number.next = self.command.val();
        self.commands.limit.next = self.lost_command.val();
        self.commands.zero_counts.next = true;
        self.saturating.clk.next = self.clk.val();
        self.saturating.rst.next = self.rst.val();
        self.saturating.turn.next = self.turn.q.val();
        self.saturating.compares.next = self.compares.q.val();
        self.limited_nibbles.clk.next = self.clk.val();
        self.limited_nibbles.rst.next = self.rst.val();
        self.limited_nibbles.turn.next = self.turn.q.val();
        self.limited_nibbles.word.next = self.limited_ticks.val();
        self.saturating.ticks.next = self.limited_nibbles.part.val();
        self.saturating.endless.next = false;
        self.saturating.limit.next = self.saturation_ticks.val();
        comment!("Moved since it last stood still, a clock each");
        self.motion.d.next = self.captured.q.val() - self.still_since.q.val();
        self.motion_bits.next = unsigned_cast(self.motion.q.val());
        self.motion_above.next = self.motion_bits.val().get_bits::<30>(2);
        self.not_forward.d.next = self.motion_bits.val().get_bit(31) | !self.motion_above.val().any();
        self.not_backward.d.next = !self.motion_bits.val().get_bit(31) | self.motion_above.val().all();
        comment!("Against a velocity's command is as not at all");
        self.not_its_way.next = self.not_forward.q.val();
        if self.drive_backward.q.val() {
            self.not_its_way.next = self.not_backward.q.val();
        }
        self.stands.next = self.was_on.q.val()
            & self.not_its_way.val()
            & (self.velocity_drive.val() | (self.not_forward.q.val() & self.not_backward.q.val()))
            & (self.drive_backward.q.val() == self.still_backward.q.val())
            & self.commands.exceeds.val();
        if self.over.val() & !self.stands.val() {
            self.still_since.d.next = self.captured.q.val();
            self.still_backward.d.next = self.drive_backward.q.val();
        }
        self.still.clk.next = self.clk.val();
        self.still.rst.next = self.rst.val();
        self.still.tick.next = self.tick.val();
        self.still.turn.next = self.turn.q.val();
        self.still.compares.next = self.compares.q.val();
        self.still.limit.next = self.lost_ticks.val();
        self.still.clears.next = self.over.val() & !self.stands.val();
        comment!("A kick waits until the count has gone round");
        self.is_kicked.next = self.kicked.val() | self.kick_waits.q.val();
        self.kick_waits.d.next = self.is_kicked.val() & self.compares.q.val();
        self.unkicked.clk.next = self.clk.val();
        self.unkicked.rst.next = self.rst.val();
        self.unkicked.tick.next = self.tick.val();
        self.unkicked.turn.next = self.turn.q.val();
        self.unkicked.compares.next = self.compares.q.val();
        self.unkicked.limit.next = self.watchdog_ticks.val();
        self.unkicked.clears.next = !self.compares.q.val() & (self.is_kicked.val() | !self.was_on.q.val());

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
        if self.error_limit.exceeds.val() {
            self.by_error_trip.next = self.of_error_trip.val();
        }
        self.by_deviation_trip.next = self.no_causes.val();
        if self.deviations.exceeds.val() {
            self.by_deviation_trip.next = self.of_deviation_trip.val();
        }
        self.by_saturation_trip.next = self.no_causes.val();
        if self.saturating.lasts.val() {
            self.by_saturation_trip.next = self.of_saturation_trip.val();
        }
        self.by_lost_trip.next = self.no_causes.val();
        if self.still.lasts.val() {
            self.by_lost_trip.next = self.of_lost_trip.val();
        }
        self.by_watchdog_trip.next = self.no_causes.val();
        if self.unkicked.lasts.val() {
            self.by_watchdog_trip.next = self.of_watchdog_trip.val();
        }
        self.shown.next = self.by_limit_plus.val()
            | self.by_limit_minus.val()
            | self.by_soft_plus.val()
            | self.by_soft_minus.val()
            | self.by_error_trip.val()
            | self.by_deviation_trip.val()
            | self.by_saturation_trip.val()
            | self.by_lost_trip.val()
            | self.by_watchdog_trip.val();
        if self.looks.q.val() {
            self.found.d.next = self.shown.val();
            if self.again.q.val() {
                self.found.d.next = self.shown.val() & self.found.q.val();
            }
        }
        self.causes.next = self.no_causes.val();
        if self.tells.q.val() {
            self.causes.next = self.found.q.val();
        }
        self.captured_position.next = self.captured.q.val();
    }
}
