//! Sends bytes on the line: start bit, eight data bits, lowest first, stop bit. Each bit takes eight ticks.

use crate::prelude::*;

kernel! {
    pub(super) struct Transmitter;

    inputs { rst: Bit, tick: Bit, start: Bit, data: Bits<8> }
    outputs { uart_tx: Bit, busy: Bit }
    registers { bits: Bits<10>, left: Bits<4>, eighth: Bits<3>, line: Bit = true }
    wires { sends: Bit }
    constants {
        first_eighth: Bits<3> = from_u64(0),
        last_eighth: Bits<3> = from_u64(7),
        one_eighth: Bits<3> = from_u64(1),
        all_bits: Bits<4> = from_u64(10),
        one_bit: Bits<4> = from_u64(1),
        stop_bit: Bits<10> = from_u64(0x200),
    }
}

impl Logic for Transmitter {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module uart_transmitter");
        self.sends.next = self.left.q.val().any();
        if self.sends.val() {
            if self.tick.val() {
                self.eighth.d.next = self.eighth.q.val() + self.one_eighth.val();
                if self.eighth.q.val() == self.first_eighth.val() {
                    self.line.d.next = self.bits.q.val().get_bit(0);
                    self.bits.d.next = self.bits.q.val() >> 1;
                }
                if self.eighth.q.val() == self.last_eighth.val() {
                    self.left.d.next = self.left.q.val() - self.one_bit.val();
                }
            }
        } else {
            if self.start.val() {
                self.bits.d.next = (bit_cast::<10, 8>(self.data.val()) << 1) | self.stop_bit.val();
                self.left.d.next = self.all_bits.val();
            }
        }
        self.uart_tx.next = self.line.q.val();
        self.busy.next = self.sends.val();
    }
}
