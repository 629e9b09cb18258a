//! Computes the error e = r − x at `capture`, and saturates it to Q16.8; one clock later `high` or `low` reports a
//! saturation.
//!
//! Before saturation the difference is exact: modulo 2^32 counts, the range of the pulse counter, or for a rotary axis
//! modulo 2^24 counts, the range of its reference.

use crate::prelude::*;

kernel! {
    pub(super) struct Tracking;

    inputs { rst: Bit, capture: Bit, modulo: Bit, position_reference: Signed<32>, position: Signed<32> }
    outputs { tracking_error: Signed<24>, high: Bit, low: Bit }
    registers { error_q: Signed<24>, high_q: Bit, low_q: Bit }
    wires {
        wide_reference: Signed<40>, counts: Bits<32>, difference: Bits<40>, linear_excess: Bits<17>,
        linear_fits: Bit, rotary_excess: Bits<9>, rotary_fits: Bit, fits: Bit, negative: Bit,
    }
    constants { largest: Signed<24> = from_i64((1 << 23) - 1), least: Signed<24> = from_i64(-(1 << 23)) }
}

impl Logic for Tracking {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module tracking");

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
