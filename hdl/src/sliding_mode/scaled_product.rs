//! operand · mantissa · 2^−shift, with one bit below the point that rounds.
//!
//! ```text
//! clock    0      1       2    3    …       34
//! read    ‾‾\_______________________________
//! load    _______________/‾‾\_______________         two clocks after `read`
//! shift   ____________________/‾‾‾‾‾‾‾‾‾‾‾\_         31 clocks, the largest shift
//! scaled  ---------------------< shifting >< product
//! ```
//!
//! With `unit` the mantissa is 1, −1 with `minus`, and the shift 8: words that are added as they are need no setting, and
//! go on before the shift, but e.
//!
//! The multiplier is two, of 18 × 18 bits as the blocks of an FPGA are: the operand's lower 17 bits and its upper 15, and the
//! sum of their products where the shifter loads it. In one clock with the multiplication that sum would be the longest path.
//!
//! The shift goes by one bit a clock: by four, and then by one, is a LUT more for each bit.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct ScaledProduct {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) read: Signal<In, Bit>,
    pub(super) load: Signal<In, Bit>,
    pub(super) shift: Signal<In, Bit>,
    pub(super) unit: Signal<In, Bit>,
    pub(super) minus: Signal<In, Bit>,
    pub(super) operand: Signal<In, Signed<32>>,
    pub(super) gain: Signal<In, Bits<23>>,
    pub(super) scaled: Signal<Out, Signed<51>>,

    upper: SMul<15, 18, 33>,
    lower: SMul<18, 18, 36>,

    shifter: Dff<Signed<51>>,
    left: Dff<Bits<5>>,

    of_gain: Signal<Local, Bits<18>>,
    of_unit: Signal<Local, Bits<18>>,
    mantissa: Signal<Local, Bits<18>>,
    distance: Signal<Local, Bits<5>>,
    operand_bits: Signal<Local, Bits<32>>,
    lower_part: Signal<Local, Bits<17>>,
    upper_part: Signal<Local, Bits<15>>,
    lower_bits: Signal<Local, Bits<36>>,
    last_bits: Signal<Local, Bits<17>>,
    carried: Signal<Local, Signed<19>>,
    wide_carried: Signal<Local, Signed<33>>,
    upper_sum: Signal<Local, Bits<33>>,
    product: Signal<Local, Bits<50>>,
    by_one: Signal<Local, Signed<50>>,

    no_unit: Constant<Bits<18>>,
    one: Constant<Bits<18>>,
    minus_one: Constant<Bits<18>>,
    eight: Constant<Bits<5>>,
    one_bit: Constant<Bits<5>>,
}

impl Default for ScaledProduct {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            read: Signal::default(),
            load: Signal::default(),
            shift: Signal::default(),
            unit: Signal::default(),
            minus: Signal::default(),
            operand: Signal::default(),
            gain: Signal::default(),
            scaled: Signal::default(),
            upper: SMul::default(),
            lower: SMul::default(),
            shifter: Dff::default(),
            left: Dff::default(),
            of_gain: Signal::default(),
            of_unit: Signal::default(),
            mantissa: Signal::default(),
            distance: Signal::default(),
            operand_bits: Signal::default(),
            lower_part: Signal::default(),
            upper_part: Signal::default(),
            lower_bits: Signal::default(),
            last_bits: Signal::default(),
            carried: Signal::default(),
            wide_carried: Signal::default(),
            upper_sum: Signal::default(),
            product: Signal::default(),
            by_one: Signal::default(),
            no_unit: Constant::new(from_u64(0)),
            one: Constant::new(from_u64(1)),
            minus_one: Constant::new(from_u64((1 << 18) - 1)),
            eight: Constant::new(from_u64(8)),
            one_bit: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for ScaledProduct {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module scaled_product");
        comment!("@about operand * mantissa * 2^-shift");
        comment!("@about The lowest bit is half an LSB: it rounds.");
        dff_setup!(self, clk, shifter, left);

        comment!("Multiply by the gain, or by one or minus one");
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
        self.upper.clk.next = self.clk.val();
        self.upper.a.next = signed_cast(self.upper_part.val());
        self.upper.b.next = signed_cast(self.mantissa.val());
        self.lower.clk.next = self.clk.val();
        self.lower.a.next = signed_cast(bit_cast::<18, 17>(self.lower_part.val()));
        self.lower.b.next = signed_cast(self.mantissa.val());
        self.lower_bits.next = unsigned_cast(self.lower.product.val());
        self.carried.next = signed_cast(self.lower_bits.val().get_bits::<19>(17));
        self.wide_carried.next = signed_bit_cast::<33, 19>(self.carried.val());
        self.upper_sum.next = unsigned_cast(self.upper.product.val()) + unsigned_cast(self.wide_carried.val());
        self.last_bits.next = self.lower_bits.val().get_bits::<17>(0);
        self.product.next = (bit_cast::<50, 33>(self.upper_sum.val()) << 17) | bit_cast::<50, 17>(self.last_bits.val());

        comment!("Shift by one, so often as the gain says");
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
