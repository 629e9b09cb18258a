//! Stores the reply, and encodes it with COBS while its bytes come, one per clock at most.
//!
//! Place 0 is reserved for the distance to the first 0. A 0 is not stored: its place is reserved for the distance to
//! the next 0, and the distance to itself goes to the place that was reserved before. `close` writes the last distance,
//! to the end of the frame.

use crate::prelude::*;

kernel! {
    pub(crate) struct Reply;

    inputs { rst: Bit, renew: Bit, put: Bit, data: Bits<8>, close: Bit, read_address: Bits<8> }
    outputs { bytes: Bits<8>, read_data: Bits<8> }
    parts { memory: Ram<8, 8> }
    registers { code_at: Bits<8>, put_at: Bits<8> }
    wires { codes: Bit }
    constants { first: Bits<8> = from_u64(0), second: Bits<8> = from_u64(1), one: Bits<8> = from_u64(1) }
}

impl Logic for Reply {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module reply_frame");
        self.codes.next = self.close.val() | !self.data.val().any();
        self.memory.write_enable.next = self.put.val() | self.close.val();
        self.memory.write_address.next = self.put_at.q.val();
        self.memory.write_data.next = self.data.val();
        if self.codes.val() {
            self.memory.write_address.next = self.code_at.q.val();
            self.memory.write_data.next = self.put_at.q.val() - self.code_at.q.val();
        }
        if self.put.val() {
            self.put_at.d.next = self.put_at.q.val() + self.one.val();
            if self.codes.val() {
                self.code_at.d.next = self.put_at.q.val();
            }
        }
        if self.renew.val() {
            self.code_at.d.next = self.first.val();
            self.put_at.d.next = self.second.val();
        }
        self.memory.read_address.next = self.read_address.val();
        self.bytes.next = self.put_at.q.val();
        self.read_data.next = self.memory.read_data.val();
    }
}
