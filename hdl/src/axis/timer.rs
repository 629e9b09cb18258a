//! The timer of brake and shaper, in ticks: loaded a clock after what begins, and over two clocks after that at the earliest.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Timer {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) counts: Signal<In, Bit>,
    pub(super) starts_release: Signal<In, Bit>,
    pub(super) starts_settle: Signal<In, Bit>,
    pub(super) starts_apply: Signal<In, Bit>,
    pub(super) brake_release_ticks: Signal<In, Bits<16>>,
    pub(super) brake_apply_ticks: Signal<In, Bits<16>>,
    pub(super) settle_ticks: Signal<In, Bits<16>>,
    pub(super) elapsed: Signal<Out, Bit>,

    left: Dff<Bits<16>>,
    over: Dff<Bit>,
    load_release: Dff<Bit>,
    load_settle: Dff<Bit>,
    load_apply: Dff<Bit>,

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
            starts_release: Signal::default(),
            starts_settle: Signal::default(),
            starts_apply: Signal::default(),
            brake_release_ticks: Signal::default(),
            brake_apply_ticks: Signal::default(),
            settle_ticks: Signal::default(),
            elapsed: Signal::default(),
            left: Dff::default(),
            over: Dff::default(),
            load_release: Dff::default(),
            load_settle: Dff::default(),
            load_apply: Dff::default(),
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
        dff_setup!(self, clk, left, over, load_release, load_settle, load_apply);
        self.load_release.d.next = self.starts_release.val();
        self.load_settle.d.next = self.starts_settle.val();
        self.load_apply.d.next = self.starts_apply.val();
        self.loads.next = self.load_release.q.val() | self.load_settle.q.val() | self.load_apply.q.val();
        self.at_zero.next = self.left.q.val() == self.no_ticks.val();
        if self.counts.val() & !self.at_zero.val() {
            self.left.d.next = self.left.q.val() - self.one_tick.val();
        }
        if self.load_release.q.val() {
            self.left.d.next = self.brake_release_ticks.val();
        }
        if self.load_settle.q.val() {
            self.left.d.next = self.settle_ticks.val();
        }
        if self.load_apply.q.val() {
            self.left.d.next = self.brake_apply_ticks.val();
        }
        self.over.d.next = self.at_zero.val() & !self.loads.val();
        self.elapsed.next = self.over.q.val() & !self.loads.val();
    }
}
