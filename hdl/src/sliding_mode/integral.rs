//! ∫e, Q24.8: the word that holds the sum of it and e, at `settle`; frozen while e would push a command further that is cut
//! already.
//!
//! `open` is the clock before the sum begins. A clear after it, before the word is taken, wins: that tick's e is not added.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Integral {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) clear_integral: Signal<In, Bit>,
    pub(super) open: Signal<In, Bit>,
    pub(super) enable: Signal<In, Bit>,
    pub(super) settle: Signal<In, Bit>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) falls: Signal<In, Bit>,
    pub(super) opposes: Signal<In, Bit>,
    pub(super) limited_high: Signal<In, Bit>,
    pub(super) limited_low: Signal<In, Bit>,
    pub(super) value: Signal<Out, Signed<32>>,
    pub(super) takes: Signal<Out, Bit>,

    integral_q: Dff<Signed<32>>,
    cleared: Dff<Bit>,

    lowers: Signal<Local, Bit>,
    grows: Signal<Local, Bit>,

    nothing: Constant<Signed<32>>,
}

impl Default for Integral {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            clear_integral: Signal::default(),
            open: Signal::default(),
            enable: Signal::default(),
            settle: Signal::default(),
            word: Signal::default(),
            falls: Signal::default(),
            opposes: Signal::default(),
            limited_high: Signal::default(),
            limited_low: Signal::default(),
            value: Signal::default(),
            takes: Signal::default(),
            integral_q: Dff::default(),
            cleared: Dff::default(),
            lowers: Signal::default(),
            grows: Signal::default(),
            nothing: Constant::new(from_i64(0)),
        }
    }
}

impl Logic for Integral {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integral");
        comment!("@about Integral of e, frozen against a limit.");
        dff_setup!(self, clk, integral_q, cleared);

        comment!("A clear wins over a sum under way");
        if self.clear_integral.val() {
            self.cleared.d.next = true;
        }
        if self.open.val() {
            self.cleared.d.next = false;
        }

        comment!("Frozen where e pushes against a limit");
        self.lowers.next = self.falls.val() ^ self.opposes.val();
        self.grows.next = self.enable.val() & !self.cleared.q.val() & !self.limited_high.val();
        if self.lowers.val() {
            self.grows.next = self.enable.val() & !self.cleared.q.val() & !self.limited_low.val();
        }
        if self.settle.val() & self.grows.val() {
            self.integral_q.d.next = self.word.val();
        }
        if self.clear_integral.val() {
            self.integral_q.d.next = self.nothing.val();
        }
        self.value.next = self.integral_q.q.val();
        self.takes.next = self.grows.val();
    }
}
