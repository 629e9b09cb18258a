//! Counts consecutive ticks and compares them with a limit, nibble by nibble, lowest first.

use super::lasts::Lasts;
use crate::prelude::*;

kernel! {
    /// The count rotates by a nibble per clock while it is compared; the first round adds the tick.
    pub(super) struct TickCount;

    inputs {
        rst: Bit,
        tick: Bit,
        turn: Bits<2>,
        compares: Bit,
        /// Clears the count; must be low while the count rotates.
        clears: Bit,
        limit: Bits<16>,
    }
    outputs { lasts: Bit }
    parts { against: Lasts }
    registers { count: Bits<16>, carry: Bits<1>, endless: Bit }
    wires { nibble: Bits<4>, counted: Bits<5> }
    constants { nothing: Bits<16> = from_u64(0), no_carry: Bits<1> = from_u64(0), one: Bits<1> = from_u64(1) }
    connect {
        against: turn, compares, limit;
        outputs from against: lasts;
    }
}

impl Logic for TickCount {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_tick_count");
        self.nibble.next = self.count.q.val().get_bits::<4>(0);
        self.counted.next = bit_cast::<5, 4>(self.nibble.val()) + bit_cast::<5, 1>(self.carry.q.val());
        self.carry.d.next = self.no_carry.val();
        if self.compares.val() {
            self.count.d.next =
                (bit_cast::<16, 4>(self.counted.val().get_bits::<4>(0)) << 12) | (self.count.q.val() >> 4);
            self.carry.d.next = self.counted.val().get_bits::<1>(4);
        }
        if self.tick.val() {
            self.carry.d.next = self.one.val();
        }
        comment!("A carry out of the top: more than any limit");
        self.endless.d.next = self.endless.q.val() | (self.carry.q.val().any() & !self.compares.val());
        if self.clears.val() {
            self.count.d.next = self.nothing.val();
            self.endless.d.next = false;
        }
        self.against.ticks.next = self.nibble.val();
        self.against.endless.next = self.endless.q.val();
    }
}
