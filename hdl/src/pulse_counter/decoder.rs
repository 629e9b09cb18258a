//! Decodes the levels of this clock and of the one before into steps: quadrature ×4 ×2 ×1, step and direction, up and
//! down.
//!
//! ×2 counts the edges of A, ×1 those while B is low, so that the count is the same in both directions. With one
//! edge, A compared with B a clock before is the opposite of B compared with A: exchanging the lines reverses the
//! direction.

use crate::prelude::*;

kernel! {
    pub(super) struct Decoder;

    inputs { rst: Bit, level_a: Bit, level_b: Bit, swap: Bit, invert: Bit, ready: Bit, mode: Bits<3> }
    outputs { step: Bit, up: Bit, illegal: Bit }
    registers { a_before: Bit, b_before: Bit }
    wires {
        kept: Bit, a: Bit, b: Bit, was_a: Bit, was_b: Bit, edge_a: Bit, edge_b: Bit, rise_a: Bit, rise_b: Bit,
        counts: Bit, upward: Bit, both: Bit,
    }
    constants {
        times_4: Bits<3> = from_u64(0),
        times_2: Bits<3> = from_u64(1),
        times_1: Bits<3> = from_u64(2),
        step_direction: Bits<3> = from_u64(3),
        up_down: Bits<3> = from_u64(4),
    }
}

impl Logic for Decoder {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module decoder");
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
