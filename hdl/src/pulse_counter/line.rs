//! One line: pin and complement with a synchroniser each, then the filter. While the two lines of a pair are equal,
//! which is invalid, the level stays.

use super::glitch_filter::GlitchFilter;
use crate::prelude::*;

kernel! {
    pub(super) struct Line;

    inputs { rst: Bit, pin: Bit, complement: Bit, differential: Bit, ready: Bit, filter_clocks: Bits<6> }
    outputs { level: Bit, disagrees: Bit }
    parts { pin_synchroniser: Synchroniser, complement_synchroniser: Synchroniser, filter: GlitchFilter }
    wires { equal: Bit, says: Bit }
    connect {
        pin_synchroniser: pin;
        filter: ready, filter_clocks;
    }
}

impl Logic for Line {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module line_receiver");
        self.complement_synchroniser.pin.next = self.complement.val();
        self.equal.next =
            self.differential.val() & (self.pin_synchroniser.level.val() == self.complement_synchroniser.level.val());
        self.says.next = self.pin_synchroniser.level.val();
        if self.equal.val() {
            self.says.next = self.filter.level.val();
        }
        self.filter.input_level.next = self.says.val();
        self.level.next = self.filter.level.val();
        self.disagrees.next = self.equal.val();
    }
}
