//! Receives bytes from the line: start bit, eight data bits, lowest first, stop bit.
//!
//! The line is sampled once in each eighth of a bit; its level is the majority of the last three samples. The first low
//! level begins a start bit. From there on a bit is taken every eight samples, in its middle.
//!
//! The line is inverted before its synchroniser, so that the reset value of the synchroniser, low, is an idle line.

use crate::prelude::*;

kernel! {
    pub(super) struct Receiver;

    inputs { rst: Bit, tick: Bit, uart_rx: Bit }
    outputs { data: Bits<8>, received: Bit, bad: Bit }
    parts { synchroniser: Synchroniser }
    registers {
        newer: Bit, older: Bit, receives: Bit, waits: Bit, eighth: Bits<3>, place: Bits<4>, data_q: Bits<8>,
        received_q: Bit, bad_q: Bit,
    }
    wires { look: Bit, low: Bit, takes: Bit }
    constants {
        first_eighth: Bits<3> = from_u64(0),
        middle: Bits<3> = from_u64(3),
        one_eighth: Bits<3> = from_u64(1),
        start_place: Bits<4> = from_u64(0),
        stop_place: Bits<4> = from_u64(9),
        one_place: Bits<4> = from_u64(1),
        high_bit: Bits<8> = from_u64(0x80),
    }
}

impl Logic for Receiver {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module uart_receiver");
        self.synchroniser.pin.next = !self.uart_rx.val();

        comment!("Majority of the last three samples");
        self.look.next = self.synchroniser.level.val();
        self.low.next = (self.look.val() & self.newer.q.val())
            | (self.look.val() & self.older.q.val())
            | (self.newer.q.val() & self.older.q.val());
        if self.tick.val() {
            self.newer.d.next = self.look.val();
            self.older.d.next = self.newer.q.val();
        }

        comment!("From the start bit to the middle of the stop bit");
        self.takes.next = self.tick.val() & self.receives.q.val() & (self.eighth.q.val() == self.middle.val());
        if self.tick.val() & self.receives.q.val() {
            self.eighth.d.next = self.eighth.q.val() + self.one_eighth.val();
        }
        if self.tick.val() & !self.receives.q.val() {
            if self.waits.q.val() {
                self.waits.d.next = self.low.val();
            } else {
                self.receives.d.next = self.low.val();
                self.eighth.d.next = self.first_eighth.val();
                self.place.d.next = self.start_place.val();
            }
        }
        self.received_q.d.next = false;
        self.bad_q.d.next = false;
        if self.takes.val() {
            self.place.d.next = self.place.q.val() + self.one_place.val();
            if self.place.q.val() == self.start_place.val() {
                self.receives.d.next = self.low.val();
            } else {
                if self.place.q.val() == self.stop_place.val() {
                    self.receives.d.next = false;
                    self.waits.d.next = self.low.val();
                    self.received_q.d.next = !self.low.val();
                    self.bad_q.d.next = self.low.val();
                } else {
                    self.data_q.d.next = self.data_q.q.val() >> 1;
                    if !self.low.val() {
                        self.data_q.d.next = (self.data_q.q.val() >> 1) | self.high_bit.val();
                    }
                }
            }
        }
        self.data.next = self.data_q.q.val();
        self.received.next = self.received_q.q.val();
        self.bad.next = self.bad_q.q.val();
    }
}
