//! From a duty to the width of the high side's pulse, in two clocks.
//!
//! ```text
//! clock 1   magnitude = min(|duty|, max_duty);  half bridge: 0 if negative
//! clock 2   width     = magnitude − D;          locked: (period − 2 D ± magnitude) / 2, rounded down
//! ```
//!
//! `whole`, period − 2 D, is a register too: it follows the two a clock later, and the PWM waits for it before it starts.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Command {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) mode: Signal<In, Bits<2>>,
    pub(super) duty: Signal<In, Signed<17>>,
    pub(super) max_duty: Signal<In, Bits<16>>,
    pub(super) period: Signal<In, Bits<16>>,
    pub(super) dead_time: Signal<In, Bits<10>>,
    pub(super) whole: Signal<Out, Signed<18>>,
    pub(super) width: Signal<Out, Signed<18>>,
    pub(super) width_mode: Signal<Out, Bits<2>>,
    pub(super) negative: Signal<Out, Bit>,
    pub(super) saturated: Signal<Out, Bit>,

    limited_mode: Dff<Bits<2>>,
    limited_negative: Dff<Bit>,
    limited: Dff<Bit>,
    magnitude: Dff<Bits<16>>,
    whole_q: Dff<Signed<18>>,
    width_q: Dff<Signed<18>>,
    width_mode_q: Dff<Bits<2>>,
    negative_q: Dff<Bit>,
    saturated_q: Dff<Bit>,

    below_zero: Signal<Local, Bit>,
    duty_bits: Signal<Local, Bits<17>>,
    size: Signal<Local, Bits<17>>,
    over: Signal<Local, Bit>,
    one_sided: Signal<Local, Bit>,
    dead: Signal<Local, Bits<18>>,
    wide_whole: Signal<Local, Signed<20>>,
    base: Signal<Local, Bits<20>>,
    operand: Signal<Local, Bits<20>>,
    sum: Signal<Local, Bits<20>>,

    carry: Constant<Bits<20>>,
}

impl Default for Command {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            mode: Signal::default(),
            duty: Signal::default(),
            max_duty: Signal::default(),
            period: Signal::default(),
            dead_time: Signal::default(),
            whole: Signal::default(),
            width: Signal::default(),
            width_mode: Signal::default(),
            negative: Signal::default(),
            saturated: Signal::default(),
            limited_mode: Dff::default(),
            limited_negative: Dff::default(),
            limited: Dff::default(),
            magnitude: Dff::default(),
            whole_q: Dff::default(),
            width_q: Dff::default(),
            width_mode_q: Dff::default(),
            negative_q: Dff::default(),
            saturated_q: Dff::default(),
            below_zero: Signal::default(),
            duty_bits: Signal::default(),
            size: Signal::default(),
            over: Signal::default(),
            one_sided: Signal::default(),
            dead: Signal::default(),
            wide_whole: Signal::default(),
            base: Signal::default(),
            operand: Signal::default(),
            sum: Signal::default(),
            carry: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for Command {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_command");
        comment!("@about Duty to the width of the high pulse.");
        dff_setup!(
            self,
            clk,
            limited_mode,
            limited_negative,
            limited,
            magnitude,
            whole_q,
            width_q,
            width_mode_q,
            negative_q,
            saturated_q
        );

        comment!("First clock: size and limit. Of a negative duty");
        comment!("the inverse, which is one less: bit 0 adds it");
        self.below_zero.next = self.duty.val().get_bit(16);
        self.duty_bits.next = unsigned_cast(self.duty.val());
        self.size.next = self.duty_bits.val() << 1;
        if self.below_zero.val() {
            self.size.next = !(self.duty_bits.val() << 1);
        }
        self.over.next = false;
        self.one_sided.next = (self.mode.val() == 1) & self.below_zero.val();
        self.magnitude.d.next = self.size.val().get_bits::<16>(1) + bit_cast::<16, 1>(self.size.val().get_bits::<1>(0));
        if self.size.val() > (bit_cast::<17, 16>(self.max_duty.val()) << 1) {
            self.over.next = true;
            self.magnitude.d.next = self.max_duty.val();
        }
        if self.one_sided.val() {
            self.magnitude.d.next = 0.into();
        }
        self.limited.d.next = self.over.val() | self.one_sided.val();
        self.limited_mode.d.next = self.mode.val();
        self.limited_negative.d.next = self.below_zero.val();

        comment!("Second clock: less the dead time; locked: half of");
        comment!("what the period leaves, up or down. One sum, of");
        comment!("twice the width; to subtract, inverse and carry");
        self.dead.next = bit_cast::<18, 10>(self.dead_time.val());
        self.whole_q.d.next = signed_cast(bit_cast::<18, 16>(self.period.val()) - (self.dead.val() << 1));
        self.wide_whole.next = signed_bit_cast::<20, 18>(self.whole_q.q.val());
        self.base.next = !(bit_cast::<20, 10>(self.dead_time.val()) << 2);
        self.operand.next = (bit_cast::<20, 16>(self.magnitude.q.val()) << 2) | self.carry.val();
        if self.limited_mode.q.val() == 3 {
            self.base.next = unsigned_cast(self.wide_whole.val()) << 1;
            self.operand.next = bit_cast::<20, 16>(self.magnitude.q.val()) << 1;
            if self.limited_negative.q.val() {
                self.base.next = (unsigned_cast(self.wide_whole.val()) << 1) | self.carry.val();
                self.operand.next = !(bit_cast::<20, 16>(self.magnitude.q.val()) << 1);
            }
        }
        self.sum.next = self.base.val() + self.operand.val();
        self.width_q.d.next = signed_cast(self.sum.val().get_bits::<18>(2));
        self.width_mode_q.d.next = self.limited_mode.q.val();
        self.negative_q.d.next = self.limited_negative.q.val();
        self.saturated_q.d.next = self.limited.q.val() | (self.magnitude.q.val() > self.period.val());

        self.whole.next = self.whole_q.q.val();
        self.width.next = self.width_q.q.val();
        self.width_mode.next = self.width_mode_q.q.val();
        self.negative.next = self.negative_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
