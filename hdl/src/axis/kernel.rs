//! Lines, causes, states: what they say to each other, and to the pins.
//!
//! An edge at a line reaches the state after `filter_clocks` + 4 clocks: synchroniser 2, filter `filter_clocks` + 1, state 1.

use super::causes::Causes;
use super::line::Line;
use super::monitors::Monitors;
use super::states::States;
use crate::prelude::*;
use posicast_model::rtl::axis::{CLEAR_CLOCKS, KICK};

#[derive(LogicBlock)]
pub(super) struct Axis {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) emergency_stop_n: Signal<In, Bit>,
    pub(super) limit_plus_n: Signal<In, Bit>,
    pub(super) limit_minus_n: Signal<In, Bit>,
    pub(super) drive_ready: Signal<In, Bit>,
    pub(super) home: Signal<In, Bit>,
    pub(super) filter_clocks: Signal<In, Bits<6>>,
    pub(super) enable: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) stop: Signal<In, Bit>,
    pub(super) clear_faults: Signal<In, Bit>,
    pub(super) kick: Signal<In, Bit>,
    pub(super) kick_word: Signal<In, Bits<32>>,
    pub(super) group_stop: Signal<In, Bit>,
    pub(super) group_emergency_stop: Signal<In, Bit>,
    pub(super) off_causes: Signal<In, Bits<16>>,
    pub(super) brake_release_ticks: Signal<In, Bits<16>>,
    pub(super) brake_apply_ticks: Signal<In, Bits<16>>,
    pub(super) settle_ticks: Signal<In, Bits<16>>,
    pub(super) soft_limit_plus: Signal<In, Signed<32>>,
    pub(super) soft_limit_minus: Signal<In, Signed<32>>,
    pub(super) following_error_limit: Signal<In, Bits<32>>,
    pub(super) deviation_limit: Signal<In, Bits<32>>,
    pub(super) saturation_ticks: Signal<In, Bits<16>>,
    pub(super) lost_command: Signal<In, Bits<32>>,
    pub(super) lost_ticks: Signal<In, Bits<16>>,
    pub(super) velocity_drive: Signal<In, Bit>,
    pub(super) watchdog_ticks: Signal<In, Bits<16>>,
    pub(super) modulo: Signal<In, Bit>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) deviation: Signal<In, Signed<32>>,
    pub(super) segments_state: Signal<In, Bits<2>>,
    pub(super) segments_empty: Signal<In, Bit>,
    pub(super) segments_valid: Signal<In, Bit>,
    pub(super) segments_underrun: Signal<In, Bit>,
    pub(super) segments_overflow: Signal<In, Bit>,
    pub(super) segments_tick_missed: Signal<In, Bit>,
    pub(super) segments_out_of_range: Signal<In, Bit>,
    pub(super) command_velocity: Signal<In, Signed<32>>,
    pub(super) reference_position: Signal<In, Signed<32>>,
    pub(super) reference_velocity: Signal<In, Signed<32>>,
    pub(super) shaper_saturated: Signal<In, Bit>,
    pub(super) shaper_overrun: Signal<In, Bit>,
    pub(super) error: Signal<In, Signed<32>>,
    pub(super) command: Signal<In, Signed<32>>,
    pub(super) limited_ticks: Signal<In, Bits<16>>,
    pub(super) saturated_high: Signal<In, Bits<7>>,
    pub(super) saturated_low: Signal<In, Bits<7>>,
    pub(super) controller_overrun: Signal<In, Bit>,
    pub(super) pwm_tripped: Signal<In, Bit>,
    pub(super) encoder_illegal: Signal<In, Bit>,
    pub(super) encoder_disagreement: Signal<In, Bit>,
    pub(super) velocity_missed: Signal<In, Bit>,
    pub(super) scale_illegal: Signal<In, Bit>,
    pub(super) scale_disagreement: Signal<In, Bit>,
    pub(super) state: Signal<Out, Bits<3>>,
    pub(super) causes: Signal<Out, Bits<17>>,
    pub(super) drive_enable: Signal<Out, Bit>,
    pub(super) brake_release: Signal<Out, Bit>,
    pub(super) pwm_enable: Signal<Out, Bit>,
    pub(super) pwm_trip_n: Signal<Out, Bit>,
    pub(super) segments_enable: Signal<Out, Bit>,
    pub(super) segments_preset: Signal<Out, Bit>,
    pub(super) segments_quick_stop: Signal<Out, Bit>,
    pub(super) segments_restart: Signal<Out, Bit>,
    pub(super) shaper_start: Signal<Out, Bit>,
    pub(super) clear_integral: Signal<Out, Bit>,
    pub(super) clear_sources: Signal<Out, Bit>,
    pub(super) wants_group_stop: Signal<Out, Bit>,
    pub(super) emergency_stop: Signal<Out, Bit>,
    pub(super) can_start: Signal<Out, Bit>,
    pub(super) captured_position: Signal<Out, Signed<32>>,
    pub(super) level_emergency_stop_n: Signal<Out, Bit>,
    pub(super) level_limit_plus_n: Signal<Out, Bit>,
    pub(super) level_limit_minus_n: Signal<Out, Bit>,
    pub(super) level_drive_ready: Signal<Out, Bit>,
    pub(super) level_home: Signal<Out, Bit>,
    pub(super) enabled: Signal<Out, Bit>,
    pub(super) started: Signal<Out, Bit>,
    pub(super) stopping: Signal<Out, Bit>,
    pub(super) halted: Signal<Out, Bit>,
    pub(super) disabled: Signal<Out, Bit>,
    pub(super) faulted: Signal<Out, Bit>,
    pub(super) refused: Signal<Out, Bit>,

    emergency_stop_line: Line,
    limit_plus_line: Line,
    limit_minus_line: Line,
    drive_line: Line,
    home_line: Line,
    monitors: Monitors,
    cause_word: Causes,
    states: States,

    primed: Dff<Bits<4>>,
    clear_left: Dff<Bits<4>>,
    clear_due: Dff<Bit>,
    clear_sources_q: Dff<Bit>,
    tripping: Dff<Bit>,
    out_of_range: Dff<Bit>,

    ready: Signal<Local, Bit>,
    filters: Signal<Local, Bit>,
    own_emergency: Signal<Local, Bit>,
    emergency: Signal<Local, Bit>,
    group_stops: Signal<Local, Bit>,
    encoder: Signal<Local, Bit>,
    scale: Signal<Local, Bit>,
    segments_failed: Signal<Local, Bit>,
    count_bits: Signal<Local, Bits<32>>,
    count_above: Signal<Local, Bits<9>>,
    count_end: Signal<Local, Bits<6>>,
    far: Signal<Local, Bit>,

    first_clock: Constant<Bits<4>>,
    no_clocks: Constant<Bits<4>>,
    one_clock: Constant<Bits<4>>,
    two_clocks: Constant<Bits<4>>,
    clear_clocks: Constant<Bits<4>>,
    kick_value: Constant<Bits<32>>,
}

