//! When a swap takes effect, and how long two tables share the history.
//!
//! `take` lets the swap that waits take effect at this strobe: at once, or once the position has stood still for `reach`
//! samples, the longest delay of both tables. In a handover `active` is high, and `since` counts the samples since the last
//! one that the old table shaped alone; above `reach` it is over. `newest` is the position of the last sample.
//!
//! A tap goes through on its way from the tables to the rings: it comes two clocks after `old`, `correcting` and `of_position`
//! told of it, and leaves a clock later. Of the old table a tap belongs to the increments of the command with delay ≥ `since`, of the new table to those
//! below. Any other sees the sample that lies `since` back where it is of the position, and counts as zero elsewhere.

use crate::prelude::*;
use posicast_model::rtl::shaper::{ShaperConfig, swap_how};

/// W word, A ring address bits.
#[derive(LogicBlock)]
pub(super) struct Handover<const W: usize, const A: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) position: Signal<In, Signed<W>>,
    pub(super) accepted: Signal<In, Bit>,
    pub(super) swap_how: Signal<In, Bits<2>>,
    pub(super) swap_pending: Signal<In, Bit>,
    pub(super) reach: Signal<In, Bits<A>>,
    pub(super) old: Signal<In, Bit>,
    pub(super) correcting: Signal<In, Bit>,
    pub(super) of_position: Signal<In, Bit>,
    pub(super) tap_coefficient: Signal<In, Signed<18>>,
    pub(super) tap_delay: Signal<In, Bits<A>>,
    pub(super) take: Signal<Out, Bit>,
    pub(super) active: Signal<Out, Bit>,
    pub(super) since: Signal<Out, Bits<A>>,
    pub(super) newest: Signal<Out, Signed<W>>,
    pub(super) coefficient: Signal<Out, Signed<18>>,
    pub(super) delay: Signal<Out, Bits<A>>,

    how: Dff<Bits<2>>,
    still: Dff<Bits<A>>,
    newest_q: Dff<Signed<W>>,
    active_q: Dff<Bit>,
    since_q: Dff<Bits<A>>,
    old_read: Dff<Bit>,
    old_tap: Dff<Bit>,
    correction_read: Dff<Bit>,
    correction: Dff<Bit>,
    position_read: Dff<Bit>,
    position_tap: Dff<Bit>,
    coefficient_q: Dff<Signed<18>>,
    delay_q: Dff<Bits<A>>,

    settled: Signal<Local, Bit>,
    begins: Signal<Local, Bit>,
    next_since: Signal<Local, Bits<A>>,
    below: Signal<Local, Bit>,
    foreign: Signal<Local, Bit>,

    hands_over: Constant<Bits<2>>,
    when_settled: Constant<Bits<2>>,
    moved: Constant<Bits<A>>,
    one_sample: Constant<Bits<A>>,
    for_ever: Constant<Bits<A>>,
    no_coefficient: Constant<Signed<18>>,
    minus_unity: Constant<Signed<18>>,
}

impl<const W: usize, const A: usize> Handover<W, A> {
    pub(super) fn new(config: &ShaperConfig) -> Self {
        let for_ever = u64::from(config.longest_delay_samples()) + 1;
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            start: Signal::default(),
            position: Signal::default(),
            accepted: Signal::default(),
            swap_how: Signal::default(),
            swap_pending: Signal::default(),
            reach: Signal::default(),
            old: Signal::default(),
            correcting: Signal::default(),
            of_position: Signal::default(),
            tap_coefficient: Signal::default(),
            tap_delay: Signal::default(),
            take: Signal::default(),
            active: Signal::default(),
            since: Signal::default(),
            newest: Signal::default(),
            coefficient: Signal::default(),
            delay: Signal::default(),
            how: Dff::default(),
            still: Dff::new(from_u64(for_ever)),
            newest_q: Dff::default(),
            active_q: Dff::default(),
            since_q: Dff::default(),
            old_read: Dff::default(),
            old_tap: Dff::default(),
            correction_read: Dff::default(),
            correction: Dff::default(),
            position_read: Dff::default(),
            position_tap: Dff::default(),
            coefficient_q: Dff::default(),
            delay_q: Dff::default(),
            settled: Signal::default(),
            begins: Signal::default(),
            next_since: Signal::default(),
            below: Signal::default(),
            foreign: Signal::default(),
            hands_over: Constant::new(from_u64(u64::from(swap_how::HANDOVER))),
            when_settled: Constant::new(from_u64(u64::from(swap_how::WHEN_SETTLED))),
            moved: Constant::new(from_u64(0)),
            one_sample: Constant::new(from_u64(1)),
            for_ever: Constant::new(from_u64(for_ever)),
            no_coefficient: Constant::new(from_i64(0)),
            minus_unity: Constant::new(from_i64(-(1 << config.coefficient_fraction()))),
        }
    }
}

impl<const W: usize, const A: usize> Logic for Handover<W, A> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module handover_${width position}x${words delay}_f${log2 minus_unity}");
        comment!("@about When a swap takes effect, and how long");
        comment!("@about two tables share the history.");
        dff_setup!(
            self,
            clk,
            how,
            still,
            newest_q,
            active_q,
            since_q,
            old_read,
            old_tap,
            correction_read,
            correction,
            position_read,
            position_tap,
            coefficient_q,
            delay_q
        );

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

        comment!("Whether a swap takes effect at a strobe");
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

        comment!("What it makes of a tap");
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
