//! One line: a synchroniser, then a filter.

use crate::prelude::*;
use crate::pulse_counter::GlitchFilter;

kernel! {
    pub(super) struct Line;

    inputs { rst: Bit, pin: Bit, ready: Bit, filter_clocks: Bits<6> }
    outputs { level: Bit }
    parts { synchroniser: Synchroniser, filter: GlitchFilter }
}

impl Logic for Line {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module single_line");
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
