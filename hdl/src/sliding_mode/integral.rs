//! The integral ∫e, Q24.8: at `settle` it takes the sum of itself and e; it is frozen while e would push a clamped
//! command further.
//!
//! `open` is the clock before the sum begins. A clear after it, before the sum is taken, wins: that tick's e is not
//! added.

use crate::prelude::*;

kernel! {
    pub(super) struct Integral;

    inputs {
        rst: Bit,
        clear_integral: Bit,
        open: Bit,
        enable: Bit,
        settle: Bit,
        word: Signed<32>,
        falls: Bit,
        opposes: Bit,
        limited_high: Bit,
        limited_low: Bit,
    }
    outputs { value: Signed<32>, takes: Bit }
    registers { integral_q: Signed<32>, cleared: Bit }
    wires { lowers: Bit, grows: Bit }
    constants { nothing: Signed<32> = from_i64(0) }
}

impl Logic for Integral {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integral");

        comment!("A clear wins over a sum being computed");
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
