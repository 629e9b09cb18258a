//! The carrier: the position in the period, the leads before its boundaries, and the phase relative to the time base.
//!
//! A lead announces each boundary: the valley's comes at `period` − 32, 32 clocks before the valley; the peak's comes
//! at half this position, 16 clocks before the peak. So one register serves both. The command counts the clocks from
//! the lead and reports the boundary, where its results are ready. The strobes come with the pins, one clock after the
//! position.
//!
//! The carrier is aligned by waiting; no position is loaded. If a `sync` finds it at another phase, the carrier, once
//! off, waits at `phase` for the next `sync`. It also waits if its period has changed and it has a time base, and after
//! reset if it is built for a time base.

use crate::prelude::*;

kernel! {
    /// After reset the carrier has the shortest period, so that the first period that is set takes effect soon. With
    /// `on_time_base` it waits for its first `sync`.
    pub(super) struct Carrier(on_time_base: bool);

    inputs {
        rst: Bit,
        running: Bit,
        period: Bits<16>,
        sync: Bit,
        phase: Bits<16>,
        trigger_phase: Bits<16>,
        valley_next: Bit,
        peak_next: Bit,
    }
    outputs {
        period_used: Bits<17>,
        settled: Bit,
        valley_lead: Bit,
        peak_lead: Bit,
        waits: Bit,
        out_of_step: Bit,
        strays: Bit,
        valley: Bit,
        peak: Bit,
        trigger: Bit,
    }
    registers {
        position: Bits<16>,
        period_q: Bits<17> = from_u64(32),
        lead_q: Bits<11>, synced: Bit,
        astray: Bit = on_time_base,
        timed: Bit = on_time_base,
        at_valley: Bit, at_peak: Bit, valley_q: Bit, peak_q: Bit, trigger_q: Bit,
    }
    wires { lead: Bits<16>, in_phase: Bit, holds: Bit, off_phase: Bit, in_use: Bit }
    constants { whole_range: Bits<17> = from_u64(1 << 16) }
}

impl Logic for Carrier {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_carrier${if timed _on_time_base}");

        comment!("The leads: period - 32, and half of that");
        self.lead.next =
            (bit_cast::<16, 11>(self.lead_q.q.val()) << 5) | bit_cast::<16, 5>(self.period_q.q.val().get_bits::<5>(0));
        self.valley_lead.next = self.position.q.val() == self.lead.val();
        self.peak_lead.next = self.position.q.val() == (self.lead.val() >> 1);

        comment!("A carrier that is off and out of phase waits for a");
        comment!("sync; a new period puts it out of phase");
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
