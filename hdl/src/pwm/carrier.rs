//! The carrier: the position in the period, its boundaries, and the phase to the time base.
//!
//! Its register is the position to come, 1 to `period`, so that no comparison waits for a sum: with it the end of a half is
//! announced in the clock before, and what compares with it is a register by the clock of that position. The strobes come
//! with the pins, one clock after the position.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct Carrier {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) running: Signal<In, Bit>,
    pub(super) period: Signal<In, Bits<16>>,
    pub(super) sync: Signal<In, Bit>,
    pub(super) phase: Signal<In, Bits<16>>,
    pub(super) trigger_phase: Signal<In, Bits<16>>,
    pub(super) ahead: Signal<Out, Bits<16>>,
    pub(super) period_used: Signal<Out, Bits<16>>,
    pub(super) valley_next: Signal<Out, Bit>,
    pub(super) peak_next: Signal<Out, Bit>,
    pub(super) out_of_step: Signal<Out, Bit>,
    pub(super) realigns: Signal<Out, Bit>,
    pub(super) valley: Signal<Out, Bit>,
    pub(super) peak: Signal<Out, Bit>,
    pub(super) trigger: Signal<Out, Bit>,

    ahead_q: Dff<Bits<16>>,
    period_q: Dff<Bits<16>>,
    at_valley: Dff<Bit>,
    at_peak: Dff<Bit>,
    at_trigger: Dff<Bit>,
    valley_q: Dff<Bit>,
    peak_q: Dff<Bit>,
    trigger_q: Dff<Bit>,

    at_end: Signal<Local, Bit>,
    at_half: Signal<Local, Bit>,
    in_phase: Signal<Local, Bit>,
    triggers: Signal<Local, Bit>,
    off_phase: Signal<Local, Bit>,
    moves: Signal<Local, Bit>,
    comes: Signal<Local, Bits<16>>,
}

impl Carrier {
    /// The shortest period after reset, so that the first one set comes into use at once.
    pub(super) fn new() -> Self {
        Self {
            ahead_q: Dff::new(from_u64(1)),
            period_q: Dff::new(from_u64(1)),
            ..Self::default()
        }
    }
}

impl Logic for Carrier {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_carrier");
        comment!("@about Position in the period; boundaries.");
        dff_setup!(
            self, clk, ahead_q, period_q, at_valley, at_peak, at_trigger, valley_q, peak_q, trigger_q
        );

        comment!("The position to come, or 0 at the end");
        self.at_end.next = self.ahead_q.q.val() == self.period_q.q.val();
        self.at_half.next = !self.at_end.val() & (self.ahead_q.q.val() == (self.period_q.q.val() >> 1));
        self.in_phase.next = self.ahead_q.q.val() == self.phase.val();
        self.triggers.next = self.ahead_q.q.val() == self.trigger_phase.val();
        self.comes.next = self.ahead_q.q.val();
        if self.at_end.val() {
            self.in_phase.next = !self.phase.val().any();
            self.triggers.next = !self.trigger_phase.val().any();
            self.comes.next = 0.into();
        }

        comment!("The time base moves it while off only");
        self.off_phase.next = self.sync.val() & !self.in_phase.val();
        self.moves.next = self.off_phase.val() & !self.running.val();
        if self.sync.val() & !self.running.val() {
            self.comes.next = self.phase.val();
        }
        self.ahead_q.d.next = self.comes.val() + 1;
        if self.at_end.val() & !self.running.val() {
            self.period_q.d.next = self.period.val();
        }

        self.at_valley.d.next = self.at_end.val() & !self.moves.val();
        self.at_peak.d.next = self.at_half.val() & !self.moves.val();
        self.at_trigger.d.next = self.triggers.val() & !self.moves.val();
        self.valley_q.d.next = self.at_valley.q.val();
        self.peak_q.d.next = self.at_peak.q.val();
        self.trigger_q.d.next = self.at_trigger.q.val();

        self.ahead.next = self.ahead_q.q.val();
        self.period_used.next = self.period_q.q.val();
        self.valley_next.next = self.at_end.val();
        self.peak_next.next = self.at_half.val();
        self.out_of_step.next = self.off_phase.val();
        self.realigns.next = self.moves.val();
        self.valley.next = self.valley_q.q.val();
        self.peak.next = self.peak_q.q.val();
        self.trigger.next = self.trigger_q.q.val();
    }
}
