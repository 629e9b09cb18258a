//! The states: the transition table, the timer of brake and shaper, the outputs that follow.
//!
//! Within a state, later branches win: they are the earlier rows of the table.

use super::timer::Timer;
use crate::prelude::*;
use posicast_model::rtl::axis::State;
use posicast_model::rtl::segments;

#[derive(LogicBlock)]
pub(super) struct States {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) enable: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) stop: Signal<In, Bit>,
    pub(super) drive_ready: Signal<In, Bit>,
    pub(super) group_stop: Signal<In, Bit>,
    pub(super) any_cause: Signal<In, Bit>,
    pub(super) fault: Signal<In, Bit>,
    pub(super) cut: Signal<In, Bit>,
    pub(super) had_fault: Signal<In, Bit>,
    pub(super) clear_due: Signal<In, Bit>,
    pub(super) segments_state: Signal<In, Bits<2>>,
    pub(super) segments_empty: Signal<In, Bit>,
    pub(super) segments_valid: Signal<In, Bit>,
    pub(super) brake_release_ticks: Signal<In, Bits<16>>,
    pub(super) brake_apply_ticks: Signal<In, Bits<16>>,
    pub(super) settle_ticks: Signal<In, Bits<16>>,
    pub(super) state: Signal<Out, Bits<3>>,
    pub(super) on: Signal<Out, Bit>,
    pub(super) released: Signal<Out, Bit>,
    pub(super) starting: Signal<Out, Bit>,
    pub(super) running: Signal<Out, Bit>,
    pub(super) wants_group_stop: Signal<Out, Bit>,
    pub(super) forget: Signal<Out, Bit>,
    pub(super) quick_stop: Signal<Out, Bit>,
    pub(super) restart: Signal<Out, Bit>,
    pub(super) can_start: Signal<Out, Bit>,
    pub(super) enabled: Signal<Out, Bit>,
    pub(super) started: Signal<Out, Bit>,
    pub(super) stopping: Signal<Out, Bit>,
    pub(super) halted: Signal<Out, Bit>,
    pub(super) disabled: Signal<Out, Bit>,
    pub(super) faulted: Signal<Out, Bit>,
    pub(super) refused: Signal<Out, Bit>,

    timer: Timer,
    state_q: Dff<Bits<3>>,
    opening: Dff<Bit>,
    closing: Dff<Bit>,
    ran: Dff<Bit>,
    applies: Dff<Bit>,
    on_q: Dff<Bit>,
    released_q: Dff<Bit>,
    starting_q: Dff<Bit>,
    start_waits: Dff<Bit>,
    quick_stop_q: Dff<Bit>,
    restart_q: Dff<Bit>,
    can_start_q: Dff<Bit>,
    enabled_q: Dff<Bit>,
    started_q: Dff<Bit>,
    stopping_q: Dff<Bit>,
    halted_q: Dff<Bit>,
    disabled_q: Dff<Bit>,
    faulted_q: Dff<Bit>,
    refused_q: Dff<Bit>,
    cleared: Dff<Bit>,

    in_off: Signal<Local, Bit>,
    in_ready: Signal<Local, Bit>,
    in_hold: Signal<Local, Bit>,
    in_run: Signal<Local, Bit>,
    in_stop: Signal<Local, Bit>,
    in_fault: Signal<Local, Bit>,
    segments_hold: Signal<Local, Bit>,
    segments_stopped: Signal<Local, Bit>,
    segments_play: Signal<Local, Bit>,
    timed_out: Signal<Local, Bit>,
    able: Signal<Local, Bit>,
    wants_start: Signal<Local, Bit>,
    closes: Signal<Local, Bit>,
    clears: Signal<Local, Bit>,
    asked: Signal<Local, Bit>,
    done: Signal<Local, Bit>,
    at_rest: Signal<Local, Bit>,
    goes_on: Signal<Local, Bit>,
    goes_quiet: Signal<Local, Bit>,
    ready_to_hold: Signal<Local, Bit>,
    ready_to_fault: Signal<Local, Bit>,
    hold_to_off: Signal<Local, Bit>,
    hold_to_run: Signal<Local, Bit>,
    hold_to_stop: Signal<Local, Bit>,
    hold_to_fault: Signal<Local, Bit>,
    run_to_hold: Signal<Local, Bit>,
    run_to_stop: Signal<Local, Bit>,
    run_to_fault: Signal<Local, Bit>,
    stop_to_hold: Signal<Local, Bit>,
    stop_to_fault: Signal<Local, Bit>,
    to_off: Signal<Local, Bit>,
    to_hold: Signal<Local, Bit>,
    to_stop: Signal<Local, Bit>,
    to_fault: Signal<Local, Bit>,
    begins_apply: Signal<Local, Bit>,
    stays_stop: Signal<Local, Bit>,
    next_on: Signal<Local, Bit>,
    next_closing: Signal<Local, Bit>,
    next_state: Signal<Local, Bits<3>>,

    off_state: Constant<Bits<3>>,
    ready_state: Constant<Bits<3>>,
    hold_state: Constant<Bits<3>>,
    run_state: Constant<Bits<3>>,
    stop_state: Constant<Bits<3>>,
    fault_state: Constant<Bits<3>>,
    segments_hold_state: Constant<Bits<2>>,
    segments_stopped_state: Constant<Bits<2>>,
}

