//! Computes operand · mantissa · 2^−shift, with one bit below the point for rounding.
//!
//! ```text
//! clock    0      1       2    3    …       34
//! read    ‾‾\_______________________________
//! load    _______________/‾‾\_______________         two clocks after `read`
//! shift   ____________________/‾‾‾‾‾‾‾‾‾‾‾\_         31 clocks, the largest shift
//! scaled  ---------------------< shifting >< product
//! ```
//!
//! With `unit` the mantissa is 1, or −1 with `minus`, and the shift is 8: words that are added unscaled need no
//! setting, and skip the shift, except for e.
//!
//! There are two multipliers of 18 × 18 bits, as the blocks of an FPGA are: for the operand's lower 17 bits and its
//! upper 15; their products are added where the shifter loads them. That sum would be the longest path if it were in
//! one clock with the multiplication.
//!
//! The shift goes by one bit per clock: shifting by four and then by one would take one LUT more for each bit.

use crate::prelude::*;

kernel! {
    pub(super) struct ScaledProduct;

    inputs {
        rst: Bit,
        read: Bit,
        load: Bit,
        shift: Bit,
        unit: Bit,
        minus: Bit,
        operand: Signed<32>,
        gain: Bits<23>,
    }
    outputs { scaled: Signed<51> }
    parts { upper: SMul<15, 18, 33>, lower: SMul<18, 18, 36> }
    registers { shifter: Signed<51>, left: Bits<5> }
    wires {
        of_gain: Bits<18>, of_unit: Bits<18>, mantissa: Bits<18>, distance: Bits<5>, operand_bits: Bits<32>,
        lower_part: Bits<17>, upper_part: Bits<15>, lower_bits: Bits<36>, last_bits: Bits<17>,
        carried: Signed<19>, wide_carried: Signed<33>, upper_sum: Bits<33>, product: Bits<50>,
        by_one: Signed<50>,
    }
    constants {
        no_unit: Bits<18> = from_u64(0),
        one: Bits<18> = from_u64(1),
        minus_one: Bits<18> = from_u64((1 << 18) - 1),
        eight: Bits<5> = from_u64(8),
        one_bit: Bits<5> = from_u64(1),
    }
}

impl Logic for ScaledProduct {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module scaled_product");

        comment!("Multiply by the gain, by one or by minus one");
        self.of_gain.next = self.gain.val().get_bits::<18>(0);
        self.of_unit.next = self.no_unit.val();
        self.distance.next = self.gain.val().get_bits::<5>(18);
        if self.unit.val() {
            self.of_gain.next = self.no_unit.val();
            self.of_unit.next = self.one.val();
            self.distance.next = self.eight.val();
        }
        if self.minus.val() {
            self.of_unit.next = self.minus_one.val();
        }
        self.mantissa.next = self.of_gain.val() | self.of_unit.val();
        self.operand_bits.next = unsigned_cast(self.operand.val());
        self.lower_part.next = self.operand_bits.val().get_bits::<17>(0);
        self.upper_part.next = self.operand_bits.val().get_bits::<15>(17);
        self.upper.a.next = signed_cast(self.upper_part.val());
        self.upper.b.next = signed_cast(self.mantissa.val());
        self.lower.a.next = signed_cast(bit_cast::<18, 17>(self.lower_part.val()));
        self.lower.b.next = signed_cast(self.mantissa.val());
        self.lower_bits.next = unsigned_cast(self.lower.product.val());
        self.carried.next = signed_cast(self.lower_bits.val().get_bits::<19>(17));
        self.wide_carried.next = signed_bit_cast::<33, 19>(self.carried.val());
        self.upper_sum.next = unsigned_cast(self.upper.product.val()) + unsigned_cast(self.wide_carried.val());
        self.last_bits.next = self.lower_bits.val().get_bits::<17>(0);
        self.product.next = (bit_cast::<50, 33>(self.upper_sum.val()) << 17) | bit_cast::<50, 17>(self.last_bits.val());

        comment!("Shift by one, as many times as the gain says");
        self.by_one.next = self.shifter.q.val().get_bits::<50>(1);
        if self.shift.val() & self.left.q.val().any() {
            self.shifter.d.next = signed_bit_cast::<51, 50>(self.by_one.val());
            self.left.d.next = self.left.q.val() - self.one_bit.val();
        }
        if self.load.val() {
            self.shifter.d.next = signed_cast(bit_cast::<51, 50>(self.product.val()) << 1);
        }
        if self.read.val() {
            self.left.d.next = self.distance.val();
        }
        self.scaled.next = self.shifter.q.val();
    }
}
