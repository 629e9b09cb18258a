//! The carrier: the position in the period, the leads before its boundaries, and the phase to the time base.
//!
//! A boundary comes a fixed number of clocks after its lead: 32 after a valley's, at `period` − 32; 16 after a peak's, at half
//! of that. The command counts them, and tells when the boundary is there. So one register serves both, and what the command
//! computes is ready at the boundary. The strobes come with the pins, one clock after the position.
//!
//! While off, a carrier that a `sync` has found at another phase waits at `phase` for the next one: no position is loaded. So
//! does one that has a time base and another period than before, and after reset one that is built for a time base.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Carrier {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) running: Signal<In, Bit>,
    pub(super) period: Signal<In, Bits<16>>,
    pub(super) sync: Signal<In, Bit>,
    pub(super) phase: Signal<In, Bits<16>>,
    pub(super) trigger_phase: Signal<In, Bits<16>>,
    pub(super) valley_next: Signal<In, Bit>,
    pub(super) peak_next: Signal<In, Bit>,
    pub(super) period_used: Signal<Out, Bits<17>>,
    pub(super) settled: Signal<Out, Bit>,
    pub(super) valley_lead: Signal<Out, Bit>,
    pub(super) peak_lead: Signal<Out, Bit>,
    pub(super) waits: Signal<Out, Bit>,
    pub(super) out_of_step: Signal<Out, Bit>,
    pub(super) strays: Signal<Out, Bit>,
    pub(super) valley: Signal<Out, Bit>,
    pub(super) peak: Signal<Out, Bit>,
    pub(super) trigger: Signal<Out, Bit>,

    position: Dff<Bits<16>>,
    period_q: Dff<Bits<17>>,
    lead_q: Dff<Bits<11>>,
    synced: Dff<Bit>,
    astray: Dff<Bit>,
    timed: Dff<Bit>,
    at_valley: Dff<Bit>,
    at_peak: Dff<Bit>,
    valley_q: Dff<Bit>,
    peak_q: Dff<Bit>,
    trigger_q: Dff<Bit>,

    lead: Signal<Local, Bits<16>>,
    in_phase: Signal<Local, Bit>,
    holds: Signal<Local, Bit>,
    off_phase: Signal<Local, Bit>,
    in_use: Signal<Local, Bit>,

    whole_range: Constant<Bits<17>>,
}

impl Carrier {
    /// The shortest period after reset, so that the first one set soon comes into use. `on_time_base`: it waits for its first
    /// `sync`.
    pub(super) fn new(on_time_base: bool) -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            running: Signal::default(),
            period: Signal::default(),
            sync: Signal::default(),
            phase: Signal::default(),
            trigger_phase: Signal::default(),
            valley_next: Signal::default(),
            peak_next: Signal::default(),
            period_used: Signal::default(),
            settled: Signal::default(),
            valley_lead: Signal::default(),
            peak_lead: Signal::default(),
            waits: Signal::default(),
            out_of_step: Signal::default(),
            strays: Signal::default(),
            valley: Signal::default(),
            peak: Signal::default(),
            trigger: Signal::default(),
            position: Dff::default(),
            period_q: Dff::new(from_u64(32)),
            lead_q: Dff::default(),
            synced: Dff::default(),
            astray: Dff::new(on_time_base),
            timed: Dff::new(on_time_base),
            at_valley: Dff::default(),
            at_peak: Dff::default(),
            valley_q: Dff::default(),
            peak_q: Dff::default(),
            trigger_q: Dff::default(),
            lead: Signal::default(),
            in_phase: Signal::default(),
            holds: Signal::default(),
            off_phase: Signal::default(),
            in_use: Signal::default(),
            whole_range: Constant::new(from_u64(1 << 16)),
        }
    }
}

impl Logic for Carrier {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_carrier${if timed _on_time_base}");
        comment!("@about Position in the period; boundaries.");
        dff_setup!(
            self, clk, position, period_q, lead_q, synced, astray, timed, at_valley, at_peak, valley_q, peak_q,
            trigger_q
        );

        comment!("The leads: period - 32, and half of that");
        self.lead.next =
            (bit_cast::<16, 11>(self.lead_q.q.val()) << 5) | bit_cast::<16, 5>(self.period_q.q.val().get_bits::<5>(0));
        self.valley_lead.next = self.position.q.val() == self.lead.val();
        self.peak_lead.next = self.position.q.val() == (self.lead.val() >> 1);

        comment!("Astray and off, it waits for a sync at its phase;");
        comment!("with another period it is in phase by chance only");
        self.in_use.next = self.period_q.q.val().get_bits::<16>(0) == self.period.val();
        self.timed.d.next = self.timed.q.val() | self.sync.val();
        self.in_phase.next = self.position.q.val() == self.phase.val();
        self.holds.next = self.astray.q.val() & self.in_phase.val() & !self.running.val();
        self.synced.d.next = self.sync.val();
        self.off_phase.next = self.synced.q.val() & !self.in_phase.val();
        if self.holds.val() & self.sync.val() {
            self.astray.d.next = false;
        }
        if self.off_phase.val()
            | (self.valley_next.val() & !self.running.val() & !self.in_use.val() & self.timed.q.val())
        {
            self.astray.d.next = true;
        }

        if !self.holds.val() {
            self.position.d.next = self.position.q.val() + 1;
        }
        if self.valley_next.val() {
            self.position.d.next = 0.into();
        }
        if self.valley_next.val() & !self.running.val() {
            self.period_q.d.next = bit_cast::<17, 16>(self.period.val());
            if !self.period.val().any() {
                self.period_q.d.next = self.whole_range.val();
            }
            self.lead_q.d.next = self.period.val().get_bits::<11>(5) - 1;
        }

        self.at_valley.d.next = self.valley_next.val();
        self.at_peak.d.next = self.peak_next.val();
        self.valley_q.d.next = self.at_valley.q.val();
        self.peak_q.d.next = self.at_peak.q.val();
        self.trigger_q.d.next = (self.position.q.val() == self.trigger_phase.val()) & !self.holds.val();

        self.period_used.next = self.period_q.q.val();
        self.settled.next = self.in_use.val();
        self.waits.next = self.holds.val();
        self.out_of_step.next = self.off_phase.val();
        self.strays.next = self.astray.q.val();
        self.valley.next = self.valley_q.q.val();
        self.peak.next = self.peak_q.q.val();
        self.trigger.next = self.trigger_q.q.val();
    }
}
