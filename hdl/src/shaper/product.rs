//! Multiplies coefficient and sample exactly; the product comes three clocks after both.
//!
//! A word of more than 17 bits uses two multipliers, for its lower 17 bits and for the rest, and one adder with a
//! register before and after: both in one clock would be the longest path of the shaper.

use crate::prelude::*;

kernel! {
    /// Sizes: W ≤ 32 word bits, P = W + 18 product bits; U = 1: two multipliers, 0: one, for W ≤ 17.
    pub(super) struct Product<const W: usize, const P: usize, const U: usize>
        where W <= 32 && P == W + 18 && (U == 1 || (U == 0 && W <= 17));

    inputs { rst: Bit, sample: Signed<W>, coefficient: Signed<18> }
    outputs { product: Signed<P> }
    parts { lower: SMul<18, 18, 36>, upper[U]: SMul<15, 18, 33> }
    registers { product_q: Bits<P> }
    wires {
        word: Signed<32>, word_bits: Bits<32>, lower_part: Bits<18>, wide_lower: Signed<P>,
        wide_upper: Signed<P>, upper_bits: Bits<P>,
    }
    constants {
        lower_mask: Bits<18> = from_u64(if U == 0 { 0x3ffff } else { 0x1ffff }),
        no_product: Signed<P> = from_i64(0),
    }
}

impl<const W: usize, const P: usize, const U: usize> Logic for Product<W, P, U> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module product_${width sample}");

        comment!("Product of the lower 17 bits, or of a short word");
        self.word.next = signed_bit_cast::<32, W>(self.sample.val());
        self.word_bits.next = unsigned_cast(self.word.val());
        self.lower_part.next = self.word_bits.val().get_bits::<18>(0) & self.lower_mask.val();
        self.lower.a.next = signed_cast(self.lower_part.val());
        self.lower.b.next = self.coefficient.val();
        self.wide_lower.next = signed_bit_cast::<P, 36>(self.lower.product.val());

        comment!("Product of the rest of a long word");
        self.wide_upper.next = self.no_product.val();
        for i in 0..U {
            self.upper[i].b.next = self.coefficient.val();
            self.upper[i].a.next = signed_cast(self.word_bits.val().get_bits::<15>(17));
            self.wide_upper.next = signed_bit_cast::<P, 33>(self.upper[i].product.val());
        }

        comment!("Together");
        self.upper_bits.next = unsigned_cast(self.wide_upper.val());
        self.product_q.d.next = (self.upper_bits.val() << 17) + unsigned_cast(self.wide_lower.val());
        self.product.next = signed_cast(self.product_q.q.val());
    }
}
