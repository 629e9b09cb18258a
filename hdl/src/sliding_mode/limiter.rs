//! Holds the word that is kept during a computation, de and then a; clamps the command, a sum, to ±limit, six clocks
//! after `take`; and at `count` counts the consecutive ticks with a clamped command.
//!
//! ```text
//! clock    0         1        2         3          4         5
//! take    ‾‾\______________________________________________________
//! held     sum       if negative,       compared   0 if cut  ±limit   command
//!                    its complement                          if cut
//! ```
//!
//! A negative sum `x` is below −limit if its complement `−x − 1` is not below limit, so one comparison serves both
//! signs.
//!
//! One subtraction, `held − limit`, is enough. The complement is `−(x − limit) − 1 − limit`, which needs no selection
//! in front of the carry chain; starting from 0 it gives the limit with either sign. `limit`, `cut` and `negative` do
//! not change meanwhile.

use crate::prelude::*;

kernel! {
    pub(super) struct Limiter;

    inputs {
        rst: Bit,
        keep: Bit,
        take: Bit,
        count: Bit,
        limit: Bits<31>,
        word: Signed<32>,
        cut: Bit,
        negative: Bit,
    }
    outputs { held: Signed<32>, command: Signed<32>, limited_high: Bit, limited_low: Bit, limited_ticks: Bits<16> }
    registers {
        inverted: Bit, compares: Bit, returns: Bit, cuts: Bit, decides: Bit, held_q: Signed<32>, over: Bit,
        command_q: Signed<32>, high_q: Bit, low_q: Bit, ticks: Bits<16>,
    }
    wires {
        minuend: Bits<32>, borrow: Bits<33>, margin: Bits<33>, inverts: Bits<32>, part: Bits<32>, works: Bit,
    }
    constants {
        no_borrow: Bits<33> = from_u64(0),
        one_borrow: Bits<33> = from_u64(1),
        none: Bits<32> = from_u64(0),
        nothing: Signed<32> = from_i64(0),
        no_ticks: Bits<16> = from_u64(0),
        one_tick: Bits<16> = from_u64(1),
    }
}

impl Logic for Limiter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module limiter");

        comment!("held - limit, minus one for a positive word");
        self.minuend.next = unsigned_cast(self.held_q.q.val());
        self.borrow.next = self.no_borrow.val();
        if !self.negative.val() {
            self.borrow.next = self.one_borrow.val();
        }
        self.margin.next = (bit_cast::<33, 32>(self.minuend.val()) << 1)
            - ((bit_cast::<33, 31>(self.limit.val()) << 1) | self.borrow.val());
        self.inverts.next = self.none.val();
        if self.take.val() | !self.negative.val() {
            self.inverts.next = !self.none.val();
        }
        self.part.next = self.margin.val().get_bits::<32>(1) ^ self.inverts.val();

        comment!("Steps of the limiter, one per clock");
        self.inverted.d.next = self.take.val();
        self.compares.d.next = self.inverted.q.val();
        self.returns.d.next = self.compares.q.val();
        self.cuts.d.next = self.returns.q.val();
        self.decides.d.next = self.cuts.q.val();

        comment!("Negative x: inverted x - limit, minus limit: -x - 1");
        self.works.next = self.cuts.q.val() & self.over.q.val();
        if (self.take.val() | self.inverted.q.val()) & self.negative.val() {
            self.works.next = true;
        }
        if self.works.val() {
            self.held_q.d.next = signed_cast(self.part.val());
        }
        if self.keep.val() | self.returns.q.val() {
            self.held_q.d.next = self.word.val();
        }
        if self.compares.q.val() {
            self.over.d.next = self.cut.val() | !self.margin.val().get_bit(32);
        }
        if self.returns.q.val() & self.over.q.val() {
            self.held_q.d.next = self.nothing.val();
        }
        if self.decides.q.val() {
            self.command_q.d.next = self.held_q.q.val();
            self.high_q.d.next = self.over.q.val() & !self.negative.val();
            self.low_q.d.next = self.over.q.val() & self.negative.val();
        }

        comment!("Consecutive ticks with a clamped command");
        if self.count.val() & !self.ticks.q.val().all() {
            self.ticks.d.next = self.ticks.q.val() + self.one_tick.val();
        }
        if self.count.val() & !self.high_q.q.val() & !self.low_q.q.val() {
            self.ticks.d.next = self.no_ticks.val();
        }

        self.held.next = self.held_q.q.val();
        self.command.next = self.command_q.q.val();
        self.limited_high.next = self.high_q.q.val();
        self.limited_low.next = self.low_q.q.val();
        self.limited_ticks.next = self.ticks.q.val();
    }
}
