//! One filtered fault: synchroniser, then active once the line has been low for more than `filter_clocks`.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct FilteredFault {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) fault_n: Signal<In, Bit>,
    pub(super) filter_clocks: Signal<In, Bits<8>>,
    pub(super) active: Signal<Out, Bit>,

    synchroniser: Synchroniser,
    lasted: Dff<Bits<8>>,

    long: Signal<Local, Bit>,
}

impl Logic for FilteredFault {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module filtered_fault");
        comment!("@about Active when low for over filter_clocks.");
        dff_setup!(self, clk, lasted);
        self.synchroniser.clk.next = self.clk.val();
        self.synchroniser.rst.next = self.rst.val();
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
