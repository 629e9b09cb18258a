//! The word that is kept through a pass, de and then a; the command: a sum cut to ±limit, six clocks after `take`; and, at
//! `count`, for how many ticks in a row it has been cut.
//!
//! ```text
//! clock    0         1        2         3          4         5
//! take    ‾‾\______________________________________________________
//! held     sum       if negative,       compared   0 if cut  ±limit   command
//!                    its complement                          if cut
//! ```
//!
//! A negative sum `x` is below −limit if its complement `−x − 1` is not below limit: one comparison serves both sides.
//!
//! One subtraction, `held − limit`, does all. The complement is `−(x − limit) − 1 − limit`: it needs no choice in front of
//! the chain; and from 0 it makes the limit with either sign. `limit`, `cut` and `negative` hold still meanwhile.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Limiter {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) keep: Signal<In, Bit>,
    pub(super) take: Signal<In, Bit>,
    pub(super) count: Signal<In, Bit>,
    pub(super) limit: Signal<In, Bits<31>>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) cut: Signal<In, Bit>,
    pub(super) negative: Signal<In, Bit>,
    pub(super) held: Signal<Out, Signed<32>>,
    pub(super) command: Signal<Out, Signed<32>>,
    pub(super) limited_high: Signal<Out, Bit>,
    pub(super) limited_low: Signal<Out, Bit>,
    pub(super) limited_ticks: Signal<Out, Bits<16>>,

    inverted: Dff<Bit>,
    compares: Dff<Bit>,
    returns: Dff<Bit>,
    cuts: Dff<Bit>,
    decides: Dff<Bit>,
    held_q: Dff<Signed<32>>,
    over: Dff<Bit>,
    command_q: Dff<Signed<32>>,
    high_q: Dff<Bit>,
    low_q: Dff<Bit>,
    ticks: Dff<Bits<16>>,

    minuend: Signal<Local, Bits<32>>,
    borrow: Signal<Local, Bits<33>>,
    margin: Signal<Local, Bits<33>>,
    inverts: Signal<Local, Bits<32>>,
    part: Signal<Local, Bits<32>>,
    works: Signal<Local, Bit>,

    no_borrow: Constant<Bits<33>>,
    one_borrow: Constant<Bits<33>>,
    none: Constant<Bits<32>>,
    nothing: Constant<Signed<32>>,
    no_ticks: Constant<Bits<16>>,
    one_tick: Constant<Bits<16>>,
}

impl Default for Limiter {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            keep: Signal::default(),
            take: Signal::default(),
            count: Signal::default(),
            limit: Signal::default(),
            word: Signal::default(),
            cut: Signal::default(),
            negative: Signal::default(),
            held: Signal::default(),
            command: Signal::default(),
            limited_high: Signal::default(),
            limited_low: Signal::default(),
            limited_ticks: Signal::default(),
            inverted: Dff::default(),
            compares: Dff::default(),
            returns: Dff::default(),
            cuts: Dff::default(),
            decides: Dff::default(),
            held_q: Dff::default(),
            over: Dff::default(),
            command_q: Dff::default(),
            high_q: Dff::default(),
            low_q: Dff::default(),
            ticks: Dff::default(),
            minuend: Signal::default(),
            borrow: Signal::default(),
            margin: Signal::default(),
            inverts: Signal::default(),
            part: Signal::default(),
            works: Signal::default(),
            no_borrow: Constant::new(from_u64(0)),
            one_borrow: Constant::new(from_u64(1)),
            none: Constant::new(from_u64(0)),
            nothing: Constant::new(from_i64(0)),
            no_ticks: Constant::new(from_u64(0)),
            one_tick: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for Limiter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module limiter");
        comment!("@about The command, and for how long it is cut.");
        dff_setup!(
            self, clk, inverted, compares, returns, cuts, decides, held_q, over, command_q, high_q, low_q, ticks
        );

        comment!("held - limit, less one for a positive word");
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

        comment!("Its turns, one a clock");
        self.inverted.d.next = self.take.val();
        self.compares.d.next = self.inverted.q.val();
        self.returns.d.next = self.compares.q.val();
        self.cuts.d.next = self.returns.q.val();
        self.decides.d.next = self.cuts.q.val();

        comment!("Twice less the limit, once inverted: its size");
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

        comment!("Ticks in a row");
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
