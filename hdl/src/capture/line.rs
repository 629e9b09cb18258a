//! The line: a synchroniser, and a filter that knows no level until the line has been quiet once.
//!
//! `changed` is high in the first clock of a new `level`.

use crate::prelude::*;

kernel! {
    pub(super) struct CaptureLine;

    inputs { rst: Bit, line: Bit, filter_clocks: Bits<16> }
    outputs { level: Bit, level_known: Bit, changed: Bit }
    parts { pin: Synchroniser }
    registers { primed: Bits<2>, last: Bit, lasted: Bits<16>, level_q: Bit, known: Bit, changed_q: Bit }
    wires { now: Bit, is_new: Bit, lasts: Bits<16>, settles: Bit }
    constants {
        first_clock: Bits<2> = from_u64(1),
        no_clock: Bits<16> = from_u64(0),
        one_clock: Bits<16> = from_u64(1),
    }
}

impl Logic for CaptureLine {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module capture_line");

        comment!("For two clocks the line is still that of the reset");
        self.pin.pin.next = self.line.val();
        self.now.next = self.pin.level.val();
        self.last.d.next = self.now.val();
        self.primed.d.next = (self.primed.q.val() << 1) | self.first_clock.val();

        comment!("Clocks with the new level; until one is known, with");
        comment!("any. 1 at the least, so that a filter of 0 is one of 1");
        self.is_new.next =
            self.primed.q.val().get_bit(1) & !(self.known.q.val() & (self.now.val() == self.level_q.q.val()));
        self.lasts.next = self.one_clock.val();
        if self.known.q.val() | (self.now.val() == self.last.q.val()) {
            self.lasts.next = self.lasted.q.val() + self.one_clock.val();
        }
        self.settles.next = false;
        if self.is_new.val() {
            self.settles.next = self.lasts.val() >= self.filter_clocks.val();
        }
        self.lasted.d.next = self.no_clock.val();
        if self.is_new.val() & !self.settles.val() {
            self.lasted.d.next = self.lasts.val();
        }

        comment!("The first level is no edge");
        self.changed_q.d.next = self.settles.val() & self.known.q.val();
        if self.settles.val() {
            self.level_q.d.next = self.now.val();
            self.known.d.next = true;
        }
        self.level.next = self.level_q.q.val();
        self.level_known.next = self.known.q.val();
        self.changed.next = self.changed_q.q.val();
    }
}
