//! The states: the transition table, the timer of brake and shaper, and the outputs that depend on them.
//!
//! Within a state, later branches win; they are the earlier rows of the table.

use super::timer::Timer;
use crate::prelude::*;
use posicast_blocks::axis::SupervisorState;
use posicast_blocks::segments;

kernel! {
    pub(super) struct States;

    inputs {
        rst: Bit,
        tick: Bit,
        enable: Bit,
        start: Bit,
        stop: Bit,
        drive_ready: Bit,
        group_stop: Bit,
        any_cause: Bit,
        fault: Bit,
        cut: Bit,
        had_fault: Bit,
        clear_due: Bit,
        segments_state: Bits<2>,
        segments_empty: Bit,
        segments_valid: Bit,
        brake_release_ticks: Bits<16>,
        brake_apply_ticks: Bits<16>,
        settle_ticks: Bits<16>,
    }
    outputs {
        state: Bits<3>,
        on: Bit,
        released: Bit,
        starting: Bit,
        running: Bit,
        wants_group_stop: Bit,
        forget: Bit,
        quick_stop: Bit,
        restart: Bit,
        can_start: Bit,
        enabled: Bit,
        started: Bit,
        stopping: Bit,
        halted: Bit,
        disabled: Bit,
        faulted: Bit,
        refused: Bit,
    }
    parts { timer: Timer }
    registers {
        state_q: Bits<3>, opening: Bit, closing: Bit, ran: Bit, applies: Bit, on_q: Bit, released_q: Bit,
        starting_q: Bit = true,
        start_waits: Bit, quick_stop_q: Bit, restart_q: Bit, can_start_q: Bit, enabled_q: Bit, started_q: Bit,
        stopping_q: Bit, halted_q: Bit, disabled_q: Bit, faulted_q: Bit, refused_q: Bit, cleared: Bit,
    }
    wires {
        in_off: Bit, in_ready: Bit, in_hold: Bit, in_run: Bit, in_stop: Bit, in_fault: Bit,
        segments_hold: Bit, segments_stopped: Bit, segments_play: Bit, timed_out: Bit, able: Bit,
        wants_start: Bit, closes: Bit, clears: Bit, asked: Bit, done: Bit, at_rest: Bit, goes_on: Bit,
        goes_quiet: Bit, ready_to_hold: Bit, ready_to_fault: Bit, hold_to_off: Bit, hold_to_run: Bit,
        hold_to_stop: Bit, hold_to_fault: Bit, run_to_hold: Bit, run_to_stop: Bit, run_to_fault: Bit,
        stop_to_hold: Bit, stop_to_fault: Bit, to_off: Bit, to_hold: Bit, to_stop: Bit, to_fault: Bit,
        begins_apply: Bit, stays_stop: Bit, next_on: Bit, next_closing: Bit, next_state: Bits<3>,
    }
    constants {
        off_state: Bits<3> = from_u64(SupervisorState::Off as u64),
        ready_state: Bits<3> = from_u64(SupervisorState::Ready as u64),
        hold_state: Bits<3> = from_u64(SupervisorState::Hold as u64),
        run_state: Bits<3> = from_u64(SupervisorState::Run as u64),
        stop_state: Bits<3> = from_u64(SupervisorState::QuickStop as u64),
        fault_state: Bits<3> = from_u64(SupervisorState::Fault as u64),
        segments_hold_state: Bits<2> = from_u64(segments::SegmentsState::Hold as u64),
        segments_stopped_state: Bits<2> = from_u64(segments::SegmentsState::Stopped as u64),
    }
    connect {
        timer: brake_release_ticks, brake_apply_ticks, settle_ticks;
    }
}

