//! e = r − x and de = dr − v, taken at `capture` and saturated.
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
    pub(super) velocity_reference: Signal<In, Signed<32>>,
    pub(super) position: Signal<In, Signed<32>>,
    pub(super) velocity: Signal<In, Signed<32>>,
    pub(super) tracking_error: Signal<Out, Signed<24>>,
    pub(super) error_rate: Signal<Out, Signed<32>>,
    pub(super) error_high: Signal<Out, Bit>,
    pub(super) error_low: Signal<Out, Bit>,
    pub(super) rate_high: Signal<Out, Bit>,
    pub(super) rate_low: Signal<Out, Bit>,

    error_q: Dff<Signed<24>>,
    error_rate_q: Dff<Signed<32>>,

    wide_reference: Signal<Local, Signed<40>>,
    counts: Signal<Local, Bits<32>>,
    difference: Signal<Local, Bits<40>>,
    linear_excess: Signal<Local, Bits<17>>,
    linear_fits: Signal<Local, Bit>,
    rotary_excess: Signal<Local, Bits<9>>,
    rotary_fits: Signal<Local, Bit>,
    error_fits: Signal<Local, Bit>,
    wide_target: Signal<Local, Signed<33>>,
    wide_velocity: Signal<Local, Signed<33>>,
    rate: Signal<Local, Bits<33>>,
    rate_bits: Signal<Local, Bits<32>>,
    rate_fits: Signal<Local, Bit>,
    error_negative: Signal<Local, Bit>,
    rate_negative: Signal<Local, Bit>,

    largest_error: Constant<Signed<24>>,
    least_error: Constant<Signed<24>>,
    largest_rate: Constant<Signed<32>>,
    least_rate: Constant<Signed<32>>,
}

impl Default for Tracking {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            capture: Signal::default(),
            modulo: Signal::default(),
            position_reference: Signal::default(),
            velocity_reference: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            tracking_error: Signal::default(),
            error_rate: Signal::default(),
            error_high: Signal::default(),
            error_low: Signal::default(),
            rate_high: Signal::default(),
            rate_low: Signal::default(),
            error_q: Dff::default(),
            error_rate_q: Dff::default(),
            wide_reference: Signal::default(),
            counts: Signal::default(),
            difference: Signal::default(),
            linear_excess: Signal::default(),
            linear_fits: Signal::default(),
            rotary_excess: Signal::default(),
            rotary_fits: Signal::default(),
            error_fits: Signal::default(),
            wide_target: Signal::default(),
            wide_velocity: Signal::default(),
            rate: Signal::default(),
            rate_bits: Signal::default(),
            rate_fits: Signal::default(),
            error_negative: Signal::default(),
            rate_negative: Signal::default(),
            largest_error: Constant::new(from_i64((1 << 23) - 1)),
            least_error: Constant::new(from_i64(-(1 << 23))),
            largest_rate: Constant::new(from_i64((1 << 31) - 1)),
            least_rate: Constant::new(from_i64(-(1 << 31))),
        }
    }
}

impl Logic for Tracking {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module tracking");
        comment!("@about e = r - x and de = dr - v, saturated.");
        dff_setup!(self, clk, error_q, error_rate_q);

        comment!("e: exact modulo 2^40 LSB, or 2^32 if rotary");
        self.wide_reference.next = signed_bit_cast::<40, 32>(self.position_reference.val());
        self.counts.next = unsigned_cast(self.position.val());
        self.difference.next = unsigned_cast(self.wide_reference.val()) - (bit_cast::<40, 32>(self.counts.val()) << 8);
        self.linear_excess.next = self.difference.val().get_bits::<17>(23);
        self.linear_fits.next = self.linear_excess.val().all() | !self.linear_excess.val().any();
        self.rotary_excess.next = self.difference.val().get_bits::<9>(23);
        self.rotary_fits.next = self.rotary_excess.val().all() | !self.rotary_excess.val().any();
        self.error_fits.next =
            (self.linear_fits.val() & !self.modulo.val()) | (self.rotary_fits.val() & self.modulo.val());
        self.error_negative.next = (self.difference.val().get_bit(39) & !self.modulo.val())
            | (self.difference.val().get_bit(31) & self.modulo.val());

        comment!("de");
        self.wide_target.next = signed_bit_cast::<33, 32>(self.velocity_reference.val());
        self.wide_velocity.next = signed_bit_cast::<33, 32>(self.velocity.val());
        self.rate.next = unsigned_cast(self.wide_target.val()) - unsigned_cast(self.wide_velocity.val());
        self.rate_bits.next = self.rate.val().get_bits::<32>(0);
        self.rate_negative.next = self.rate.val().get_bit(32);
        self.rate_fits.next = self.rate.val().get_bit(31) == self.rate.val().get_bit(32);

        comment!("Saturated");
        self.error_high.next = self.capture.val() & !self.error_fits.val() & !self.error_negative.val();
        self.error_low.next = self.capture.val() & !self.error_fits.val() & self.error_negative.val();
        self.rate_high.next = self.capture.val() & !self.rate_fits.val() & !self.rate_negative.val();
        self.rate_low.next = self.capture.val() & !self.rate_fits.val() & self.rate_negative.val();
        if self.capture.val() {
            self.error_q.d.next = signed_cast(self.difference.val().get_bits::<24>(0));
            self.error_rate_q.d.next = signed_cast(self.rate_bits.val());
            if !self.error_fits.val() {
                self.error_q.d.next = self.largest_error.val();
                if self.error_negative.val() {
                    self.error_q.d.next = self.least_error.val();
                }
            }
            if !self.rate_fits.val() {
                self.error_rate_q.d.next = self.largest_rate.val();
                if self.rate_negative.val() {
                    self.error_rate_q.d.next = self.least_rate.val();
                }
            }
        }

        self.tracking_error.next = self.error_q.q.val();
        self.error_rate.next = self.error_rate_q.q.val();
    }
}
