//! Was any byte of a word other than 0?

use crate::prelude::*;

/// As `Larger`.
#[derive(LogicBlock, Default)]
pub(super) struct Nonzero {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) compares: Signal<In, Bit>,
    pub(super) part: Signal<In, Bits<8>>,
    pub(super) nonzero: Signal<Out, Bit>,

    nonzero_q: Dff<Bit>,
}

impl Logic for Nonzero {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_nonzero");
        comment!("@about Is any byte other than 0?");
        dff_setup!(self, clk, nonzero_q);
        self.nonzero_q.d.next = self.nonzero_q.q.val() | self.part.val().any();
        if !self.compares.val() {
            self.nonzero_q.d.next = false;
        }
        self.nonzero.next = self.nonzero_q.q.val();
    }
}
