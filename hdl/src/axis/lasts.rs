//! Compares a number of ticks with its limit, nibble by nibble, lowest first.

use super::nibbles::Nibbles;
use crate::prelude::*;

kernel! {
    /// The number of ticks has reached the limit; a limit of 0 is never reached. The timing is that of `Larger`.
    pub(super) struct Lasts;

    inputs {
        rst: Bit,
        turn: Bits<2>,
        compares: Bit,
        /// A nibble of the number of ticks.
        ticks: Bits<4>,
        /// The number of ticks exceeds any limit.
        endless: Bit,
        limit: Bits<16>,
    }
    outputs { lasts: Bit }
    parts { limit_nibbles: Nibbles }
    registers { fewer: Bit, limited: Bit }
    wires { under: Bits<4>, not_over: Bits<4>, under_0: Bit, under_1: Bit, under_2: Bit, under_3: Bit }
    connect {
        limit_nibbles: turn;
    }
}

impl Logic for Lasts {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_lasts");
        self.limit_nibbles.word.next = self.limit.val();
        comment!("Bits that are smaller, and bits not larger");
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
