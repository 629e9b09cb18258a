//! Levels of this clock and of the one before to steps: quadrature ×4 ×2 ×1, step and direction, up and down.
//!
//! ×2 counts the edges of A, ×1 those while B is low: so the count is the same on the way there and on the way back.
//! With one edge, A against B a clock before is the opposite of B against A: exchanging the lines turns the direction over.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Decoder {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) level_a: Signal<In, Bit>,
    pub(super) level_b: Signal<In, Bit>,
    pub(super) swap: Signal<In, Bit>,
    pub(super) invert: Signal<In, Bit>,
    pub(super) ready: Signal<In, Bit>,
    pub(super) mode: Signal<In, Bits<3>>,
    pub(super) step: Signal<Out, Bit>,
    pub(super) up: Signal<Out, Bit>,
    pub(super) illegal: Signal<Out, Bit>,

    a_before: Dff<Bit>,
    b_before: Dff<Bit>,

    kept: Signal<Local, Bit>,
    a: Signal<Local, Bit>,
    b: Signal<Local, Bit>,
    was_a: Signal<Local, Bit>,
    was_b: Signal<Local, Bit>,
    edge_a: Signal<Local, Bit>,
    edge_b: Signal<Local, Bit>,
    rise_a: Signal<Local, Bit>,
    rise_b: Signal<Local, Bit>,
    counts: Signal<Local, Bit>,
    upward: Signal<Local, Bit>,
    both: Signal<Local, Bit>,

    times_4: Constant<Bits<3>>,
    times_2: Constant<Bits<3>>,
    times_1: Constant<Bits<3>>,
    step_direction: Constant<Bits<3>>,
    up_down: Constant<Bits<3>>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            level_a: Signal::default(),
            level_b: Signal::default(),
            swap: Signal::default(),
            invert: Signal::default(),
            ready: Signal::default(),
            mode: Signal::default(),
            step: Signal::default(),
            up: Signal::default(),
            illegal: Signal::default(),
            a_before: Dff::default(),
            b_before: Dff::default(),
            kept: Signal::default(),
            a: Signal::default(),
            b: Signal::default(),
            was_a: Signal::default(),
            was_b: Signal::default(),
            edge_a: Signal::default(),
            edge_b: Signal::default(),
            rise_a: Signal::default(),
            rise_b: Signal::default(),
            counts: Signal::default(),
            upward: Signal::default(),
            both: Signal::default(),
            times_4: Constant::new(from_u64(0)),
            times_2: Constant::new(from_u64(1)),
            times_1: Constant::new(from_u64(2)),
            step_direction: Constant::new(from_u64(3)),
            up_down: Constant::new(from_u64(4)),
        }
    }
}

impl Logic for Decoder {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module decoder");
        comment!("@about Filtered levels to steps up and down.");
        dff_setup!(self, clk, a_before, b_before);
        self.a_before.d.next = self.level_a.val();
        self.b_before.d.next = self.level_b.val();

        comment!("A and B, exchanged or not");
        self.kept.next = !self.swap.val();
        self.a.next = (self.level_a.val() & self.kept.val()) | (self.level_b.val() & self.swap.val());
        self.b.next = (self.level_b.val() & self.kept.val()) | (self.level_a.val() & self.swap.val());
        self.was_a.next = (self.a_before.q.val() & self.kept.val()) | (self.b_before.q.val() & self.swap.val());
        self.was_b.next = (self.b_before.q.val() & self.kept.val()) | (self.a_before.q.val() & self.swap.val());
        self.edge_a.next = self.a.val() ^ self.was_a.val();
        self.edge_b.next = self.b.val() ^ self.was_b.val();
        self.rise_a.next = self.a.val() & self.edge_a.val();
        self.rise_b.next = self.b.val() & self.edge_b.val();

        comment!("Quadrature: up if A leads B");
        self.counts.next = false;
        self.upward.next = self.level_a.val() ^ self.b_before.q.val() ^ self.swap.val();
        self.both.next = self.edge_a.val() & self.edge_b.val();
        if self.mode.val() == self.times_4.val() {
            self.counts.next = self.edge_a.val() ^ self.edge_b.val();
        }
        if self.mode.val() == self.times_2.val() {
            self.counts.next = self.edge_a.val() & !self.edge_b.val();
        }
        if self.mode.val() == self.times_1.val() {
            self.counts.next = self.edge_a.val() & !self.edge_b.val() & !self.b.val();
        }

        comment!("Step and direction, up and down");
        if self.mode.val() == self.step_direction.val() {
            self.counts.next = self.rise_a.val();
            self.upward.next = self.b.val();
        }
        if self.mode.val() == self.up_down.val() {
            self.counts.next = self.rise_a.val() ^ self.rise_b.val();
            self.upward.next = self.rise_a.val();
        }
        if self.mode.val() > self.times_1.val() {
            self.both.next = false;
        }
        self.step.next = self.counts.val() & self.ready.val();
        self.up.next = self.upward.val() ^ self.invert.val();
        self.illegal.next = self.both.val() & self.ready.val();
    }
}
