//! One sum of 64 bits; its upper half is the count, and the lowest two bits of that are A and B.

use crate::prelude::*;
use crate::simulation::Pins;

#[derive(LogicBlock)]
pub(super) struct EncoderGenerator {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) loop_back: Signal<In, Bit>,
    pub(super) rate: Signal<In, Signed<32>>,
    pub(super) index_every: Signal<In, Bits<16>>,
    pub(super) pin_a: Signal<In, Bit>,
    pub(super) pin_b: Signal<In, Bit>,
    pub(super) pin_z: Signal<In, Bit>,
    pub(super) pin_a_n: Signal<In, Bit>,
    pub(super) pin_b_n: Signal<In, Bit>,
    pub(super) pin_z_n: Signal<In, Bit>,
    pub(super) a: Signal<Out, Bit>,
    pub(super) b: Signal<Out, Bit>,
    pub(super) z: Signal<Out, Bit>,
    pub(super) a_n: Signal<Out, Bit>,
    pub(super) b_n: Signal<Out, Bit>,
    pub(super) z_n: Signal<Out, Bit>,
    pub(super) generated_count: Signal<Out, Signed<32>>,

    sum: Dff<Signed<64>>,
    period: Dff<Bits<14>>,
    line_a: Dff<Bit>,
    line_b: Dff<Bit>,
    line_z: Dff<Bit>,
    moved: Dff<Bit>,
    shown_a: PinRegister,
    shown_b: PinRegister,
    shown_z: PinRegister,
    shown_a_n: PinRegister,
    shown_b_n: PinRegister,
    shown_z_n: PinRegister,

    sum_bits: Signal<Local, Bits<64>>,
    next_sum: Signal<Local, Signed<64>>,
    next_bits: Signal<Local, Bits<64>>,
    wide_rate: Signal<Local, Signed<64>>,
    next_a: Signal<Local, Bit>,
    next_b: Signal<Local, Bit>,
    next_z: Signal<Local, Bit>,
    index_periods: Signal<Local, Bits<14>>,
    down: Signal<Local, Bit>,
    passes_up: Signal<Local, Bit>,
    passes_down: Signal<Local, Bit>,
    from_period: Signal<Local, Bits<14>>,
    change: Signal<Local, Bits<14>>,
    next_period: Signal<Local, Bits<14>>,
    generated_a: Signal<Local, Bit>,
    generated_b: Signal<Local, Bit>,
    generated_z: Signal<Local, Bit>,

    no_period: Constant<Bits<14>>,
    one_up: Constant<Bits<14>>,
    one_down: Constant<Bits<14>>,
}

impl Default for EncoderGenerator {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            loop_back: Signal::default(),
            rate: Signal::default(),
            index_every: Signal::default(),
            pin_a: Signal::default(),
            pin_b: Signal::default(),
            pin_z: Signal::default(),
            pin_a_n: Signal::default(),
            pin_b_n: Signal::default(),
            pin_z_n: Signal::default(),
            a: Signal::default(),
            b: Signal::default(),
            z: Signal::default(),
            a_n: Signal::default(),
            b_n: Signal::default(),
            z_n: Signal::default(),
            generated_count: Signal::default(),
            sum: Dff::default(),
            period: Dff::default(),
            line_a: Dff::default(),
            line_b: Dff::default(),
            line_z: Dff::default(),
            moved: Dff::default(),
            shown_a: PinRegister::default(),
            shown_b: PinRegister::default(),
            shown_z: PinRegister::default(),
            shown_a_n: PinRegister::default(),
            shown_b_n: PinRegister::default(),
            shown_z_n: PinRegister::default(),
            sum_bits: Signal::default(),
            next_sum: Signal::default(),
            next_bits: Signal::default(),
            wide_rate: Signal::default(),
            next_a: Signal::default(),
            next_b: Signal::default(),
            next_z: Signal::default(),
            index_periods: Signal::default(),
            down: Signal::default(),
            passes_up: Signal::default(),
            passes_down: Signal::default(),
            from_period: Signal::default(),
            change: Signal::default(),
            next_period: Signal::default(),
            generated_a: Signal::default(),
            generated_b: Signal::default(),
            generated_z: Signal::default(),
            no_period: Constant::new(from_u64(0)),
            one_up: Constant::new(from_u64(1)),
            one_down: Constant::new(from_u64(0x3fff)),
        }
    }
}

