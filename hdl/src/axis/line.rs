//! One line: synchroniser, then filter.

use crate::prelude::*;
use crate::pulse_counter::GlitchFilter;

#[derive(LogicBlock, Default)]
pub(super) struct Line {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) pin: Signal<In, Bit>,
    pub(super) ready: Signal<In, Bit>,
    pub(super) filter_clocks: Signal<In, Bits<6>>,
    pub(super) level: Signal<Out, Bit>,

    synchroniser: Synchroniser,
    filter: GlitchFilter,
}

impl Logic for Line {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module single_line");
        comment!("@about Synchroniser and filter of one line.");
        self.synchroniser.clk.next = self.clk.val();
        self.synchroniser.rst.next = self.rst.val();
        self.synchroniser.pin.next = self.pin.val();
        self.filter.clk.next = self.clk.val();
        self.filter.rst.next = self.rst.val();
        self.filter.input_level.next = self.synchroniser.level.val();
        self.filter.ready.next = self.ready.val();
        self.filter.filter_clocks.next = self.filter_clocks.val();
        self.level.next = self.filter.level.val();
    }
}
