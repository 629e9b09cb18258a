//! Exchanges bytes with the host as an SPI peripheral, in mode 0, most significant bit first.
//!
//! The lines are sampled in every clock, behind synchronisers of equal length. So a bit is the level of `spi_mosi` in
//! the clock that shows the rising edge of `spi_sck`. A byte for the host is kept until the host takes its first bit:
//! it is not lost if the selection ends before.

use crate::prelude::*;

kernel! {
    pub(super) struct SpiLine;

    inputs { rst: Bit, spi_sck: Bit, spi_cs_n: Bit, spi_mosi: Bit, start: Bit, next_byte: Bits<8> }
    outputs { spi_miso: Bit, busy: Bit, data: Bits<8>, received: Bit, bad: Bit }
    parts { sck: Synchroniser, selected: Synchroniser, mosi: Synchroniser }
    registers {
        sck_before: Bit, selected_before: Bit, place: Bits<3>, taken: Bits<8>, received_q: Bit, bad_q: Bit,
        given: Bits<8>, gives: Bit, waiting: Bits<8>, full: Bit,
    }
    wires { is_selected: Bit, rises: Bit, falls: Bit, first: Bit, loads: Bit, taken_bit: Bits<8> }
    constants {
        first_place: Bits<3> = from_u64(0),
        last_place: Bits<3> = from_u64(7),
        one_place: Bits<3> = from_u64(1),
        nothing: Bits<8> = from_u64(0),
        lowest_bit: Bits<8> = from_u64(1),
    }
}

impl Logic for SpiLine {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module spi_line");
        self.sck.pin.next = self.spi_sck.val();
        self.selected.pin.next = !self.spi_cs_n.val();
        self.mosi.pin.next = self.spi_mosi.val();

        comment!("Edges while selected");
        self.is_selected.next = self.selected.level.val() & self.selected_before.q.val();
        self.rises.next = self.is_selected.val() & self.sck.level.val() & !self.sck_before.q.val();
        self.falls.next = self.is_selected.val() & !self.sck.level.val() & self.sck_before.q.val();
        self.sck_before.d.next = self.sck.level.val();
        self.selected_before.d.next = self.selected.level.val();
        self.first.next = self.place.q.val() == self.first_place.val();

        comment!("From the host");
        self.taken_bit.next = self.nothing.val();
        if self.mosi.level.val() {
            self.taken_bit.next = self.lowest_bit.val();
        }
        self.received_q.d.next = self.rises.val() & (self.place.q.val() == self.last_place.val());
        self.bad_q.d.next = !self.selected.level.val() & !self.first.val();
        if self.rises.val() {
            self.taken.d.next = (self.taken.q.val() << 1) | self.taken_bit.val();
            self.place.d.next = self.place.q.val() + self.one_place.val();
        }

        comment!("To the host: a byte that waits, or 0");
        self.loads.next =
            (self.selected.level.val() & !self.selected_before.q.val()) | (self.falls.val() & self.first.val());
        if self.falls.val() {
            self.given.d.next = self.given.q.val() << 1;
        }
        if self.loads.val() {
            self.given.d.next = self.nothing.val();
            if self.full.q.val() {
                self.given.d.next = self.waiting.q.val();
            }
            self.gives.d.next = self.full.q.val();
        }
        if self.rises.val() & self.first.val() {
            self.gives.d.next = false;
            if self.gives.q.val() {
                self.full.d.next = false;
            }
        }
        if self.start.val() & !self.full.q.val() {
            self.waiting.d.next = self.next_byte.val();
            self.full.d.next = true;
        }
        if !self.selected.level.val() {
            self.place.d.next = self.first_place.val();
            self.given.d.next = self.nothing.val();
            self.gives.d.next = false;
        }

        self.spi_miso.next = self.given.q.val().get_bit(7);
        self.busy.next = self.full.q.val();
        self.data.next = self.taken.q.val();
        self.received.next = self.received_q.q.val();
        self.bad.next = self.bad_q.q.val();
    }
}
