//! Decodes frames and stores the request: COBS, length, time-out.
//!
//! `left` is the number of bytes before the next code of COBS; each code except the first stands for a 0. A damaged
//! frame is skipped up to its end. A delimiter begins a new frame, whatever came before it.

use crate::prelude::*;
use posicast_blocks::link::MOST_REQUEST_BYTES;

kernel! {
    pub(crate) struct FrameDecoder;

    inputs {
        rst: Bit,
        tick: Bit,
        received: Bit,
        data: Bits<8>,
        bad: Bit,
        busy: Bit,
        crc_holds: Bit,
        silence_limit: Bits<20>,
        read_address: Bits<8>,
    }
    outputs {
        request: Bit,
        dropped: Bit,
        ends: Bit,
        take: Bit,
        value: Bits<8>,
        length: Bits<8>,
        sequence_number: Bits<8>,
        command: Bits<8>,
        count: Bits<8>,
        read_data: Bits<8>,
    }
    parts { memory: Ram<8, 8> }
    registers {
        left: Bits<8>, begun: Bit, skips: Bit, length_q: Bits<8>, silence: Bits<20>, request_q: Bit, dropped_q: Bit,
        sequence_q: Bits<8>, command_q: Bits<8>, count_q: Bits<8>,
    }
    wires {
        delimiter: Bit, expired: Bit, spoilt: Bit, taken: Bit, is_code: Bit, emits: Bit, full: Bit, place: Bits<8>,
        decoded: Bits<8>, whole: Bit, stored: Bit,
    }
    constants {
        none: Bits<8> = from_u64(0),
        one: Bits<8> = from_u64(1),
        second: Bits<8> = from_u64(1),
        third: Bits<8> = from_u64(2),
        unused_code: Bits<8> = from_u64(0xff),
        most: Bits<8> = from_u64(MOST_REQUEST_BYTES as u64),
        no_silence: Bits<20> = from_u64(0),
        one_eighth: Bits<20> = from_u64(1),
    }
}

impl Logic for FrameDecoder {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module frame_decoder");

        comment!("Time since the last byte");
        self.expired.next = self.silence.q.val() == self.silence_limit.val();
        if self.tick.val() & !self.expired.val() {
            self.silence.d.next = self.silence.q.val() + self.one_eighth.val();
        }
        if self.received.val() {
            self.silence.d.next = self.no_silence.val();
        }

        comment!("A byte is a code or data");
        self.delimiter.next = self.received.val() & !self.data.val().any();
        self.spoilt.next = self.skips.q.val() | self.bad.val() | (self.expired.val() & self.begun.q.val());
        self.taken.next = self.received.val() & self.data.val().any() & !self.spoilt.val() & !self.busy.val();
        self.is_code.next = self.taken.val() & !self.left.q.val().any();
        self.emits.next = self.taken.val() & (self.left.q.val().any() | self.begun.q.val());
        self.decoded.next = self.data.val();
        if self.is_code.val() {
            self.decoded.next = self.none.val();
        }
        if self.taken.val() {
            self.begun.d.next = true;
            self.left.d.next = self.left.q.val() - self.one.val();
            if self.is_code.val() {
                self.left.d.next = self.data.val() - self.one.val();
            }
        }

        comment!("Store the decoded byte, and keep the header");
        self.place.next = self.length_q.q.val();
        if !self.begun.q.val() {
            self.place.next = self.none.val();
        }
        self.full.next = self.begun.q.val() & (self.length_q.q.val() == self.most.val());
        self.stored.next = self.emits.val() & !self.full.val();
        if self.taken.val() {
            self.length_q.d.next = self.place.val();
        }
        if self.stored.val() {
            self.length_q.d.next = self.place.val() + self.one.val();
            if self.place.val() == self.none.val() {
                self.sequence_q.d.next = self.decoded.val();
            }
            if self.place.val() == self.second.val() {
                self.command_q.d.next = self.decoded.val();
            }
            if self.place.val() == self.third.val() {
                self.count_q.d.next = self.decoded.val();
            }
        }
        self.memory.write_enable.next = self.stored.val();
        self.memory.write_address.next = self.place.val();
        self.memory.write_data.next = self.decoded.val();
        self.memory.read_address.next = self.read_address.val();

        comment!("Damage lasts until a delimiter");
        self.skips.d.next = self.spoilt.val()
            | (self.received.val() & self.busy.val())
            | (self.emits.val() & self.full.val())
            | (self.is_code.val() & (self.data.val() == self.unused_code.val()));
        self.whole.next = self.delimiter.val()
            & self.begun.q.val()
            & !self.spoilt.val()
            & !self.left.q.val().any()
            & self.crc_holds.val();
        self.request_q.d.next = self.whole.val();
        self.dropped_q.d.next = self.delimiter.val() & (self.begun.q.val() | self.spoilt.val()) & !self.whole.val();
        if self.delimiter.val() {
            self.skips.d.next = false;
            self.begun.d.next = false;
            self.left.d.next = self.none.val();
        }

        comment!("Outputs");
        self.request.next = self.request_q.q.val();
        self.dropped.next = self.dropped_q.q.val();
        self.ends.next = self.delimiter.val() & !self.busy.val();
        self.take.next = self.stored.val();
        self.value.next = self.decoded.val();
        self.length.next = self.length_q.q.val();
        self.sequence_number.next = self.sequence_q.q.val();
        self.command.next = self.command_q.q.val();
        self.count.next = self.count_q.q.val();
        self.read_data.next = self.memory.read_data.val();
    }
}
