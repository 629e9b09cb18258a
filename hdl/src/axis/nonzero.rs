//! Detects whether any byte of a word is not 0.

use crate::prelude::*;

kernel! {
    /// Valid after the last byte, with the same timing as `Larger`.
    pub(super) struct Nonzero;

    inputs { rst: Bit, compares: Bit, part: Bits<8> }
    outputs { nonzero: Bit }
    registers { nonzero_q: Bit }
}

impl Logic for Nonzero {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_nonzero");
        self.nonzero_q.d.next = self.nonzero_q.q.val() | self.part.val().any();
        if !self.compares.val() {
            self.nonzero_q.d.next = false;
        }
        self.nonzero.next = self.nonzero_q.q.val();
    }
}
