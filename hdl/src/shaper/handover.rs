//! Decides when a swap takes effect, and how long two tables share the history.
//!
//! `take` lets the waiting swap take effect at this strobe: at once, or once the position has stood still for `reach`
//! samples, the longest delay of both tables. In a handover `active` is high, and `since` counts the samples since
//! the last one that the old table shaped alone; the handover ends when `since` exceeds `reach`. `newest` is the
//! position of the last sample.
//!
//! A tap passes through on its way from the tables to the ring buffers: it comes two clocks after its `old`,
//! `correcting` and `of_position`, and leaves one clock later. A tap of the old table applies to the increments of
//! the command with delay ≥ `since`, a tap of the new table to those below. Any other tap uses the sample `since`
//! back for the position, and counts as zero for other channels.

use crate::prelude::*;
use posicast_blocks::shaper::{ShaperConfig, swap_how};

kernel! {
    /// Sizes: W word bits, A ring address bits.
    pub(super) struct Handover<const W: usize, const A: usize>(config: &ShaperConfig);

    inputs {
        rst: Bit,
        strobe: Bit,
        start: Bit,
        position: Signed<W>,
        accepted: Bit,
        swap_how: Bits<2>,
        swap_pending: Bit,
        reach: Bits<A>,
        old: Bit,
        correcting: Bit,
        of_position: Bit,
        tap_coefficient: Signed<18>,
        tap_delay: Bits<A>,
    }
    outputs { take: Bit, active: Bit, since: Bits<A>, newest: Signed<W>, coefficient: Signed<18>, delay: Bits<A> }
    registers {
        how: Bits<2>,
        still: Bits<A> = from_u64(u64::from(config.longest_delay_samples()) + 1),
        newest_q: Signed<W>, active_q: Bit, since_q: Bits<A>, old_read: Bit, old_tap: Bit,
        correction_read: Bit, correction: Bit, position_read: Bit, position_tap: Bit,
        coefficient_q: Signed<18>, delay_q: Bits<A>,
    }
    wires { settled: Bit, begins: Bit, next_since: Bits<A>, below: Bit, foreign: Bit }
    constants {
        hands_over: Bits<2> = from_u64(u64::from(swap_how::HANDOVER)),
        when_settled: Bits<2> = from_u64(u64::from(swap_how::WHEN_SETTLED)),
        moved: Bits<A> = from_u64(0),
        one_sample: Bits<A> = from_u64(1),
        for_ever: Bits<A> = from_u64(u64::from(config.longest_delay_samples()) + 1),
        no_coefficient: Signed<18> = from_i64(0),
        minus_unity: Signed<18> = from_i64(-(1 << config.coefficient_fraction())),
    }
}

impl<const W: usize, const A: usize> Logic for Handover<W, A> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module handover_${width position}x${words delay}_f${log2 minus_unity}");

        comment!("How long the position has stood still");
        if self.strobe.val() {
            self.newest_q.d.next = self.position.val();
            if self.position.val() != self.newest_q.q.val() {
                self.still.d.next = self.moved.val();
            } else if self.still.q.val() != self.for_ever.val() {
                self.still.d.next = self.still.q.val() + self.one_sample.val();
            }
        }
        if self.start.val() {
            self.newest_q.d.next = self.position.val();
            self.still.d.next = self.for_ever.val();
        }

        comment!("A swap may take effect at a strobe");
        if self.accepted.val() {
            self.how.d.next = self.swap_how.val();
        }
        self.settled.next = self.start.val() | (self.still.q.val() >= self.reach.val());
        self.take.next = (self.how.q.val() != self.when_settled.val()) | self.settled.val();

        comment!("From the first sample of the new table on");
        self.next_since.next = self.since_q.q.val() + self.one_sample.val();
        if self.strobe.val() {
            self.since_q.d.next = self.next_since.val();
            if self.since_q.q.val() == self.reach.val() {
                self.active_q.d.next = false;
            }
        }
        self.begins.next = self.strobe.val() & self.swap_pending.val() & (self.how.q.val() == self.hands_over.val());
        if self.begins.val() {
            self.since_q.d.next = self.one_sample.val();
            self.active_q.d.next = self.reach.val() >= self.one_sample.val();
        }
        if self.start.val() {
            self.active_q.d.next = false;
        }

        comment!("Tap during the handover");
        self.old_read.d.next = self.old.val();
        self.old_tap.d.next = self.old_read.q.val();
        self.correction_read.d.next = self.correcting.val();
        self.correction.d.next = self.correction_read.q.val();
        self.position_read.d.next = self.of_position.val();
        self.position_tap.d.next = self.position_read.q.val();
        self.below.next = self.tap_delay.val() < self.since_q.q.val();
        self.foreign.next = self.active_q.q.val() & (self.old_tap.q.val() == self.below.val());
        self.coefficient_q.d.next = self.tap_coefficient.val();
        self.delay_q.d.next = self.tap_delay.val();
        if self.foreign.val() & self.position_tap.q.val() {
            self.delay_q.d.next = self.since_q.q.val();
        }
        if self.foreign.val() & !self.position_tap.q.val() {
            self.coefficient_q.d.next = self.no_coefficient.val();
        }
        if self.correction.q.val() {
            self.coefficient_q.d.next = self.minus_unity.val();
            self.delay_q.d.next = self.since_q.q.val();
        }

        comment!("Outputs");
        self.active.next = self.active_q.q.val();
        self.since.next = self.since_q.q.val();
        self.newest.next = self.newest_q.q.val();
        self.coefficient.next = self.coefficient_q.q.val();
        self.delay.next = self.delay_q.q.val();
    }
}
