//! The command: the sum cut to ±limit, two clocks after `take`; and, at `count`, for how many ticks in a row it has been cut.
//!
//! ```text
//! clock    0           1           2          3
//! take    ‾‾\__________________________________
//!         sum, limit  compared    added      command
//! decides _______________________/‾‾‾‾‾‾‾‾‾‾\__    high, low
//! ```
//!
//! A negative sum `x` is below −limit if its complement `−x − 1` is not below limit: one comparison serves both sides.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Limiter {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) take: Signal<In, Bit>,
    pub(super) count: Signal<In, Bit>,
    pub(super) limit: Signal<In, Bits<31>>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) word_high: Signal<In, Bit>,
    pub(super) word_low: Signal<In, Bit>,
    pub(super) command: Signal<Out, Signed<32>>,
    pub(super) limited_high: Signal<Out, Bit>,
    pub(super) limited_low: Signal<Out, Bit>,
    pub(super) limited_ticks: Signal<Out, Bits<16>>,
    pub(super) decides: Signal<Out, Bit>,
    pub(super) high: Signal<Out, Bit>,
    pub(super) low: Signal<Out, Bit>,

    compares_q: Dff<Bit>,
    decides_q: Dff<Bit>,
    limit_q: Dff<Bits<31>>,
    size: Dff<Bits<32>>,
    negative: Dff<Bit>,
    beyond: Dff<Bit>,
    cut: Dff<Bit>,
    command_q: Dff<Signed<32>>,
    high_q: Dff<Bit>,
    low_q: Dff<Bit>,
    ticks: Dff<Bits<16>>,

    taken: Signal<Local, Bits<32>>,
    taken_sign: Signal<Local, Bits<32>>,
    borrow: Signal<Local, Bits<33>>,
    margin: Signal<Local, Bits<33>>,
    kept: Signal<Local, Bits<32>>,
    sign: Signal<Local, Bits<32>>,
    carry: Signal<Local, Bits<32>>,

    zero: Constant<Bits<32>>,
    one: Constant<Bits<32>>,
    no_borrow: Constant<Bits<33>>,
    one_borrow: Constant<Bits<33>>,
    no_ticks: Constant<Bits<16>>,
    one_tick: Constant<Bits<16>>,
}

impl Default for Limiter {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            take: Signal::default(),
            count: Signal::default(),
            limit: Signal::default(),
            word: Signal::default(),
            word_high: Signal::default(),
            word_low: Signal::default(),
            command: Signal::default(),
            limited_high: Signal::default(),
            limited_low: Signal::default(),
            limited_ticks: Signal::default(),
            decides: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            compares_q: Dff::default(),
            decides_q: Dff::default(),
            limit_q: Dff::default(),
            size: Dff::default(),
            negative: Dff::default(),
            beyond: Dff::default(),
            cut: Dff::default(),
            command_q: Dff::default(),
            high_q: Dff::default(),
            low_q: Dff::default(),
            ticks: Dff::default(),
            taken: Signal::default(),
            taken_sign: Signal::default(),
            borrow: Signal::default(),
            margin: Signal::default(),
            kept: Signal::default(),
            sign: Signal::default(),
            carry: Signal::default(),
            zero: Constant::new(from_u64(0)),
            one: Constant::new(from_u64(1)),
            no_borrow: Constant::new(from_u64(0)),
            one_borrow: Constant::new(from_u64(1)),
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
            self, clk, compares_q, decides_q, limit_q, size, negative, beyond, cut, command_q, high_q, low_q, ticks
        );

        comment!("Its size, less an LSB if negative, and the limit");
        self.taken.next = unsigned_cast(self.word.val());
        self.taken_sign.next = self.zero.val();
        if self.word.val().get_bit(31) {
            self.taken_sign.next = !self.zero.val();
        }
        self.compares_q.d.next = self.take.val();
        if self.take.val() {
            self.limit_q.d.next = self.limit.val();
            self.size.d.next = self.taken.val() ^ self.taken_sign.val();
            self.negative.d.next = self.word.val().get_bit(31);
            self.beyond.d.next = self.word_high.val() | self.word_low.val();
        }

        comment!("One on the other");
        self.borrow.next = self.no_borrow.val();
        if self.negative.q.val() {
            self.borrow.next = self.one_borrow.val();
        }
        self.margin.next = (bit_cast::<33, 31>(self.limit_q.q.val()) << 1)
            - ((bit_cast::<33, 32>(self.size.q.val()) << 1) | self.borrow.val());
        self.decides_q.d.next = self.compares_q.q.val();
        self.cut.d.next = self.beyond.q.val() | self.margin.val().get_bit(32);

        comment!("The nearer of them, with its sign");
        self.kept.next = self.size.q.val();
        self.sign.next = self.zero.val();
        self.carry.next = self.zero.val();
        if self.negative.q.val() {
            self.sign.next = !self.zero.val();
        }
        if self.cut.q.val() {
            self.kept.next = bit_cast::<32, 31>(self.limit_q.q.val());
            if self.negative.q.val() {
                self.carry.next = self.one.val();
            }
        }
        if self.decides_q.q.val() {
            self.command_q.d.next = signed_cast((self.kept.val() ^ self.sign.val()) + self.carry.val());
            self.high_q.d.next = self.cut.q.val() & !self.negative.q.val();
            self.low_q.d.next = self.cut.q.val() & self.negative.q.val();
        }
        if self.count.val() {
            if self.high_q.q.val() | self.low_q.q.val() {
                if !self.ticks.q.val().all() {
                    self.ticks.d.next = self.ticks.q.val() + self.one_tick.val();
                }
            } else {
                self.ticks.d.next = self.no_ticks.val();
            }
        }

        self.command.next = self.command_q.q.val();
        self.limited_high.next = self.high_q.q.val();
        self.limited_low.next = self.low_q.q.val();
        self.limited_ticks.next = self.ticks.q.val();
        self.decides.next = self.decides_q.q.val();
        self.high.next = self.cut.q.val() & !self.negative.q.val();
        self.low.next = self.cut.q.val() & self.negative.q.val();
    }
}
