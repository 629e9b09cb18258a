//! Ticks in a row against the ticks that are too many, nibble by nibble, lowest first.

use super::lasts::Lasts;
use crate::prelude::*;

/// A count of ticks that goes round as it is compared, and takes the tick in the first round.
#[derive(LogicBlock)]
pub(super) struct TickCount {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) turn: Signal<In, Bits<2>>,
    pub(super) compares: Signal<In, Bit>,
    /// Not while it goes round.
    pub(super) clears: Signal<In, Bit>,
    pub(super) limit: Signal<In, Bits<16>>,
    pub(super) lasts: Signal<Out, Bit>,

    against: Lasts,

    count: Dff<Bits<16>>,
    carry: Dff<Bits<1>>,
    endless: Dff<Bit>,

    nibble: Signal<Local, Bits<4>>,
    counted: Signal<Local, Bits<5>>,

    nothing: Constant<Bits<16>>,
    no_carry: Constant<Bits<1>>,
    one: Constant<Bits<1>>,
}

impl Default for TickCount {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            turn: Signal::default(),
            compares: Signal::default(),
            clears: Signal::default(),
            limit: Signal::default(),
            lasts: Signal::default(),
            against: Lasts::default(),
            count: Dff::default(),
            carry: Dff::default(),
            endless: Dff::default(),
            nibble: Signal::default(),
            counted: Signal::default(),
            nothing: Constant::new(from_u64(0)),
            no_carry: Constant::new(from_u64(0)),
            one: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for TickCount {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_tick_count");
        comment!("@about Counts ticks, and whether they are many.");
        dff_setup!(self, clk, count, carry, endless);
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
        comment!("A carry out of the highest: more than any limit");
        self.endless.d.next = self.endless.q.val() | (self.carry.q.val().any() & !self.compares.val());
        if self.clears.val() {
            self.count.d.next = self.nothing.val();
            self.endless.d.next = false;
        }
        self.against.clk.next = self.clk.val();
        self.against.rst.next = self.rst.val();
        self.against.turn.next = self.turn.val();
        self.against.compares.next = self.compares.val();
        self.against.ticks.next = self.nibble.val();
        self.against.endless.next = self.endless.q.val();
        self.against.limit.next = self.limit.val();
        self.lasts.next = self.against.lasts.val();
    }
}
