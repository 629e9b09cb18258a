//! The operand of the average: an entry, the whole error, or 0.
//!
//! It is a module of its own, since one process that chooses it and another that uses it would look like a loop to simulators.

use crate::prelude::*;

kernel! {
    pub(super) struct Operand;

    inputs { entry: Signed<18>, takes_entry: Bit, whole: Signed<18>, takes_whole: Bit }
    outputs { operand: Signed<18> }
    constants { none: Signed<18> = from_i64(0) }
}

impl Logic for Operand {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module error_operand");

        self.operand.next = self.none.val();
        if self.takes_entry.val() {
            self.operand.next = self.entry.val();
        }
        if self.takes_whole.val() {
            self.operand.next = self.whole.val();
        }
    }
}