impl Default for Axis {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            emergency_stop_n: Signal::default(),
            limit_plus_n: Signal::default(),
            limit_minus_n: Signal::default(),
            drive_ready: Signal::default(),
            home: Signal::default(),
            filter_clocks: Signal::default(),
            enable: Signal::default(),
            start: Signal::default(),
            stop: Signal::default(),
            clear_faults: Signal::default(),
            kick: Signal::default(),
            kick_word: Signal::default(),
            group_stop: Signal::default(),
            group_emergency_stop: Signal::default(),
            off_causes: Signal::default(),
            brake_release_ticks: Signal::default(),
            brake_apply_ticks: Signal::default(),
            settle_ticks: Signal::default(),
            soft_limit_plus: Signal::default(),
            soft_limit_minus: Signal::default(),
            following_error_limit: Signal::default(),
            deviation_limit: Signal::default(),
            saturation_ticks: Signal::default(),
            lost_command: Signal::default(),
            lost_ticks: Signal::default(),
            velocity_drive: Signal::default(),
            watchdog_ticks: Signal::default(),
            modulo: Signal::default(),
            position: Signal::default(),
            deviation: Signal::default(),
            segments_state: Signal::default(),
            segments_empty: Signal::default(),
            segments_valid: Signal::default(),
            segments_underrun: Signal::default(),
            segments_overflow: Signal::default(),
            segments_tick_missed: Signal::default(),
            segments_out_of_range: Signal::default(),
            command_velocity: Signal::default(),
            reference_position: Signal::default(),
            reference_velocity: Signal::default(),
            shaper_saturated: Signal::default(),
            shaper_overrun: Signal::default(),
            error: Signal::default(),
            command: Signal::default(),
            limited_ticks: Signal::default(),
            saturated_high: Signal::default(),
            saturated_low: Signal::default(),
            controller_overrun: Signal::default(),
            pwm_tripped: Signal::default(),
            encoder_illegal: Signal::default(),
            encoder_disagreement: Signal::default(),
            velocity_missed: Signal::default(),
            scale_illegal: Signal::default(),
            scale_disagreement: Signal::default(),
            state: Signal::default(),
            causes: Signal::default(),
            drive_enable: Signal::default(),
            brake_release: Signal::default(),
            pwm_enable: Signal::default(),
            pwm_trip_n: Signal::default(),
            segments_enable: Signal::default(),
            segments_preset: Signal::default(),
            segments_quick_stop: Signal::default(),
            segments_restart: Signal::default(),
            shaper_start: Signal::default(),
            clear_integral: Signal::default(),
            clear_sources: Signal::default(),
            wants_group_stop: Signal::default(),
            emergency_stop: Signal::default(),
            can_start: Signal::default(),
            captured_position: Signal::default(),
            level_emergency_stop_n: Signal::default(),
            level_limit_plus_n: Signal::default(),
            level_limit_minus_n: Signal::default(),
            level_drive_ready: Signal::default(),
            level_home: Signal::default(),
            enabled: Signal::default(),
            started: Signal::default(),
            stopping: Signal::default(),
            halted: Signal::default(),
            disabled: Signal::default(),
            faulted: Signal::default(),
            refused: Signal::default(),
            emergency_stop_line: Line::default(),
            limit_plus_line: Line::default(),
            limit_minus_line: Line::default(),
            drive_line: Line::default(),
            home_line: Line::default(),
            monitors: Monitors::default(),
            cause_word: Causes::default(),
            states: States::default(),
            primed: Dff::default(),
            clear_left: Dff::default(),
            clear_due: Dff::default(),
            clear_sources_q: Dff::default(),
            tripping: Dff::default(),
            out_of_range: Dff::default(),
            ready: Signal::default(),
            filters: Signal::default(),
            own_emergency: Signal::default(),
            emergency: Signal::default(),
            group_stops: Signal::default(),
            encoder: Signal::default(),
            scale: Signal::default(),
            segments_failed: Signal::default(),
            count_bits: Signal::default(),
            count_above: Signal::default(),
            count_end: Signal::default(),
            far: Signal::default(),
            first_clock: Constant::new(from_u64(1)),
            no_clocks: Constant::new(from_u64(0)),
            one_clock: Constant::new(from_u64(1)),
            two_clocks: Constant::new(from_u64(2)),
            clear_clocks: Constant::new(from_u64(u64::from(CLEAR_CLOCKS))),
            kick_value: Constant::new(from_u64(u64::from(KICK))),
        }
    }
}

