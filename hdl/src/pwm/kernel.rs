//! The PWM: joins carrier, command and leg, and latches settings at boundaries.

use super::carrier::Carrier;
use super::command::Command;
use super::gates::Gates;
use super::leg::Leg;
use super::timing::Timing;
use super::trip::Trip;
use crate::prelude::*;
use posicast_blocks::pwm::PwmConfig;

kernel! {
    pub(super) struct Pwm(config: &PwmConfig);
    ports posicast_blocks::pwm_ports;

    parts {
        carrier: Carrier = Carrier::new(config.is_on_time_base()),
        timing: Timing = Timing::new(config),
        command: Command,
        guard: Trip,
        leg: Leg,
        pin_gates: Gates = Gates::new(config),
    }
    registers {
        running_q: Bit, mode_q: Bits<2>, negative_q: Bit, low_q: Bit, high_q: Bit, off_q: Bit, stable: Bit,
        saturated_q: Bit, refused_q: Bit, below_floor_q: Bit, unaligned_q: Bit,
    }
    wires {
        settled: Bit, busy_clocks: Bits<16>, no_slack: Bit, may_run: Bit, goes_on: Bit, starts: Bit,
        wanted: Bit, wants_high: Bit, may_turn: Bit, turns: Bit,
    }
    connect {
        carrier: period, sync, phase, trigger_phase;
        carrier from command: valley_next, peak_next;
        timing: dead_time, minimum_pulse;
        command: mode, duty, max_duty, update_at_peak;
        command from carrier: valley_lead, peak_lead, waits;
        guard: feed, watchdog_periods, filter_clocks, fault_n, pll_locked, filtered_fault_n, clear_trip;
        leg: wanted, wants_high;
        pin_gates from guard: armed;
        pin_gates: mask_pins;
        pin_gates from leg: awake, high_side, low_side;
        outputs from timing: dead_time_used, minimum_pulse_used;
        outputs from pin_gates: gates;
    }
}

impl Logic for Pwm {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm");

        self.carrier.running.next = self.running_q.q.val();
        self.timing.running.next = self.running_q.q.val();
        self.command.period.next = self.carrier.period_used.val();
        self.command.dead_time.next = self.timing.dead_time_used.val();
        self.command.minimum_pulse.next = self.timing.minimum_pulse_used.val();
        self.guard.running.next = self.running_q.q.val();
        self.guard.valley.next = self.command.valley_next.val();

        comment!("Switch off at once, and on at a valley whose");
        comment!("command was computed from unchanged settings");
        self.settled.next = self.timing.settled.val() & self.carrier.settled.val();
        self.stable.d.next = self.settled.val() & (self.stable.q.val() | !self.command.computes.val());
        comment!("Do not start if both sides last exactly the minimum:");
        comment!("a leg that is late once would stay late");
        self.busy_clocks.next = (bit_cast::<16, 10>(self.timing.dead_time_used.val())
            + bit_cast::<16, 10>(self.timing.minimum_pulse_used.val()))
            << 1;
        self.no_slack.next = self.period.val() == self.busy_clocks.val();
        self.may_run.next = self.enable.val() & !self.guard.tripped.val();
        self.goes_on.next = self.running_q.q.val() & self.may_run.val();
        self.starts.next = !self.running_q.q.val()
            & self.may_run.val()
            & self.command.valley_next.val()
            & self.settled.val()
            & self.stable.q.val()
            & !self.carrier.strays.val()
            & !self.no_slack.val();
        self.running_q.d.next = self.goes_on.val() | self.starts.val();

        comment!("Command to the leg at this position");
        self.wanted.next = self.goes_on.val() & !self.off_q.q.val();
        self.wants_high.next = self.high_q.q.val() | (self.command.level.val() & !self.low_q.q.val());
        self.leg.low_first.next = self.mode_q.q.val() == 0;
        self.leg.dead_time.next = self.timing.dead_time_used.val();
        self.leg.minimum_pulse.next = self.timing.minimum_pulse_used.val();
        self.pin_gates.mode.next = self.mode_q.q.val();
        self.pin_gates.negative.next = self.negative_q.q.val();

        comment!("The direction changes with its first pulse");
        self.may_turn.next = !self.leg.awake.val() | self.leg.low_side.val();
        self.turns.next = ((self.command.new_mode.val() == 0) | (self.command.new_mode.val() == 2))
            & !self.command.too_short.val()
            & (self.command.negative.val() != self.negative_q.q.val());

        comment!("A boundary takes the command");
        if self.command.updates.val() {
            self.mode_q.d.next = self.command.new_mode.val();
            self.off_q.d.next = self.goes_on.val() & (self.command.new_mode.val() != self.mode_q.q.val());
            self.low_q.d.next = self.command.too_short.val() | (self.turns.val() & !self.may_turn.val());
            self.high_q.d.next = self.command.too_long.val()
                & !self.command.too_short.val()
                & !(self.turns.val() & !self.may_turn.val());
            if self.turns.val() & self.may_turn.val() {
                self.negative_q.d.next = self.command.negative.val();
            }
        }

        comment!("Flags; setting wins over clearing");
        if self.clear_flags.val() {
            self.saturated_q.d.next = false;
            self.refused_q.d.next = false;
            self.below_floor_q.d.next = false;
            self.unaligned_q.d.next = false;
        }
        if self.command.updates.val() & self.goes_on.val() & self.command.saturated.val() {
            self.saturated_q.d.next = true;
        }
        if self.running_q.q.val() & !self.settled.val() {
            self.refused_q.d.next = true;
        }
        if self.enable.val() & (self.timing.below.val() | (self.settled.val() & self.no_slack.val())) {
            self.below_floor_q.d.next = true;
        }
        if self.running_q.q.val() & self.carrier.out_of_step.val() {
            self.unaligned_q.d.next = true;
        }

        comment!("Outputs");
        self.a_high.next = self.pin_gates.a_high.val();
        self.a_low.next = self.pin_gates.a_low.val();
        self.b_high.next = self.pin_gates.b_high.val();
        self.b_low.next = self.pin_gates.b_low.val();
        self.running.next = self.running_q.q.val();
        self.tripped.next = self.guard.tripped.val();
        self.trip_causes.next = self.guard.causes.val();
        self.negative.next = self.negative_q.q.val();
        self.valley.next = self.carrier.valley.val();
        self.peak.next = self.carrier.peak.val();
        self.trigger.next = self.carrier.trigger.val();
        self.saturated.next = self.saturated_q.q.val();
        self.refused.next = self.refused_q.q.val();
        self.below_floor.next = self.below_floor_q.q.val();
        self.unaligned.next = self.unaligned_q.q.val();
    }
}