impl Logic for States {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_states");
        self.in_off.next = self.state_q.q.val() == self.off_state.val();
        self.in_ready.next = self.state_q.q.val() == self.ready_state.val();
        self.in_hold.next = self.state_q.q.val() == self.hold_state.val();
        self.in_run.next = self.state_q.q.val() == self.run_state.val();
        self.in_stop.next = self.state_q.q.val() == self.stop_state.val();
        self.in_fault.next = self.state_q.q.val() == self.fault_state.val();
        self.segments_hold.next = self.segments_state.val() == self.segments_hold_state.val();
        self.segments_stopped.next = self.segments_state.val() == self.segments_stopped_state.val();
        self.segments_play.next = !self.segments_state.val().get_bit(1);
        self.timed_out.next = self.tick.val() & self.timer.elapsed.val();

        comment!("A start waits for the tick");
        self.able.next = self.in_hold.val()
            & (!self.opening.q.val() | self.timer.elapsed.val())
            & !self.closing.q.val()
            & self.segments_hold.val();
        self.wants_start.next = (self.start.val() | self.start_waits.q.val()) & !self.stop.val();
        self.start_waits.d.next = self.wants_start.val() & !self.tick.val();

        comment!("Conditions of transitions");
        self.clears.next = self.clear_due.val()
            & !self.in_stop.val()
            & !(self.in_fault.val() & self.on_q.q.val())
            & !(self.had_fault.val() & !self.in_off.val() & !self.in_fault.val());
        self.forget.next = self.clears.val();
        self.cleared.d.next = self.clears.val();
        self.asked.next = self.stop.val() | self.group_stop.val() | !self.enable.val();
        self.done.next = self.tick.val() & self.segments_hold.val() & self.segments_empty.val();
        self.at_rest.next = self.timed_out.val() & self.segments_stopped.val();
        self.goes_on.next = self.tick.val() & self.enable.val() & !self.group_stop.val();
        self.goes_quiet.next = self.timed_out.val() & self.closing.q.val();
        self.closes.next = self.in_hold.val() & self.timed_out.val() & !self.enable.val() & !self.closing.q.val();

        comment!("The transition table; switching off leads to FAULT");
        self.ready_to_fault.next = self.in_ready.val() & self.fault.val();
        self.ready_to_hold.next = self.in_ready.val() & self.goes_on.val() & self.drive_ready.val() & !self.fault.val();
        self.hold_to_fault.next = self.in_hold.val() & self.fault.val() & (self.cut.val() | self.closing.q.val());
        self.hold_to_stop.next = self.in_hold.val() & self.fault.val() & !(self.cut.val() | self.closing.q.val());
        self.hold_to_off.next = self.in_hold.val() & self.goes_quiet.val() & !self.fault.val();
        self.hold_to_run.next = self.able.val() & self.goes_on.val() & self.wants_start.val() & !self.any_cause.val();
        self.run_to_fault.next = self.in_run.val() & self.cut.val();
        self.run_to_stop.next = self.in_run.val() & (self.fault.val() | self.asked.val()) & !self.cut.val();
        self.run_to_hold.next = self.in_run.val() & self.done.val() & !self.fault.val() & !self.asked.val();
        self.stop_to_fault.next = self.in_stop.val() & (self.cut.val() | (self.at_rest.val() & self.fault.val()));
        self.stop_to_hold.next = self.in_stop.val() & self.at_rest.val() & !self.fault.val();
        self.to_off.next = (self.in_ready.val() & !self.drive_ready.val() & !self.fault.val())
            | self.hold_to_off.val()
            | (self.in_fault.val() & self.cleared.q.val() & !self.on_q.q.val() & !self.any_cause.val());
        self.to_hold.next = self.ready_to_hold.val() | self.run_to_hold.val() | self.stop_to_hold.val();
        self.to_stop.next = self.hold_to_stop.val() | self.run_to_stop.val();
        self.to_fault.next =
            self.ready_to_fault.val() | self.hold_to_fault.val() | self.run_to_fault.val() | self.stop_to_fault.val();
        self.next_state.next = self.state_q.q.val();
        if self.in_off.val() & self.drive_ready.val() & !self.any_cause.val() & !self.enable.val() {
            self.next_state.next = self.ready_state.val();
        }
        if self.to_off.val() {
            self.next_state.next = self.off_state.val();
        }
        if self.to_hold.val() {
            self.next_state.next = self.hold_state.val();
        }
        if self.hold_to_run.val() {
            self.next_state.next = self.run_state.val();
        }
        if self.to_stop.val() {
            self.next_state.next = self.stop_state.val();
        }
        if self.to_fault.val() {
            self.next_state.next = self.fault_state.val();
        }
        self.state_q.d.next = self.next_state.val();

