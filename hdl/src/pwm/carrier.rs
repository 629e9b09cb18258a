//! The carrier: the position in the period, its boundaries, and the phase to the time base.
//!
//! A boundary is announced in the clock before it. The strobes come with the pins, one clock after the position.

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
    pub(super) position: Signal<Out, Bits<16>>,
    pub(super) period_used: Signal<Out, Bits<16>>,
    pub(super) valley_next: Signal<Out, Bit>,
    pub(super) peak_next: Signal<Out, Bit>,
    pub(super) out_of_step: Signal<Out, Bit>,
    pub(super) realigns: Signal<Out, Bit>,
    pub(super) valley: Signal<Out, Bit>,
    pub(super) peak: Signal<Out, Bit>,
    pub(super) trigger: Signal<Out, Bit>,

    position_q: Dff<Bits<16>>,
    period_q: Dff<Bits<16>>,
    at_valley: Dff<Bit>,
    at_peak: Dff<Bit>,
    valley_q: Dff<Bit>,
    peak_q: Dff<Bit>,
    trigger_q: Dff<Bit>,

    counted: Signal<Local, Bits<16>>,
    at_end: Signal<Local, Bit>,
    at_half: Signal<Local, Bit>,
    next_position: Signal<Local, Bits<16>>,
    off_phase: Signal<Local, Bit>,
    moves: Signal<Local, Bit>,
}

impl Carrier {
    /// The shortest period after reset, so that the first one set comes into use at once.
    pub(super) fn new() -> Self {
        Self {
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
            self, clk, position_q, period_q, at_valley, at_peak, valley_q, peak_q, trigger_q
        );

        self.counted.next = self.position_q.q.val() + 1;
        self.at_end.next = self.counted.val() == self.period_q.q.val();
        self.at_half.next = !self.at_end.val() & (self.counted.val() == (self.period_q.q.val() >> 1));
        self.next_position.next = self.counted.val();
        if self.at_end.val() {
            self.next_position.next = 0.into();
        }

        comment!("The time base moves it while off only");
        self.off_phase.next = false;
        self.moves.next = false;
        self.position_q.d.next = self.next_position.val();
        if self.sync.val() & (self.next_position.val() != self.phase.val()) {
            self.off_phase.next = true;
            if !self.running.val() {
                self.moves.next = true;
                self.position_q.d.next = self.phase.val();
            }
        }
        if self.at_end.val() & !self.running.val() {
            self.period_q.d.next = self.period.val();
        }

        self.at_valley.d.next = self.at_end.val() & !self.moves.val();
        self.at_peak.d.next = self.at_half.val() & !self.moves.val();
        self.valley_q.d.next = self.at_valley.q.val();
        self.peak_q.d.next = self.at_peak.q.val();
        self.trigger_q.d.next = self.position_q.q.val() == self.trigger_phase.val();

        self.position.next = self.position_q.q.val();
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
