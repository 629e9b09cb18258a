//! The checks at ticks: limits, soft limits, errors against their limits, and time limits.
//!
//! From the tick on, numbers are compared byte by byte, and twice: only what both rounds find is a cause, so a limit
//! that a host writes meanwhile causes nothing. The findings are registered, which keeps the comparisons off the path
//! to the state. Bytes are taken in clocks 0 to 3 and 5 to 8 after the tick and compared one clock later; the results
//! are evaluated in clocks 5 and 10, and causes come in clock 11.

use super::at_tick::AtTick;
use super::lasts::Lasts;
use super::nibbles::Nibbles;
use super::size_limit::SizeLimit;
use super::soft_limits::SoftLimits;
use super::tick_count::TickCount;
use crate::prelude::*;
use posicast_blocks::axis::Cause;

kernel! {
    pub(super) struct Monitors;

    inputs {
        rst: Bit,
        tick: Bit,
        on: Bit,
        kicked: Bit,
        on_limit_plus: Bit,
        on_limit_minus: Bit,
        soft_limit_plus: Signed<32>,
        soft_limit_minus: Signed<32>,
        limits_wait: Bit,
        following_error_limit: Bits<32>,
        deviation_limit: Bits<32>,
        saturation_ticks: Bits<16>,
        lost_command: Bits<32>,
        lost_ticks: Bits<16>,
        watches_direction: Bit,
        watchdog_ticks: Bits<16>,
        position: Signed<32>,
        deviation: Signed<32>,
        command_velocity: Signed<32>,
        reference_position: Signed<32>,
        reference_velocity: Signed<32>,
        error: Signed<32>,
        command: Signed<32>,
        limited_ticks: Bits<16>,
    }
    outputs { causes: Bits<17>, captured_position: Signed<32> }
    registers { captured: Signed<32>, was_on_plus: Bit, was_on_minus: Bit, was_past_plus: Bit, was_past_minus: Bit }
    parts {
        soft_limits: SoftLimits,
        error_limit: SizeLimit,
        deviation_at_tick: AtTick,
        deviations: SizeLimit,
        commands: SizeLimit,
        limited_nibbles: Nibbles,
        saturating: Lasts,
        still: TickCount,
        unkicked: TickCount,
    }
    registers {
        turn: Bits<2>, compares: Bit, looks: Bit, again: Bit, tells: Bit, kick_waits: Bit, was_on: Bit,
        on_plus: Bit, on_minus: Bit, forward: Bit, backward: Bit, shaped_forward: Bit, shaped_backward: Bit,
        drive_backward: Bit, still_since: Signed<32>, still_backward: Bit, motion: Signed<32>,
        not_forward: Bit, not_backward: Bit, found: Bits<17>,
    }
    wires {
        command_velocity_bits: Bits<32>, command_bits: Bits<32>, motion_bits: Bits<32>,
        motion_above: Bits<30>, moves: Bit, not_its_way: Bit, reference_velocity_bits: Bits<32>, takes: Bit,
        last_byte: Bit, over: Bit, stands: Bit, is_kicked: Bit, limit_plus: Bit, limit_minus: Bit,
        soft_plus: Bit, soft_minus: Bit, by_limit_plus: Bits<17>, by_limit_minus: Bits<17>,
        by_soft_plus: Bits<17>, by_soft_minus: Bits<17>, by_error_trip: Bits<17>, by_deviation_trip: Bits<17>,
        by_saturation_trip: Bits<17>, by_lost_trip: Bits<17>, by_watchdog_trip: Bits<17>, shown: Bits<17>,
    }
    constants {
        one_turn: Bits<2> = from_u64(1),
        no_causes: Bits<17> = from_u64(0),
        of_limit_plus: Bits<17> = from_u64(u64::from(Cause::LimitPlus.bit())),
        of_limit_minus: Bits<17> = from_u64(u64::from(Cause::LimitMinus.bit())),
        of_soft_plus: Bits<17> = from_u64(u64::from(Cause::SoftLimitPlus.bit())),
        of_soft_minus: Bits<17> = from_u64(u64::from(Cause::SoftLimitMinus.bit())),
        of_error_trip: Bits<17> = from_u64(u64::from(Cause::FollowingError.bit())),
        of_deviation_trip: Bits<17> = from_u64(u64::from(Cause::Deviation.bit())),
        of_saturation_trip: Bits<17> = from_u64(u64::from(Cause::Saturation.bit())),
        of_lost_trip: Bits<17> = from_u64(u64::from(Cause::EncoderLost.bit())),
        of_watchdog_trip: Bits<17> = from_u64(u64::from(Cause::Watchdog.bit())),
    }
    connect {
        soft_limits: reference_position, soft_limit_plus, soft_limit_minus;
        error_limit, deviation_at_tick, deviations, commands, still, unkicked: tick;
    }
}

