//! e = r − x, taken at `capture` and saturated; the clock after tells whether it was cut.
//!
//! The difference of positions is exact modulo 2^32 counts, as the pulse counter counts, or modulo 2^24 for a rotary axis,
//! as its reference counts; then it saturates to Q16.8.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Tracking {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) capture: Signal<In, Bit>,
    pub(super) modulo: Signal<In, Bit>,
    pub(super) position_reference: Signal<In, Signed<32>>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) tracking_error: Signal<Out, Signed<24>>,
    pub(super) high: Signal<Out, Bit>,
    pub(super) low: Signal<Out, Bit>,

    error_q: Dff<Signed<24>>,
    high_q: Dff<Bit>,
    low_q: Dff<Bit>,

    wide_reference: Signal<Local, Signed<40>>,
    counts: Signal<Local, Bits<32>>,
    difference: Signal<Local, Bits<40>>,
    linear_excess: Signal<Local, Bits<17>>,
    linear_fits: Signal<Local, Bit>,
    rotary_excess: Signal<Local, Bits<9>>,
    rotary_fits: Signal<Local, Bit>,
    fits: Signal<Local, Bit>,
    negative: Signal<Local, Bit>,

    largest: Constant<Signed<24>>,
    least: Constant<Signed<24>>,
}

impl Default for Tracking {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            capture: Signal::default(),
            modulo: Signal::default(),
            position_reference: Signal::default(),
            position: Signal::default(),
            tracking_error: Signal::default(),
            high: Signal::default(),
            low: Signal::default(),
            error_q: Dff::default(),
            high_q: Dff::default(),
            low_q: Dff::default(),
            wide_reference: Signal::default(),
            counts: Signal::default(),
            difference: Signal::default(),
            linear_excess: Signal::default(),
            linear_fits: Signal::default(),
            rotary_excess: Signal::default(),
            rotary_fits: Signal::default(),
            fits: Signal::default(),
            negative: Signal::default(),
            largest: Constant::new(from_i64((1 << 23) - 1)),
            least: Constant::new(from_i64(-(1 << 23))),
        }
    }
}

impl Logic for Tracking {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module tracking");
        comment!("@about e = r - x, saturated.");
        dff_setup!(self, clk, error_q, high_q, low_q);

        comment!("e: exact modulo 2^40 LSB, or 2^32 if rotary");
        self.wide_reference.next = signed_bit_cast::<40, 32>(self.position_reference.val());
        self.counts.next = unsigned_cast(self.position.val());
        self.difference.next = unsigned_cast(self.wide_reference.val()) - (bit_cast::<40, 32>(self.counts.val()) << 8);
        self.linear_excess.next = self.difference.val().get_bits::<17>(23);
        self.linear_fits.next = self.linear_excess.val().all() | !self.linear_excess.val().any();
        self.rotary_excess.next = self.difference.val().get_bits::<9>(23);
        self.rotary_fits.next = self.rotary_excess.val().all() | !self.rotary_excess.val().any();
        self.fits.next = (self.linear_fits.val() & !self.modulo.val()) | (self.rotary_fits.val() & self.modulo.val());
        self.negative.next = (self.difference.val().get_bit(39) & !self.modulo.val())
            | (self.difference.val().get_bit(31) & self.modulo.val());

        comment!("Saturated");
        self.high_q.d.next = self.capture.val() & !self.fits.val() & !self.negative.val();
        self.low_q.d.next = self.capture.val() & !self.fits.val() & self.negative.val();
        if self.capture.val() {
            self.error_q.d.next = signed_cast(self.difference.val().get_bits::<24>(0));
            if !self.fits.val() {
                self.error_q.d.next = self.largest.val();
                if self.negative.val() {
                    self.error_q.d.next = self.least.val();
                }
            }
        }

        self.tracking_error.next = self.error_q.q.val();
        self.high.next = self.high_q.q.val();
        self.low.next = self.low_q.q.val();
    }
}
