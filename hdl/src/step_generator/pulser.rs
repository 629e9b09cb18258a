//! The pulser: gives an owed step as soon as the times of the lines allow it, and changes the direction for it.
//!
//! One timer counts the clocks since the pulse began, since it ended, or since the direction changed, whichever came last.
//! It is compared for equality only; `may_step` and `may_turn` remember that a time is over, so the timer may wrap.

use crate::prelude::*;
use posicast_blocks::step_generator::StepGeneratorConfig;

kernel! {
    pub(super) struct StepPulser(config: &StepGeneratorConfig);

    inputs { rst: Bit, wanted: Bit, wants_up: Bit }
    outputs { gives: Bit, up: Bit, shows_pulse: Bit, shows_up: Bit }
    registers { up_q: Bit, pulsing: Bit, turned: Bit = true, may_step: Bit, may_turn: Bit, timer: Bits<16> }
    wires {
        rested: Bit, steps: Bit, turns: Bit, may_step_now: Bit, may_turn_now: Bit, pulses: Bit, next_up: Bit,
    }
    constants {
        one_clock: Bits<16> = from_u64(1),
        used_clocks: Bits<16> = from_u64(used_clocks(config)),
        pulse: Bits<16> = from_u64(config.times().pulse_clocks),
        space: Bits<16> = from_u64(config.times().space_clocks),
        setup: Bits<16> = from_u64(config.turned_clocks()),
        hold: Bits<16> = from_u64(config.times().direction_hold_clocks),
    }
}

/// The bits of the timer that its times need.
fn used_clocks(config: &StepGeneratorConfig) -> u64 {
    let times = config.times();
    let longest = times
        .pulse_clocks
        .max(config.turned_clocks())
        .max(times.direction_hold_clocks);
    (longest + 1).next_power_of_two() - 1
}

impl Logic for StepPulser {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module step_pulser_${value pulse}x${value space}x${value setup}x${value hold}");

        comment!("Synthesis removes bits that the times do not need");
        self.timer.d.next = (self.timer.q.val() + self.one_clock.val()) & self.used_clocks.val();
        self.pulses.next = self.pulsing.q.val();
        if self.pulsing.q.val() & (self.timer.q.val() == self.pulse.val()) {
            self.pulses.next = false;
            self.timer.d.next = self.one_clock.val();
        }

        comment!("Space, or setup after a change of direction; hold");
        self.rested.next = self.timer.q.val() == self.space.val();
        if self.turned.q.val() {
            self.rested.next = self.timer.q.val() == self.setup.val();
        }
        self.may_step_now.next = self.may_step.q.val() | (!self.pulsing.q.val() & self.rested.val());
        self.may_turn_now.next =
            self.may_turn.q.val() | (!self.pulsing.q.val() & (self.timer.q.val() == self.hold.val()));
        self.may_step.d.next = self.may_step_now.val();
        self.may_turn.d.next = self.may_turn_now.val();

        self.steps.next = self.wanted.val() & self.may_step_now.val() & !(self.wants_up.val() ^ self.up_q.q.val());
        self.turns.next = self.wanted.val() & self.may_turn_now.val() & (self.wants_up.val() ^ self.up_q.q.val());
        self.next_up.next = self.up_q.q.val() ^ self.turns.val();
        if self.turns.val() {
            self.turned.d.next = true;
            self.may_step.d.next = false;
            self.timer.d.next = self.one_clock.val();
        }
        if self.steps.val() {
            self.pulses.next = true;
            self.turned.d.next = false;
            self.may_step.d.next = false;
            self.may_turn.d.next = false;
            self.timer.d.next = self.one_clock.val();
        }
        self.up_q.d.next = self.next_up.val();
        self.pulsing.d.next = self.pulses.val();

        self.gives.next = self.steps.val();
        self.up.next = self.up_q.q.val();
        self.shows_pulse.next = self.pulses.val();
        self.shows_up.next = self.next_up.val();
    }
}
