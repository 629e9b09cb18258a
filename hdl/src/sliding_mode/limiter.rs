//! The command: the sum cut to ±limit at `take`; and, at `count`, for how many ticks in a row it has been cut.
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
    pub(super) high: Signal<Out, Bit>,
    pub(super) low: Signal<Out, Bit>,

    command_q: Dff<Signed<32>>,
    high_q: Dff<Bit>,
    low_q: Dff<Bit>,
    ticks: Dff<Bits<16>>,

    negative: Signal<Local, Bit>,
    size: Signal<Local, Bits<32>>,
    sign: Signal<Local, Bits<32>>,
    borrow: Signal<Local, Bits<33>>,
    borrow_word: Signal<Local, Bits<32>>,
    flipped: Signal<Local, Bits<32>>,
    margin: Signal<Local, Bits<33>>,
    cut: Signal<Local, Bit>,
    nearest: Signal<Local, Bits<32>>,

    zero: Constant<Bits<32>>,
    nothing: Constant<Bits<33>>,
    one: Constant<Bits<33>>,
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
            high: Signal::default(),
            low: Signal::default(),
            command_q: Dff::default(),
            high_q: Dff::default(),
            low_q: Dff::default(),
            ticks: Dff::default(),
            negative: Signal::default(),
            size: Signal::default(),
            sign: Signal::default(),
            borrow: Signal::default(),
            borrow_word: Signal::default(),
            flipped: Signal::default(),
            margin: Signal::default(),
            cut: Signal::default(),
            nearest: Signal::default(),
            zero: Constant::new(from_u64(0)),
            nothing: Constant::new(from_u64(0)),
            one: Constant::new(from_u64(1)),
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
        dff_setup!(self, clk, command_q, high_q, low_q, ticks);

        comment!("Its size, less an LSB if negative, on the limit");
        self.negative.next = self.word.val().get_bit(31);
        self.size.next = unsigned_cast(self.word.val());
        self.sign.next = self.zero.val();
        self.borrow.next = self.nothing.val();
        if self.negative.val() {
            self.sign.next = !self.zero.val();
            self.borrow.next = self.one.val();
        }
        self.borrow_word.next = self.borrow.val().get_bits::<32>(0);
        self.flipped.next = self.size.val() ^ self.sign.val();
        self.margin.next = (bit_cast::<33, 31>(self.limit.val()) << 1)
            - ((bit_cast::<33, 32>(self.flipped.val()) << 1) | self.borrow.val());
        self.cut.next = self.word_high.val() | self.word_low.val() | self.margin.val().get_bit(32);
        self.nearest.next = (bit_cast::<32, 31>(self.limit.val()) ^ self.sign.val()) + self.borrow_word.val();

        if self.take.val() {
            self.command_q.d.next = self.word.val();
            if self.cut.val() {
                self.command_q.d.next = signed_cast(self.nearest.val());
            }
            self.high_q.d.next = self.cut.val() & !self.negative.val();
            self.low_q.d.next = self.cut.val() & self.negative.val();
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
        self.high.next = self.cut.val() & !self.negative.val();
        self.low.next = self.cut.val() & self.negative.val();
    }
}
