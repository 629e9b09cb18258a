//! CRC-32 of IEEE 802.3, a bit per clock, lowest first.

use crate::prelude::*;
use posicast_blocks::link::{CRC_START, POLYNOMIAL, RESIDUE};

kernel! {
    pub(crate) struct Crc;

    inputs { rst: Bit, renew: Bit, take: Bit, data: Bits<8> }
    outputs { crc: Bits<32>, holds: Bit, idle: Bit }
    registers { sum: Bits<32> = from_u64(u64::from(CRC_START)), bits: Bits<8>, left: Bits<4> }
    wires { feedback: Bit, shifts: Bit }
    constants {
        first_sum: Bits<32> = from_u64(u64::from(CRC_START)),
        polynomial: Bits<32> = from_u64(u64::from(POLYNOMIAL)),
        residue: Bits<32> = from_u64(u64::from(RESIDUE)),
        no_bits: Bits<4> = from_u64(0),
        all_bits: Bits<4> = from_u64(8),
        one_bit: Bits<4> = from_u64(1),
    }
}

impl Logic for Crc {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module crc32");
        self.shifts.next = self.left.q.val().any();
        self.feedback.next = self.sum.q.val().get_bit(0) ^ self.bits.q.val().get_bit(0);
        if self.shifts.val() {
            self.sum.d.next = self.sum.q.val() >> 1;
            if self.feedback.val() {
                self.sum.d.next = (self.sum.q.val() >> 1) ^ self.polynomial.val();
            }
            self.bits.d.next = self.bits.q.val() >> 1;
            self.left.d.next = self.left.q.val() - self.one_bit.val();
        }
        if self.take.val() {
            self.bits.d.next = self.data.val();
            self.left.d.next = self.all_bits.val();
        }
        if self.renew.val() {
            self.sum.d.next = self.first_sum.val();
            self.left.d.next = self.no_bits.val();
        }
        self.crc.next = !self.sum.q.val();
        self.holds.next = self.sum.q.val() == self.residue.val();
        self.idle.next = !self.shifts.val();
    }
}
