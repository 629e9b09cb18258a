//! The timer of brake and shaper, in ticks: loaded in the first clock of what begins, and over two clocks later at the
//! earliest.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Timer {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) counts: Signal<In, Bit>,
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

    no_ticks: Constant<Bits<16>>,
    one_tick: Constant<Bits<16>>,
}

impl Default for Timer {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            counts: Signal::default(),
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
            no_ticks: Constant::new(from_u64(0)),
            one_tick: Constant::new(from_u64(1)),
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
        self.at_zero.next = self.left.q.val() == self.no_ticks.val();
        if self.counts.val() & !self.at_zero.val() {
            self.left.d.next = self.left.q.val() - self.one_tick.val();
        }
        if self.load_release.val() {
            self.left.d.next = self.brake_release_ticks.val();
        }
        if self.load_settle.val() {
            self.left.d.next = self.settle_ticks.val();
        }
        if self.load_apply.val() {
            self.left.d.next = self.brake_apply_ticks.val();
        }
        self.over.d.next = self.at_zero.val() & !self.loads.val();
        self.elapsed.next = self.over.q.val() & !self.loads.val();
    }
}