impl Logic for EncoderGenerator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module encoder_generator");
        dff_setup!(self, clk, sum, period, line_a, line_b, line_z, moved);

        comment!("Counts, Q32.32");
        self.wide_rate.next = signed_bit_cast::<64, 32>(self.rate.val());
        self.next_sum.next = self.sum.q.val() + self.wide_rate.val();
        self.sum.d.next = self.next_sum.val();
        self.sum_bits.next = unsigned_cast(self.sum.q.val());
        self.next_bits.next = unsigned_cast(self.next_sum.val());

        comment!("Periods since the index; beyond a turn: 0");
        self.index_periods.next = self.index_every.val().get_bits::<14>(2);
        self.down.next = self.rate.val().get_bit(31);
        self.passes_up.next = !self.down.val()
            & self.sum_bits.val().get_bit(33)
            & self.sum_bits.val().get_bit(32)
            & !self.next_bits.val().get_bit(33);
        self.passes_down.next = self.down.val()
            & !self.sum_bits.val().get_bit(33)
            & !self.sum_bits.val().get_bit(32)
            & self.next_bits.val().get_bit(33);
        self.from_period.next = self.period.q.val();
        if self.passes_down.val() & !self.period.q.val().any() {
            self.from_period.next = self.index_periods.val();
        }
        self.change.next = self.no_period.val();
        if self.passes_up.val() {
            self.change.next = self.one_up.val();
        }
        if self.passes_down.val() {
            self.change.next = self.one_down.val();
        }
        self.next_period.next = self.from_period.val() + self.change.val();
        self.period.d.next = self.next_period.val();
        if self.next_period.val() >= self.index_periods.val() {
            self.period.d.next = self.no_period.val();
        }

        comment!("A and B in every other clock at most");
        self.next_a.next = self.sum_bits.val().get_bit(33) ^ self.sum_bits.val().get_bit(32);
        self.next_b.next = self.sum_bits.val().get_bit(33);
        self.next_z.next = !self.sum_bits.val().get_bit(33)
            & !self.sum_bits.val().get_bit(32)
            & !self.period.q.val().any()
            & self.index_periods.val().any();
        self.moved.d.next = false;
        if !self.moved.q.val() {
            self.line_a.d.next = self.next_a.val();
            self.line_b.d.next = self.next_b.val();
            self.line_z.d.next = self.next_z.val();
            self.moved.d.next = (self.next_a.val() ^ self.line_a.q.val()) | (self.next_b.val() ^ self.line_b.q.val());
        }

        comment!("Pins or lines, which a reset clears at once");
        self.generated_a.next = self.line_a.q.val() & !self.rst.val();
        self.generated_b.next = self.line_b.q.val() & !self.rst.val();
        self.generated_z.next = self.line_z.q.val() & !self.rst.val();
        self.shown_a.clk.next = self.clk.val();
        self.shown_b.clk.next = self.clk.val();
        self.shown_z.clk.next = self.clk.val();
        self.shown_a_n.clk.next = self.clk.val();
        self.shown_b_n.clk.next = self.clk.val();
        self.shown_z_n.clk.next = self.clk.val();
        self.shown_a.pin.next = self.pin_a.val();
        self.shown_b.pin.next = self.pin_b.val();
        self.shown_z.pin.next = self.pin_z.val();
        self.shown_a_n.pin.next = self.pin_a_n.val();
        self.shown_b_n.pin.next = self.pin_b_n.val();
        self.shown_z_n.pin.next = self.pin_z_n.val();
        if self.loop_back.val() {
            self.shown_a.pin.next = self.generated_a.val();
            self.shown_b.pin.next = self.generated_b.val();
            self.shown_z.pin.next = self.generated_z.val();
            self.shown_a_n.pin.next = !self.generated_a.val();
            self.shown_b_n.pin.next = !self.generated_b.val();
            self.shown_z_n.pin.next = !self.generated_z.val();
        }

        comment!("Outputs");
        self.a.next = self.shown_a.level.val();
        self.b.next = self.shown_b.level.val();
        self.z.next = self.shown_z.level.val();
        self.a_n.next = self.shown_a_n.level.val();
        self.b_n.next = self.shown_b_n.level.val();
        self.z_n.next = self.shown_z_n.level.val();
        self.generated_count.next = signed_cast(self.sum_bits.val().get_bits::<32>(32));
    }
}

impl Pins for EncoderGenerator {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[rst, loop_back, rate, index_every, a, b, z, a_n, b_n, z_n] = inputs else {
            return;
        };
        let bit = |value: u64| value & 1 != 0;
        self.rst.next = bit(rst);
        self.loop_back.next = bit(loop_back);
        self.rate.next = from_i64(rate as i64);
        self.index_every.next = from_u64(index_every);
        self.pin_a.next = bit(a);
        self.pin_b.next = bit(b);
        self.pin_z.next = bit(z);
        self.pin_a_n.next = bit(a_n);
        self.pin_b_n.next = bit(b_n);
        self.pin_z_n.next = bit(z_n);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            u64::from(self.a.val()),
            u64::from(self.b.val()),
            u64::from(self.z.val()),
            u64::from(self.a_n.val()),
            u64::from(self.b_n.val()),
            u64::from(self.z_n.val()),
            unsigned_cast(self.generated_count.val()).into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
