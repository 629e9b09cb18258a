//! The internal encoder: a sum of 64 bits, whose upper half is the count; the lowest two bits of the count give A and
//! B.

use crate::prelude::*;

kernel! {
    pub(super) struct EncoderGenerator;
    ports posicast_blocks::encoder_generator_ports;

    registers { sum: Signed<64>, period: Bits<14>, line_a: Bit, line_b: Bit, line_z: Bit, moved: Bit }
    parts {
        shown_a: PinRegister,
        shown_b: PinRegister,
        shown_z: PinRegister,
        shown_a_n: PinRegister,
        shown_b_n: PinRegister,
        shown_z_n: PinRegister,
    }
    wires {
        sum_bits: Bits<64>, next_sum: Signed<64>, next_bits: Bits<64>, wide_rate: Signed<64>, next_a: Bit,
        next_b: Bit, next_z: Bit, index_periods: Bits<14>, down: Bit, passes_up: Bit, passes_down: Bit,
        from_period: Bits<14>, change: Bits<14>, next_period: Bits<14>, generated_a: Bit, generated_b: Bit,
        generated_z: Bit,
    }
    constants {
        no_period: Bits<14> = from_u64(0),
        one_up: Bits<14> = from_u64(1),
        one_down: Bits<14> = from_u64(0x3fff),
    }
}

impl Logic for EncoderGenerator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module encoder_generator");

        comment!("Counts, Q32.32");
        self.wide_rate.next = signed_bit_cast::<64, 32>(self.rate.val());
        self.next_sum.next = self.sum.q.val() + self.wide_rate.val();
        self.sum.d.next = self.next_sum.val();
        self.sum_bits.next = unsigned_cast(self.sum.q.val());
        self.next_bits.next = unsigned_cast(self.next_sum.val());

        comment!("Periods since the index; 0 after the last one");
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

        comment!("A and B change in every other clock at most");
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

        comment!("Pins or lines; a reset clears the lines at once");
        self.generated_a.next = self.line_a.q.val() & !self.rst.val();
        self.generated_b.next = self.line_b.q.val() & !self.rst.val();
        self.generated_z.next = self.line_z.q.val() & !self.rst.val();
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