impl Default for States {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            enable: Signal::default(),
            start: Signal::default(),
            stop: Signal::default(),
            drive_ready: Signal::default(),
            group_stop: Signal::default(),
            any_cause: Signal::default(),
            fault: Signal::default(),
            cut: Signal::default(),
            had_fault: Signal::default(),
            clear_due: Signal::default(),
            segments_state: Signal::default(),
            segments_empty: Signal::default(),
            segments_valid: Signal::default(),
            brake_release_ticks: Signal::default(),
            brake_apply_ticks: Signal::default(),
            settle_ticks: Signal::default(),
            state: Signal::default(),
            on: Signal::default(),
            released: Signal::default(),
            starting: Signal::default(),
            running: Signal::default(),
            wants_group_stop: Signal::default(),
            forget: Signal::default(),
            quick_stop: Signal::default(),
            restart: Signal::default(),
            can_start: Signal::default(),
            enabled: Signal::default(),
            started: Signal::default(),
            stopping: Signal::default(),
            halted: Signal::default(),
            disabled: Signal::default(),
            faulted: Signal::default(),
            refused: Signal::default(),
            timer: Timer::default(),
            state_q: Dff::default(),
            opening: Dff::default(),
            closing: Dff::default(),
            ran: Dff::default(),
            applies: Dff::default(),
            on_q: Dff::default(),
            released_q: Dff::default(),
            starting_q: Dff::new(true),
            start_waits: Dff::default(),
            quick_stop_q: Dff::default(),
            restart_q: Dff::default(),
            can_start_q: Dff::default(),
            enabled_q: Dff::default(),
            started_q: Dff::default(),
            stopping_q: Dff::default(),
            halted_q: Dff::default(),
            disabled_q: Dff::default(),
            faulted_q: Dff::default(),
            refused_q: Dff::default(),
            cleared: Dff::default(),
            in_off: Signal::default(),
            in_ready: Signal::default(),
            in_hold: Signal::default(),
            in_run: Signal::default(),
            in_stop: Signal::default(),
            in_fault: Signal::default(),
            segments_hold: Signal::default(),
            segments_stopped: Signal::default(),
            segments_play: Signal::default(),
            timed_out: Signal::default(),
            able: Signal::default(),
            wants_start: Signal::default(),
            closes: Signal::default(),
            clears: Signal::default(),
            asked: Signal::default(),
            done: Signal::default(),
            at_rest: Signal::default(),
            goes_on: Signal::default(),
            goes_quiet: Signal::default(),
            ready_to_hold: Signal::default(),
            ready_to_fault: Signal::default(),
            hold_to_off: Signal::default(),
            hold_to_run: Signal::default(),
            hold_to_stop: Signal::default(),
            hold_to_fault: Signal::default(),
            run_to_hold: Signal::default(),
            run_to_stop: Signal::default(),
            run_to_fault: Signal::default(),
            stop_to_hold: Signal::default(),
            stop_to_fault: Signal::default(),
            to_off: Signal::default(),
            to_hold: Signal::default(),
            to_stop: Signal::default(),
            to_fault: Signal::default(),
            begins_apply: Signal::default(),
            stays_stop: Signal::default(),
            next_on: Signal::default(),
            next_closing: Signal::default(),
            next_state: Signal::default(),
            off_state: Constant::new(from_u64(State::Off as u64)),
            ready_state: Constant::new(from_u64(State::Ready as u64)),
            hold_state: Constant::new(from_u64(State::Hold as u64)),
            run_state: Constant::new(from_u64(State::Run as u64)),
            stop_state: Constant::new(from_u64(State::QuickStop as u64)),
            fault_state: Constant::new(from_u64(State::Fault as u64)),
            segments_hold_state: Constant::new(from_u64(segments::State::Hold as u64)),
            segments_stopped_state: Constant::new(from_u64(segments::State::Stopped as u64)),
        }
    }
}

impl Logic for States {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_states");
        comment!("@about OFF, READY, HOLD, RUN, QUICK_STOP, FAULT.");
        dff_setup!(
            self,
            clk,
            state_q,
            opening,
            closing,
            ran,
            applies,
            on_q,
            released_q,
            starting_q,
            start_waits,
            quick_stop_q,
            restart_q,
            can_start_q,
            enabled_q,
            started_q,
            stopping_q,
            halted_q,
            disabled_q,
            faulted_q,
            refused_q,
            cleared
        );
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

        comment!("The transition table; a cut is a fault");
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
        self.timer.clk.next = self.clk.val();
        self.timer.rst.next = self.rst.val();
        self.timer.counts.next = self.tick.val() & (!self.in_stop.val() | self.segments_stopped.val());
        self.begins_apply.next = self.stop_to_fault.val() | (self.closes.val() & !self.fault.val());
        self.timer.clears.next =
            self.ready_to_hold.val() | self.in_run.val() | self.to_stop.val() | self.begins_apply.val();
        self.timer.load_release.next = self.enabled_q.q.val();
        self.ran.d.next = self.in_run.val();
        self.timer.load_settle.next = self.ran.q.val() | self.stopping_q.q.val();
        self.applies.d.next = self.begins_apply.val();
        self.timer.load_apply.next = self.applies.q.val();
        self.timer.brake_release_ticks.next = self.brake_release_ticks.val();
        self.timer.brake_apply_ticks.next = self.brake_apply_ticks.val();
        self.timer.settle_ticks.next = self.settle_ticks.val();

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
