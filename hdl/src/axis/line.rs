//! One line: a synchroniser, then a filter.

use crate::prelude::*;
use crate::pulse_counter::GlitchFilter;

kernel! {
    pub(crate) struct Line;

    inputs { rst: Bit, pin: Bit, ready: Bit, filter_clocks: Bits<6> }
    outputs { level: Bit }
    parts { synchroniser: Synchroniser, filter: GlitchFilter }
    connect {
        synchroniser: pin;
        filter: ready, filter_clocks;
        outputs from filter: level;
    }
}

impl Logic for Line {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module single_line");
        self.filter.input_level.next = self.synchroniser.level.val();
    }
}
