//! ∫e, Q24.8: one e per `update`, saturated; frozen while it would push a command further that is cut already.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Integral {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) clear_integral: Signal<In, Bit>,
    pub(super) update: Signal<In, Bit>,
    pub(super) tracking_error: Signal<In, Signed<24>>,
    pub(super) opposes: Signal<In, Bit>,
    pub(super) limited_high: Signal<In, Bit>,
    pub(super) limited_low: Signal<In, Bit>,
    pub(super) value: Signal<Out, Signed<32>>,
    pub(super) high: Signal<Out, Bit>,
    pub(super) low: Signal<Out, Bit>,

    integral_q: Dff<Signed<32>>,

    wide_error: Signal<Local, Signed<33>>,
    wide_integral: Signal<Local, Signed<33>>,
    sum: Signal<Local, Bits<33>>,
    sum_bits: Signal<Local, Bits<32>>,
    lowers: Signal<Local, Bit>,
    takes: Signal<Local, Bit>,
    overflows: Signal<Local, Bit>,

    nothing: Constant<Signed<32>>,
    largest: Constant<Signed<32>>,
    least: Constant<Signed<32>>,
}

impl Default for Integral {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            clear_integral: Signal::default(),
            update: Signal::default(),
            tracking_error: Signal::default(),
            opposes: Signal::default(),
            limited_high: Signal::default(),
            limited_low: Signal::default(),
            value: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            integral_q: Dff::default(),
            wide_error: Signal::default(),
            wide_integral: Signal::default(),
            sum: Signal::default(),
            sum_bits: Signal::default(),
            lowers: Signal::default(),
            takes: Signal::default(),
            overflows: Signal::default(),
            nothing: Constant::new(from_i64(0)),
            largest: Constant::new(from_i64((1 << 31) - 1)),
            least: Constant::new(from_i64(-(1 << 31))),
        }
    }
}

impl Logic for Integral {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integral");
        comment!("@about Integral of e, frozen against a limit.");
        dff_setup!(self, clk, integral_q);

        self.wide_error.next = signed_bit_cast::<33, 24>(self.tracking_error.val());
        self.wide_integral.next = signed_bit_cast::<33, 32>(self.integral_q.q.val());
        self.sum.next = unsigned_cast(self.wide_integral.val()) + unsigned_cast(self.wide_error.val());
        self.sum_bits.next = self.sum.val().get_bits::<32>(0);
        self.overflows.next = self.sum.val().get_bit(32) != self.sum.val().get_bit(31);

        comment!("Frozen where e pushes against a limit");
        self.lowers.next = self.tracking_error.val().get_bit(23) ^ self.opposes.val();
        self.takes.next = self.update.val() & !self.limited_high.val();
        if self.lowers.val() {
            self.takes.next = self.update.val() & !self.limited_low.val();
        }
        if self.takes.val() {
            self.integral_q.d.next = signed_cast(self.sum_bits.val());
            if self.overflows.val() {
                self.integral_q.d.next = self.largest.val();
                if self.sum.val().get_bit(32) {
                    self.integral_q.d.next = self.least.val();
                }
            }
        }
        if self.clear_integral.val() {
            self.integral_q.d.next = self.nothing.val();
        }

        self.value.next = self.integral_q.q.val();
        self.high.next = self.takes.val() & self.overflows.val() & !self.sum.val().get_bit(32);
        self.low.next = self.takes.val() & self.overflows.val() & self.sum.val().get_bit(32);
    }
}
