//! The command: the sum cut to ±limit at `take`; and, at `count`, for how many ticks in a row it has been cut.

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

    most: Signal<Local, Signed<33>>,
    least: Signal<Local, Signed<33>>,
    sum: Signal<Local, Signed<33>>,
    cut_high: Signal<Local, Bit>,
    cut_low: Signal<Local, Bit>,

    zero: Constant<Bits<33>>,
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
            most: Signal::default(),
            least: Signal::default(),
            sum: Signal::default(),
            cut_high: Signal::default(),
            cut_low: Signal::default(),
            zero: Constant::new(from_u64(0)),
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

        self.most.next = signed_cast(bit_cast::<33, 31>(self.limit.val()));
        self.least.next = signed_cast(self.zero.val() - bit_cast::<33, 31>(self.limit.val()));
        self.sum.next = signed_bit_cast::<33, 32>(self.word.val());
        self.cut_high.next = self.word_high.val() | (self.sum.val() > self.most.val());
        self.cut_low.next = self.word_low.val() | (self.sum.val() < self.least.val());
        if self.take.val() {
            self.command_q.d.next = self.word.val();
            if self.cut_high.val() {
                self.command_q.d.next = self.most.val().get_bits::<32>(0);
            }
            if self.cut_low.val() {
                self.command_q.d.next = self.least.val().get_bits::<32>(0);
            }
            self.high_q.d.next = self.cut_high.val();
            self.low_q.d.next = self.cut_low.val();
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
        self.high.next = self.cut_high.val();
        self.low.next = self.cut_low.val();
    }
}