impl Logic for Axis {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis");
        dff_setup!(
            self,
            clk,
            primed,
            clear_left,
            clear_due,
            clear_sources_q,
            tripping,
            out_of_range
        );

        comment!("After reset, and with nothing to filter, levels");
        comment!("are taken as they are");
        self.primed.d.next = (self.primed.q.val() << 1) | self.first_clock.val();
        self.ready.next = self.primed.q.val().get_bit(3);
        self.filters.next = self.ready.val() & self.filter_clocks.val().any();
        self.emergency_stop_line.clk.next = self.clk.val();
        self.emergency_stop_line.rst.next = self.rst.val();
        self.emergency_stop_line.pin.next = self.emergency_stop_n.val();
        self.emergency_stop_line.ready.next = self.filters.val();
        self.emergency_stop_line.filter_clocks.next = self.filter_clocks.val();
        self.level_emergency_stop_n.next = self.emergency_stop_line.level.val();
        self.limit_plus_line.clk.next = self.clk.val();
        self.limit_plus_line.rst.next = self.rst.val();
        self.limit_plus_line.pin.next = self.limit_plus_n.val();
        self.limit_plus_line.ready.next = self.filters.val();
        self.limit_plus_line.filter_clocks.next = self.filter_clocks.val();
        self.level_limit_plus_n.next = self.limit_plus_line.level.val();
        self.limit_minus_line.clk.next = self.clk.val();
        self.limit_minus_line.rst.next = self.rst.val();
        self.limit_minus_line.pin.next = self.limit_minus_n.val();
        self.limit_minus_line.ready.next = self.filters.val();
        self.limit_minus_line.filter_clocks.next = self.filter_clocks.val();
        self.level_limit_minus_n.next = self.limit_minus_line.level.val();
        self.drive_line.clk.next = self.clk.val();
        self.drive_line.rst.next = self.rst.val();
        self.drive_line.pin.next = self.drive_ready.val();
        self.drive_line.ready.next = self.filters.val();
        self.drive_line.filter_clocks.next = self.filter_clocks.val();
        self.level_drive_ready.next = self.drive_line.level.val();
        self.home_line.clk.next = self.clk.val();
        self.home_line.rst.next = self.rst.val();
        self.home_line.pin.next = self.home.val();
        self.home_line.ready.next = self.filters.val();
        self.home_line.filter_clocks.next = self.filter_clocks.val();
        self.level_home.next = self.home_line.level.val();

