//! Ticks in a row against the ticks that are too many, nibble by nibble, lowest first.

use super::bytes::Nibbles;
use crate::prelude::*;

/// Has it lasted for as many ticks as the limit says? Never with a limit of 0. Known as long as nothing `compares`.
#[derive(LogicBlock, Default)]
pub(super) struct Lasts {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) turn: Signal<In, Bits<2>>,
    pub(super) compares: Signal<In, Bit>,
    /// A nibble of the ticks.
    pub(super) ticks: Signal<In, Bits<4>>,
    /// More than any limit.
    pub(super) endless: Signal<In, Bit>,
    pub(super) limit: Signal<In, Bits<16>>,
    pub(super) lasts: Signal<Out, Bit>,

    limit_nibbles: Nibbles,

    fewer: Dff<Bit>,
    limited: Dff<Bit>,

    under: Signal<Local, Bits<4>>,
    not_over: Signal<Local, Bits<4>>,
    under_0: Signal<Local, Bit>,
    under_1: Signal<Local, Bit>,
    under_2: Signal<Local, Bit>,
    under_3: Signal<Local, Bit>,
}

impl Logic for Lasts {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_lasts");
        comment!("@about Ticks against too many of them.");
        dff_setup!(self, clk, fewer, limited);
        self.limit_nibbles.clk.next = self.clk.val();
        self.limit_nibbles.rst.next = self.rst.val();
        self.limit_nibbles.turn.next = self.turn.val();
        self.limit_nibbles.word.next = self.limit.val();
        comment!("A bit that is less, one that is not more");
        self.under.next = !self.ticks.val() & self.limit_nibbles.part.val();
        self.not_over.next = !self.ticks.val() | self.limit_nibbles.part.val();
        self.under_0.next = self.under.val().get_bit(0) | (self.not_over.val().get_bit(0) & self.fewer.q.val());
        self.under_1.next = self.under.val().get_bit(1) | (self.not_over.val().get_bit(1) & self.under_0.val());
        self.under_2.next = self.under.val().get_bit(2) | (self.not_over.val().get_bit(2) & self.under_1.val());
        self.under_3.next = self.under.val().get_bit(3) | (self.not_over.val().get_bit(3) & self.under_2.val());
        self.fewer.d.next = self.under_3.val();
        self.limited.d.next = self.limited.q.val() | self.limit_nibbles.part.val().any();
        if !self.compares.val() {
            self.fewer.d.next = false;
            self.limited.d.next = false;
        }
        self.lasts.next = self.limited.q.val() & (!self.fewer.q.val() | self.endless.val());
    }
}

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
