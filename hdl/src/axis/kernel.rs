//! Joins lines, causes and states, and connects them to the pins.
//!
//! An edge at a line reaches the state after `filter_clocks` + 4 clocks: 2 for the synchroniser, `filter_clocks` + 1
//! for the filter, 1 for the state.

use super::causes::Causes;
use super::line::Line;
use super::monitors::Monitors;
use super::states::States;
use crate::prelude::*;
use posicast_blocks::axis::{CLEAR_CLOCKS, DOUBTFUL, KICK};

kernel! {
    pub(super) struct Axis;
    ports posicast_blocks::axis_ports;

    parts {
        emergency_stop_line: Line,
        limit_plus_line: Line,
        limit_minus_line: Line,
        drive_line: Line,
        home_line: Line,
        monitors: Monitors,
        cause_word: Causes,
        states: States,
    }
    registers {
        primed: Bits<4>, clear_left: Bits<4>, clear_due: Bit, clear_sources_q: Bit, tripping: Bit,
        out_of_range: Bit, homed_q: Bit,
    }
    wires {
        ready: Bit, filters: Bit, own_emergency: Bit, emergency: Bit, group_stops: Bit, encoder: Bit,
        scale: Bit, segments_failed: Bit, count_bits: Bits<32>, count_above: Bits<9>, count_end: Bits<6>,
        far: Bit, doubts: Bits<17>, is_homed: Bit,
    }
    constants {
        first_clock: Bits<4> = from_u64(1),
        no_clocks: Bits<4> = from_u64(0),
        one_clock: Bits<4> = from_u64(1),
        two_clocks: Bits<4> = from_u64(2),
        clear_clocks: Bits<4> = from_u64(u64::from(CLEAR_CLOCKS)),
        doubtful_causes: Bits<17> = from_u64(u64::from(DOUBTFUL)),
        kick_value: Bits<32> = from_u64(u64::from(KICK)),
    }
    connect {
        emergency_stop_line, limit_plus_line, limit_minus_line, drive_line, home_line: filter_clocks;
        monitors: tick, soft_limit_plus, soft_limit_minus, following_error_limit, deviation_limit, saturation_ticks,
            lost_command, lost_ticks, watches_direction, watchdog_ticks, position, deviation, command_velocity,
            reference_position, reference_velocity, error, command, limited_ticks;
        monitors from states: on;
        cause_word from states: forget;
        cause_word: emergency, segments_failed, off_causes;
        states: group_stop, tick, enable, start, stop, segments_state, segments_empty, segments_valid,
            brake_release_ticks, brake_apply_ticks, settle_ticks;
        states from cause_word: any_cause, fault, cut, had_fault;
        outputs from states: enabled, started, stopping, halted, disabled, faulted, refused;
    }
}

impl Logic for Axis {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis");

        comment!("After reset, and without a filter, levels");
        comment!("are taken as they are");
        self.primed.d.next = (self.primed.q.val() << 1) | self.first_clock.val();
        self.ready.next = self.primed.q.val().get_bit(3);
        self.filters.next = self.ready.val() & self.filter_clocks.val().any();
        self.emergency_stop_line.pin.next = self.emergency_stop_n.val();
        self.emergency_stop_line.ready.next = self.filters.val();
        self.level_emergency_stop_n.next = self.emergency_stop_line.level.val();
        self.limit_plus_line.pin.next = self.limit_plus_n.val();
        self.limit_plus_line.ready.next = self.filters.val();
        self.level_limit_plus_n.next = self.limit_plus_line.level.val();
        self.limit_minus_line.pin.next = self.limit_minus_n.val();
        self.limit_minus_line.ready.next = self.filters.val();
        self.level_limit_minus_n.next = self.limit_minus_line.level.val();
        self.drive_line.pin.next = self.drive_ready.val();
        self.drive_line.ready.next = self.filters.val();
        self.level_drive_ready.next = self.drive_line.level.val();
        self.home_line.pin.next = self.home.val();
        self.home_line.ready.next = self.filters.val();
        self.level_home.next = self.home_line.level.val();

        comment!("Checks at ticks");
        self.monitors.kicked.next = self.kick.val() & (self.kick_word.val() == self.kick_value.val());
        self.monitors.on_limit_plus.next = !self.limit_plus_line.level.val();
        self.monitors.on_limit_minus.next = !self.limit_minus_line.level.val();
        self.monitors.limits_wait.next = self.limits_after_homing.val() & !self.homed_q.q.val();