impl Logic for Monitors {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_monitors");

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

        comment!("Levels at the tick");
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

        comment!("Only motion towards a switch counts, because the");
        comment!("switch bounces when the axis leaves it");
        self.limit_plus.next =
            self.on_plus.q.val() & (self.forward.q.val() | (!self.was_on_plus.q.val() & self.shaped_forward.q.val()));
        self.limit_minus.next = self.on_minus.q.val()
            & (self.backward.q.val() | (!self.was_on_minus.q.val() & self.shaped_backward.q.val()));
        self.soft_limits.turn.next = self.turn.q.val();
        self.soft_limits.compares.next = self.compares.q.val();
        self.soft_limits.signs.next = self.last_byte.val();
        self.soft_limits.waits.next = self.limits_wait.val();
        self.soft_plus.next = self.soft_limits.past_plus.val() & (self.forward.q.val() | !self.was_past_plus.q.val());
        self.soft_minus.next =
            self.soft_limits.past_minus.val() & (self.backward.q.val() | !self.was_past_minus.q.val());
        if self.over.val() {
            self.was_on_plus.d.next = self.on_plus.q.val();
            self.was_on_minus.d.next = self.on_minus.q.val();
            self.was_past_plus.d.next = self.soft_limits.past_plus.val();
            self.was_past_minus.d.next = self.soft_limits.past_minus.val();
        }

        comment!("Magnitudes and times");
        self.error_limit.turn.next = self.turn.q.val();
        self.error_limit.compares.next = self.compares.q.val();
        self.error_limit.number.next = self.error.val();
        self.error_limit.limit.next = self.following_error_limit.val();
        self.error_limit.zero_counts.next = false;
        comment!("Keep the deviation: from the tick on, the scale");
        comment!("computes the next one");
        self.deviation_at_tick.word.next = self.deviation.val();
        self.deviations.turn.next = self.turn.q.val();
        self.deviations.compares.next = self.compares.q.val();
        self.deviations.number.next = self.deviation_at_tick.stands.val();
        self.deviations.limit.next = self.deviation_limit.val();
        self.deviations.zero_counts.next = false;
        self.commands.turn.next = self.turn.q.val();
        self.commands.compares.next = self.compares.q.val();
        self.commands.number.next = self.command.val();
        self.commands.limit.next = self.lost_command.val();
        self.commands.zero_counts.next = true;
        self.saturating.turn.next = self.turn.q.val();
        self.saturating.compares.next = self.compares.q.val();
        self.limited_nibbles.turn.next = self.turn.q.val();
        self.limited_nibbles.word.next = self.limited_ticks.val();
        self.saturating.ticks.next = self.limited_nibbles.part.val();
        self.saturating.endless.next = false;
        self.saturating.limit.next = self.saturation_ticks.val();
        comment!("Has moved since it last stood still");
        self.motion.d.next = self.captured.q.val() - self.still_since.q.val();
        self.motion_bits.next = unsigned_cast(self.motion.q.val());
        self.motion_above.next = self.motion_bits.val().get_bits::<30>(2);
        self.not_forward.d.next = self.motion_bits.val().get_bit(31) | !self.motion_above.val().any();
        self.not_backward.d.next = !self.motion_bits.val().get_bit(31) | self.motion_above.val().all();
        comment!("Motion against the command does not count with");
        comment!("watches_direction");
        self.not_its_way.next = self.not_forward.q.val();
        if self.drive_backward.q.val() {
            self.not_its_way.next = self.not_backward.q.val();
        }
        self.moves.next = !self.not_forward.q.val() | !self.not_backward.q.val();
        self.stands.next = self.was_on.q.val()
            & self.not_its_way.val()
            & (self.watches_direction.val() | !self.moves.val())
            & (self.drive_backward.q.val() == self.still_backward.q.val())
            & self.commands.exceeds.val();
        comment!("After a reversal, motion counts from that point");
        if self.over.val() & (!self.stands.val() | self.moves.val()) {
            self.still_since.d.next = self.captured.q.val();
            self.still_backward.d.next = self.drive_backward.q.val();
        }
        self.still.turn.next = self.turn.q.val();
        self.still.compares.next = self.compares.q.val();
        self.still.limit.next = self.lost_ticks.val();
        self.still.clears.next = self.over.val() & !self.stands.val();
        comment!("A kick waits until the count has rotated");
        self.is_kicked.next = self.kicked.val() | self.kick_waits.q.val();
        self.kick_waits.d.next = self.is_kicked.val() & self.compares.q.val();
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
