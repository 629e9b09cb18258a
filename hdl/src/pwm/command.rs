//! From a duty to the width of the high side's pulse, in two clocks.
//!
//! ```text
//! clock 1   magnitude = min(|duty|, max_duty);  half bridge: 0 if negative
//! clock 2   width     = magnitude − D;          locked: (period − 2 D ± magnitude) / 2, rounded down
//! ```

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct Command {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) mode: Signal<In, Bits<2>>,
    pub(super) duty: Signal<In, Signed<17>>,
    pub(super) max_duty: Signal<In, Bits<16>>,
    pub(super) period: Signal<In, Bits<16>>,
    pub(super) dead_time: Signal<In, Bits<10>>,
    pub(super) width: Signal<Out, Signed<18>>,
    pub(super) width_mode: Signal<Out, Bits<2>>,
    pub(super) negative: Signal<Out, Bit>,
    pub(super) saturated: Signal<Out, Bit>,

    limited_mode: Dff<Bits<2>>,
    limited_negative: Dff<Bit>,
    limited: Dff<Bit>,
    magnitude: Dff<Bits<16>>,
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
    wide: Signal<Local, Bits<18>>,
    whole: Signal<Local, Bits<18>>,
    upper: Signal<Local, Bits<18>>,
    lower: Signal<Local, Bits<18>>,
    upper_half: Signal<Local, Signed<17>>,
    lower_half: Signal<Local, Signed<17>>,
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
            width_q,
            width_mode_q,
            negative_q,
            saturated_q
        );

        comment!("First clock: size, and limit");
        self.below_zero.next = self.duty.val().get_bit(16);
        self.duty_bits.next = unsigned_cast(self.duty.val());
        self.size.next = self.duty_bits.val();
        if self.below_zero.val() {
            self.size.next = !self.duty_bits.val() + 1;
        }
        self.over.next = false;
        self.one_sided.next = (self.mode.val() == 1) & self.below_zero.val();
        self.magnitude.d.next = self.size.val().get_bits::<16>(0);
        if self.size.val() > bit_cast::<17, 16>(self.max_duty.val()) {
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
        comment!("what the period leaves, up or down");
        self.dead.next = bit_cast::<18, 10>(self.dead_time.val());
        self.wide.next = bit_cast::<18, 16>(self.magnitude.q.val());
        self.whole.next = bit_cast::<18, 16>(self.period.val()) - (self.dead.val() << 1);
        self.upper.next = self.whole.val() + self.wide.val();
        self.lower.next = self.whole.val() - self.wide.val();
        self.upper_half.next = signed_cast(self.upper.val().get_bits::<17>(1));
        self.lower_half.next = signed_cast(self.lower.val().get_bits::<17>(1));
        self.width_q.d.next = signed_cast(self.wide.val() - self.dead.val());
        if self.limited_mode.q.val() == 3 {
            self.width_q.d.next = signed_bit_cast::<18, 17>(self.upper_half.val());
            if self.limited_negative.q.val() {
                self.width_q.d.next = signed_bit_cast::<18, 17>(self.lower_half.val());
            }
        }
        self.width_mode_q.d.next = self.limited_mode.q.val();
        self.negative_q.d.next = self.limited_negative.q.val();
        self.saturated_q.d.next = self.limited.q.val() | (self.magnitude.q.val() > self.period.val());

        self.width.next = self.width_q.q.val();
        self.width_mode.next = self.width_mode_q.q.val();
        self.negative.next = self.negative_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
    }
}
