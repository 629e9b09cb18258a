//! One filtered fault: a synchroniser, then a filter; the fault is active once the line has been low for more than
//! `filter_clocks`.

use crate::prelude::*;

kernel! {
    pub(super) struct FilteredFault;

    inputs { rst: Bit, fault_n: Bit, filter_clocks: Bits<8> }
    outputs { active: Bit }
    parts { synchroniser: Synchroniser }
    registers { lasted: Bits<8> }
    wires { long: Bit }
}

impl Logic for FilteredFault {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module filtered_fault");
        self.synchroniser.pin.next = !self.fault_n.val();
        self.long.next = self.lasted.q.val() >= self.filter_clocks.val();
        if !self.long.val() {
            self.lasted.d.next = self.lasted.q.val() + 1;
        }
        if !self.synchroniser.level.val() {
            self.lasted.d.next = 0.into();
        }
        self.active.next = self.synchroniser.level.val() & self.long.val();
    }
}
