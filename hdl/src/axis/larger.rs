//! Compares two numbers byte by byte, lowest first: the result of a bit depends on both numbers' bits and on the
//! result of the bits below.

use crate::prelude::*;

kernel! {
    /// The result is valid in the clock after the last byte, in which `compares` is low; it is cleared one clock later.
    pub(super) struct Larger;

    inputs {
        rst: Bit,
        /// A byte is present.
        compares: Bit,
        /// The byte is the highest one of signed numbers.
        signs: Bit,
        /// The complement of `number` is compared.
        inverts: Bit,
        number: Bits<8>,
        other: Bits<8>,
    }
    outputs { larger: Bit }
    registers { larger_q: Bit }
    wires {
        one: Bits<8>, neither: Bits<8>, above: Bits<8>, above_0: Bit, above_1: Bit, above_2: Bit,
        above_3: Bit, above_4: Bit, above_5: Bit, above_6: Bit, higher: Bit, not_lower: Bit,
    }
}

impl Logic for Larger {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_larger");
        self.one.next = self.number.val();
        if self.inverts.val() {
            self.one.next = !self.number.val();
        }
        comment!("Bits that are larger, and bits not smaller");
        self.above.next = self.one.val() & !self.other.val();
        self.neither.next = self.one.val() | !self.other.val();
        self.above_0.next = self.above.val().get_bit(0) | (self.neither.val().get_bit(0) & self.larger_q.q.val());
        self.above_1.next = self.above.val().get_bit(1) | (self.neither.val().get_bit(1) & self.above_0.val());
        self.above_2.next = self.above.val().get_bit(2) | (self.neither.val().get_bit(2) & self.above_1.val());
        self.above_3.next = self.above.val().get_bit(3) | (self.neither.val().get_bit(3) & self.above_2.val());
        self.above_4.next = self.above.val().get_bit(4) | (self.neither.val().get_bit(4) & self.above_3.val());
        self.above_5.next = self.above.val().get_bit(5) | (self.neither.val().get_bit(5) & self.above_4.val());
        self.above_6.next = self.above.val().get_bit(6) | (self.neither.val().get_bit(6) & self.above_5.val());
        comment!("The sign bit has the opposite weight");
        self.higher.next = self.above.val().get_bit(7);
        self.not_lower.next = self.neither.val().get_bit(7);
        if self.signs.val() {
            self.higher.next = !self.neither.val().get_bit(7);
            self.not_lower.next = !self.above.val().get_bit(7);
        }
        self.larger_q.d.next = self.higher.val() | (self.not_lower.val() & self.above_6.val());
        if !self.compares.val() {
            self.larger_q.d.next = false;
        }
        self.larger.next = self.larger_q.q.val();
    }
}