        comment!("The timer of brake and shaper");
        self.timer.counts.next = self.tick.val() & (!self.in_stop.val() | self.segments_stopped.val());
        self.begins_apply.next = self.stop_to_fault.val() | (self.closes.val() & !self.fault.val());
        self.timer.clears.next =
            self.ready_to_hold.val() | self.in_run.val() | self.to_stop.val() | self.begins_apply.val();
        self.timer.load_release.next = self.enabled_q.q.val();
        self.ran.d.next = self.in_run.val();
        self.timer.load_settle.next = self.ran.q.val() | self.stopping_q.q.val();
        self.applies.d.next = self.begins_apply.val();
        self.timer.load_apply.next = self.applies.q.val();

        comment!("Outputs and brake");
        self.next_on.next = self.on_q.q.val();
        self.next_closing.next = self.closing.q.val() | self.begins_apply.val();
        if self.ready_to_hold.val() {
            self.next_on.next = true;
        }
        if self.goes_quiet.val() | self.cut.val() {
            self.next_on.next = false;
            self.next_closing.next = false;
        }
        self.on_q.d.next = self.next_on.val();
        self.closing.d.next = self.next_closing.val();
        self.released_q.d.next = self.next_on.val() & !self.next_closing.val();
        self.opening.d.next = self.ready_to_hold.val()
            | (self.opening.q.val() & !self.fault.val() & !self.goes_quiet.val() & !self.hold_to_run.val());
        self.starting_q.d.next = !self.next_on.val() | (self.starting_q.q.val() & !self.segments_valid.val());

        comment!("Pulses");
        self.stays_stop.next = self.in_stop.val() & !self.stop_to_fault.val() & !self.stop_to_hold.val();
        self.quick_stop_q.d.next = (self.to_stop.val() | self.stays_stop.val()) & self.segments_play.val();
        self.restart_q.d.next = self.in_hold.val() & self.segments_stopped.val();
        self.can_start_q.d.next = self.able.val() & self.enable.val() & !self.group_stop.val() & !self.any_cause.val();
        self.enabled_q.d.next = self.ready_to_hold.val();
        self.started_q.d.next = self.hold_to_run.val();
        self.stopping_q.d.next = self.to_stop.val();
        self.halted_q.d.next = self.run_to_hold.val() | self.stop_to_hold.val();
        self.disabled_q.d.next = self.hold_to_off.val();
        self.faulted_q.d.next = self.to_fault.val();
        self.refused_q.d.next = self.tick.val() & self.wants_start.val() & !self.hold_to_run.val();

        self.state.next = self.state_q.q.val();
        self.on.next = self.on_q.q.val();
        self.released.next = self.released_q.q.val();
        self.starting.next = self.starting_q.q.val();
        self.running.next = self.in_run.val();
        self.wants_group_stop.next = self.in_fault.val() | (self.in_stop.val() & self.had_fault.val());
        self.quick_stop.next = self.quick_stop_q.q.val();
        self.restart.next = self.restart_q.q.val();
        self.can_start.next = self.can_start_q.q.val();
        self.enabled.next = self.enabled_q.q.val();
        self.started.next = self.started_q.q.val();
        self.stopping.next = self.stopping_q.q.val();
        self.halted.next = self.halted_q.q.val();
        self.disabled.next = self.disabled_q.q.val();
        self.faulted.next = self.faulted_q.q.val();
        self.refused.next = self.refused_q.q.val();
    }
}