        comment!("Range of the position word: its last 64th");
        comment!("at either end, and values clamped to their word");
        self.count_bits.next = unsigned_cast(self.monitors.captured_position.val());
        self.count_above.next = self.count_bits.val().get_bits::<9>(23);
        self.count_end.next = self.count_bits.val().get_bits::<6>(17);
        self.far.next = self.count_above.val().any() | self.count_end.val().all();
        if self.count_bits.val().get_bit(31) {
            self.far.next = !self.count_above.val().all() | !self.count_end.val().any();
        }
        self.out_of_range.d.next = (self.far.val() & !self.modulo.val())
            | self.shaper_saturated.val()
            | self.saturated_high.val().get_bit(0)
            | self.saturated_low.val().get_bit(0);

        comment!("Causes");
        self.own_emergency.next = self.ready.val() & !self.emergency_stop_line.level.val();
        self.emergency.next = self.own_emergency.val() | self.group_emergency_stop.val();
        self.tripping.d.next = self.emergency.val();
        self.encoder.next = self.encoder_illegal.val() | self.encoder_disagreement.val();
        self.scale.next = self.scale_illegal.val() | self.scale_disagreement.val();
        self.cause_word.tripped.next = self.pwm_tripped.val();
        self.cause_word.drive_lost.next = self.states.on.val() & !self.drive_line.level.val();
        self.cause_word.encoder_error.next = self.encoder.val() | self.scale.val();
        self.segments_failed.next =
            self.segments_underrun.val() | self.segments_overflow.val() | self.segments_out_of_range.val();
        self.cause_word.out_of_range.next = self.out_of_range.q.val() & (self.states.on.val() | self.enable.val());
        self.group_stops.next = self.states.on.val() & self.group_stop.val();
        self.cause_word.group_stops.next = self.group_stops.val() & !self.states.wants_group_stop.val();
        self.cause_word.group_stop.next = self.group_stops.val();
        self.cause_word.late.next = self.segments_tick_missed.val()
            | self.velocity_missed.val()
            | self.shaper_overrun.val()
            | self.controller_overrun.val();
        self.cause_word.watched.next = self.monitors.causes.val();

        comment!("Homed until the position is in doubt");
        self.doubts.next = self.cause_word.causes.val() & self.doubtful_causes.val();
        self.is_homed.next = self.homed_q.q.val();
        if self.write_homed.val() {
            self.is_homed.next = self.homed_value.val();
        }
        self.homed_q.d.next = self.is_homed.val() & !self.doubts.val().any();

        comment!("Sources are cleared first, causes later");
        self.clear_sources_q.d.next = self.clear_faults.val();
        if self.clear_left.q.val() != self.no_clocks.val() {
            self.clear_left.d.next = self.clear_left.q.val() - self.one_clock.val();
        }
        self.clear_due.d.next = (self.clear_left.q.val() == self.two_clocks.val()) & !self.clear_faults.val();
        if self.clear_faults.val() {
            self.clear_left.d.next = self.clear_clocks.val();
        }

        comment!("States");
        self.states.drive_ready.next = self.ready.val() & self.drive_line.level.val();
        self.states.clear_due.next = self.clear_due.q.val();

        comment!("Outputs");
        self.state.next = self.states.state.val();
        self.causes.next = self.cause_word.causes.val();
        self.drive_enable.next = self.states.on.val();
        self.brake_release.next = self.states.released.val();
        self.pwm_enable.next = self.states.on.val();
        self.pwm_trip_n.next = !self.tripping.q.val();
        self.segments_enable.next = self.states.running.val();
        self.segments_preset.next = !self.states.on.val();
        self.segments_quick_stop.next = self.states.quick_stop.val();
        self.segments_restart.next = self.states.restart.val();
        self.shaper_start.next = self.states.starting.val();
        self.clear_integral.next = self.states.starting.val();
        self.clear_sources.next = self.clear_sources_q.q.val();
        self.wants_group_stop.next = self.states.wants_group_stop.val();
        self.emergency_stop.next = self.own_emergency.val();
        self.captured_position.next = self.monitors.captured_position.val();
        self.can_start.next = self.states.can_start.val();
        self.homed.next = self.homed_q.q.val();
    }
}
