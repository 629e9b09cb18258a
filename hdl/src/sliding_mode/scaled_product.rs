//! operand · mantissa · 2^−shift, with one bit below the point that rounds.
//!
//! ```text
//! clock    0      1       2    3    …       13
//! read    ‾‾\_______________________________
//! load    _______________/‾‾\_______________         two clocks after `read`
//! shift   ____________________/‾‾‾‾‾‾‾‾‾‾‾\_         at least ten clocks: any shift takes no more
//! scaled  ---------------------< shifting >< product
//! ```
//!
//! The multiplier is two, of 18 × 18 bits as the blocks of an FPGA are: the operand's lower 17 bits and its upper 15, and the
//! sum of their products where the shifter loads it. In one clock with the multiplication that sum would be the longest path.
//!
//! The shift goes by four bits a clock and then by one: a shifter for any distance in one clock takes three times the cells.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct ScaledProduct {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) read: Signal<In, Bit>,
    pub(super) load: Signal<In, Bit>,
    pub(super) shift: Signal<In, Bit>,
    pub(super) operand: Signal<In, Signed<32>>,
    pub(super) gain: Signal<In, Bits<23>>,
    pub(super) scaled: Signal<Out, Signed<51>>,

    upper: SMul<15, 18, 33>,
    lower: SMul<18, 18, 36>,

    shifter: Dff<Signed<51>>,
    fours: Dff<Bits<3>>,
    ones: Dff<Bits<2>>,

    mantissa: Signal<Local, Bits<18>>,
    operand_bits: Signal<Local, Bits<32>>,
    lower_part: Signal<Local, Bits<17>>,
    upper_part: Signal<Local, Bits<15>>,
    upper_bits: Signal<Local, Bits<33>>,
    wide_lower: Signal<Local, Signed<50>>,
    product: Signal<Local, Bits<50>>,
    by_four: Signal<Local, Signed<47>>,
    by_one: Signal<Local, Signed<50>>,

    one_four: Constant<Bits<3>>,
    one: Constant<Bits<2>>,
}

impl Default for ScaledProduct {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            read: Signal::default(),
            load: Signal::default(),
            shift: Signal::default(),
            operand: Signal::default(),
            gain: Signal::default(),
            scaled: Signal::default(),
            upper: SMul::default(),
            lower: SMul::default(),
            shifter: Dff::default(),
            fours: Dff::default(),
            ones: Dff::default(),
            mantissa: Signal::default(),
            operand_bits: Signal::default(),
            lower_part: Signal::default(),
            upper_part: Signal::default(),
            upper_bits: Signal::default(),
            wide_lower: Signal::default(),
            product: Signal::default(),
            by_four: Signal::default(),
            by_one: Signal::default(),
            one_four: Constant::new(from_u64(1)),
            one: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for ScaledProduct {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module scaled_product");
        comment!("@about operand * mantissa * 2^-shift");
        comment!("@about The lowest bit is half an LSB: it rounds.");
        dff_setup!(self, clk, shifter, fours, ones);

        comment!("Multiply");
        self.mantissa.next = self.gain.val().get_bits::<18>(0);
        self.operand_bits.next = unsigned_cast(self.operand.val());
        self.lower_part.next = self.operand_bits.val().get_bits::<17>(0);
        self.upper_part.next = self.operand_bits.val().get_bits::<15>(17);
        self.upper.clk.next = self.clk.val();
        self.upper.a.next = signed_cast(self.upper_part.val());
        self.upper.b.next = signed_cast(self.mantissa.val());
        self.lower.clk.next = self.clk.val();
        self.lower.a.next = signed_cast(bit_cast::<18, 17>(self.lower_part.val()));
        self.lower.b.next = signed_cast(self.mantissa.val());
        self.upper_bits.next = unsigned_cast(self.upper.product.val());
        self.wide_lower.next = signed_bit_cast::<50, 36>(self.lower.product.val());
        self.product.next = (bit_cast::<50, 33>(self.upper_bits.val()) << 17) + unsigned_cast(self.wide_lower.val());

        comment!("Shift by four while it takes fours, then by one");
        self.by_four.next = self.shifter.q.val().get_bits::<47>(4);
        self.by_one.next = self.shifter.q.val().get_bits::<50>(1);
        if self.load.val() {
            self.shifter.d.next = signed_cast(bit_cast::<51, 50>(self.product.val()) << 1);
        }
        if self.shift.val() {
            if self.fours.q.val().any() {
                self.shifter.d.next = signed_bit_cast::<51, 47>(self.by_four.val());
                self.fours.d.next = self.fours.q.val() - self.one_four.val();
            } else if self.ones.q.val().any() {
                self.shifter.d.next = signed_bit_cast::<51, 50>(self.by_one.val());
                self.ones.d.next = self.ones.q.val() - self.one.val();
            }
        }
        if self.read.val() {
            self.ones.d.next = self.gain.val().get_bits::<2>(18);
            self.fours.d.next = self.gain.val().get_bits::<3>(20);
        }
        self.scaled.next = self.shifter.q.val();
    }
}