        comment!("What is watched at ticks");
        self.monitors.clk.next = self.clk.val();
        self.monitors.rst.next = self.rst.val();
        self.monitors.tick.next = self.tick.val();
        self.monitors.on.next = self.states.on.val();
        self.monitors.kicked.next = self.kick.val() & (self.kick_word.val() == self.kick_value.val());
        self.monitors.on_limit_plus.next = !self.limit_plus_line.level.val();
        self.monitors.on_limit_minus.next = !self.limit_minus_line.level.val();
        self.monitors.soft_limit_plus.next = self.soft_limit_plus.val();
        self.monitors.soft_limit_minus.next = self.soft_limit_minus.val();
        self.monitors.following_error_limit.next = self.following_error_limit.val();
        self.monitors.deviation_limit.next = self.deviation_limit.val();
        self.monitors.saturation_ticks.next = self.saturation_ticks.val();
        self.monitors.lost_command.next = self.lost_command.val();
        self.monitors.lost_ticks.next = self.lost_ticks.val();
        self.monitors.velocity_drive.next = self.velocity_drive.val();
        self.monitors.watchdog_ticks.next = self.watchdog_ticks.val();
        self.monitors.position.next = self.position.val();
        self.monitors.deviation.next = self.deviation.val();
        self.monitors.command_velocity.next = self.command_velocity.val();
        self.monitors.reference_position.next = self.reference_position.val();
        self.monitors.reference_velocity.next = self.reference_velocity.val();
        self.monitors.error.next = self.error.val();
        self.monitors.command.next = self.command.val();
        self.monitors.limited_ticks.next = self.limited_ticks.val();

        comment!("The range of the position's word: its last 64th");
        comment!("at either end, and what was cut to its word");
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
        self.cause_word.clk.next = self.clk.val();
        self.cause_word.rst.next = self.rst.val();
        self.cause_word.forget.next = self.states.forget.val();
        self.cause_word.emergency.next = self.emergency.val();
        self.cause_word.tripped.next = self.pwm_tripped.val();
        self.cause_word.drive_lost.next = self.states.on.val() & !self.drive_line.level.val();
        self.cause_word.encoder_error.next = self.encoder.val() | self.scale.val();
        self.segments_failed.next =
            self.segments_underrun.val() | self.segments_overflow.val() | self.segments_out_of_range.val();
        self.cause_word.segments_failed.next = self.segments_failed.val();
        self.cause_word.out_of_range.next = self.out_of_range.q.val() & (self.states.on.val() | self.enable.val());
        self.group_stops.next = self.states.on.val() & self.group_stop.val();
        self.cause_word.group_stops.next = self.group_stops.val() & !self.states.wants_group_stop.val();
        self.cause_word.group_stop.next = self.group_stops.val();
        self.cause_word.late.next = self.segments_tick_missed.val()
            | self.velocity_missed.val()
            | self.shaper_overrun.val()
            | self.controller_overrun.val();
        self.cause_word.watched.next = self.monitors.causes.val();
        self.cause_word.off_causes.next = self.off_causes.val();

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
        self.states.clk.next = self.clk.val();
        self.states.rst.next = self.rst.val();
        self.states.drive_ready.next = self.ready.val() & self.drive_line.level.val();
        self.states.group_stop.next = self.group_stop.val();
        self.states.clear_due.next = self.clear_due.q.val();
        self.states.tick.next = self.tick.val();
        self.states.enable.next = self.enable.val();
        self.states.start.next = self.start.val();
        self.states.stop.next = self.stop.val();
        self.states.segments_state.next = self.segments_state.val();
        self.states.segments_empty.next = self.segments_empty.val();
        self.states.segments_valid.next = self.segments_valid.val();
        self.states.brake_release_ticks.next = self.brake_release_ticks.val();
        self.states.brake_apply_ticks.next = self.brake_apply_ticks.val();
        self.states.settle_ticks.next = self.settle_ticks.val();
        self.states.any_cause.next = self.cause_word.any_cause.val();
        self.states.fault.next = self.cause_word.fault.val();
        self.states.cut.next = self.cause_word.cut.val();
        self.states.had_fault.next = self.cause_word.had_fault.val();

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
        self.enabled.next = self.states.enabled.val();
        self.started.next = self.states.started.val();
        self.stopping.next = self.states.stopping.val();
        self.halted.next = self.states.halted.val();
        self.disabled.next = self.states.disabled.val();
        self.faulted.next = self.states.faulted.val();
        self.refused.next = self.states.refused.val();
    }
}
