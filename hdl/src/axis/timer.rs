//! The timer of brake and shaper, in ticks: loaded in the first clock of what begins, and over two clocks later at the
//! earliest. It is cleared in the clock before, so that loading is the same sum as counting.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Timer {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) counts: Signal<In, Bit>,
    /// Something is loaded in the next clock, and nothing in this one that is needed.
    pub(super) clears: Signal<In, Bit>,
    pub(super) load_release: Signal<In, Bit>,
    pub(super) load_settle: Signal<In, Bit>,
    pub(super) load_apply: Signal<In, Bit>,
    pub(super) brake_release_ticks: Signal<In, Bits<16>>,
    pub(super) brake_apply_ticks: Signal<In, Bits<16>>,
    pub(super) settle_ticks: Signal<In, Bits<16>>,
    pub(super) elapsed: Signal<Out, Bit>,

    left: Dff<Bits<16>>,
    over: Dff<Bit>,

    loads: Signal<Local, Bit>,
    at_zero: Signal<Local, Bit>,
    released: Signal<Local, Bits<16>>,
    settled: Signal<Local, Bits<16>>,
    applied: Signal<Local, Bits<16>>,
    less_one: Signal<Local, Bits<16>>,
    addend: Signal<Local, Bits<16>>,
    sum: Signal<Local, Bits<17>>,

    no_ticks: Constant<Bits<16>>,
    minus_one: Constant<Bits<16>>,
}

impl Default for Timer {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            counts: Signal::default(),
            clears: Signal::default(),
            load_release: Signal::default(),
            load_settle: Signal::default(),
            load_apply: Signal::default(),
            brake_release_ticks: Signal::default(),
            brake_apply_ticks: Signal::default(),
            settle_ticks: Signal::default(),
            elapsed: Signal::default(),
            left: Dff::default(),
            over: Dff::default(),
            loads: Signal::default(),
            at_zero: Signal::default(),
            released: Signal::default(),
            settled: Signal::default(),
            applied: Signal::default(),
            less_one: Signal::default(),
            addend: Signal::default(),
            sum: Signal::default(),
            no_ticks: Constant::new(from_u64(0)),
            minus_one: Constant::new(from_u64(0xffff)),
        }
    }
}

impl Logic for Timer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_timer");
        comment!("@about Ticks of brake and shaper.");
        dff_setup!(self, clk, left, over);
        self.loads.next = self.load_release.val() | self.load_settle.val() | self.load_apply.val();
        self.released.next = self.no_ticks.val();
        if self.load_release.val() {
            self.released.next = self.brake_release_ticks.val();
        }
        self.settled.next = self.no_ticks.val();
        if self.load_settle.val() {
            self.settled.next = self.settle_ticks.val();
        }
        self.applied.next = self.no_ticks.val();
        if self.load_apply.val() {
            self.applied.next = self.brake_apply_ticks.val();
        }
        self.less_one.next = self.minus_one.val();
        if self.loads.val() {
            self.less_one.next = self.no_ticks.val();
        }
        comment!("Less one has a carry unless there is none left");
        self.addend.next = self.released.val() | self.settled.val() | self.applied.val() | self.less_one.val();
        self.sum.next = bit_cast::<17, 16>(self.left.q.val()) + bit_cast::<17, 16>(self.addend.val());
        self.at_zero.next = !self.sum.val().get_bit(16);
        if self.loads.val() | (self.counts.val() & !self.at_zero.val()) {
            self.left.d.next = self.sum.val().get_bits::<16>(0);
        }
        if self.clears.val() {
            self.left.d.next = self.no_ticks.val();
        }
        self.over.d.next = self.at_zero.val() & !self.loads.val();
        self.elapsed.next = self.over.q.val() & !self.loads.val();
    }
}
