//! Coefficient times sample, exactly, three clocks after both.
//!
//! A word of more than 17 bits goes through two multipliers, its lower 17 bits and the rest, and one adder with a register
//! before and after: in one clock both would be the longest path of the shaper.

use crate::prelude::*;

/// W ≤ 32 word, P = W + 18 product bits; U = 1: two multipliers, 0: one for W ≤ 17.
#[derive(LogicBlock)]
pub(super) struct Product<const W: usize, const P: usize, const U: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) sample: Signal<In, Signed<W>>,
    pub(super) coefficient: Signal<In, Signed<18>>,
    pub(super) product: Signal<Out, Signed<P>>,

    lower: SMul<18, 18, 36>,
    upper: [SMul<15, 18, 33>; U],
    product_q: Dff<Bits<P>>,

    word: Signal<Local, Signed<32>>,
    word_bits: Signal<Local, Bits<32>>,
    lower_part: Signal<Local, Bits<18>>,
    wide_lower: Signal<Local, Signed<P>>,
    wide_upper: Signal<Local, Signed<P>>,
    upper_bits: Signal<Local, Bits<P>>,

    lower_mask: Constant<Bits<18>>,
    no_product: Constant<Signed<P>>,
}

impl<const W: usize, const P: usize, const U: usize> Default for Product<W, P, U> {
    fn default() -> Self {
        const { assert!(W <= 32 && P == W + 18 && (U == 1 || (U == 0 && W <= 17))) };
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            sample: Signal::default(),
            coefficient: Signal::default(),
            product: Signal::default(),
            lower: SMul::default(),
            upper: std::array::from_fn(|_| SMul::default()),
            product_q: Dff::default(),
            word: Signal::default(),
            word_bits: Signal::default(),
            lower_part: Signal::default(),
            wide_lower: Signal::default(),
            wide_upper: Signal::default(),
            upper_bits: Signal::default(),
            lower_mask: Constant::new(from_u64(if U == 0 { 0x3ffff } else { 0x1ffff })),
            no_product: Constant::new(from_i64(0)),
        }
    }
}

impl<const W: usize, const P: usize, const U: usize> Logic for Product<W, P, U> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module product_${width sample}");
        comment!("@about coefficient * sample, 3 clocks after both.");
        dff_setup!(self, clk, product_q);

        comment!("The lower 17 bits, or all of a short word");
        self.word.next = signed_bit_cast::<32, W>(self.sample.val());
        self.word_bits.next = unsigned_cast(self.word.val());
        self.lower_part.next = self.word_bits.val().get_bits::<18>(0) & self.lower_mask.val();
        self.lower.clk.next = self.clk.val();
        self.lower.a.next = signed_cast(self.lower_part.val());
        self.lower.b.next = self.coefficient.val();
        self.wide_lower.next = signed_bit_cast::<P, 36>(self.lower.product.val());

        comment!("The rest of a long one");
        self.wide_upper.next = self.no_product.val();
        for i in 0..U {
            self.upper[i].clk.next = self.clk.val();
            self.upper[i].a.next = signed_cast(self.word_bits.val().get_bits::<15>(17));
            self.upper[i].b.next = self.coefficient.val();
            self.wide_upper.next = signed_bit_cast::<P, 33>(self.upper[i].product.val());
        }

        comment!("Together");
        self.upper_bits.next = unsigned_cast(self.wide_upper.val());
        self.product_q.d.next = (self.upper_bits.val() << 17) + unsigned_cast(self.wide_lower.val());
        self.product.next = signed_cast(self.product_q.q.val());
    }
}
