//! The bridge: SPI lines, frames, bus.

use super::line::SpiLine;
use crate::link_frames::{Crc, FrameDecoder, Reply, Sequencer};
use crate::prelude::*;

kernel! {
    pub(super) struct SpiBridge;
    ports posicast_blocks::spi_bridge_ports;

    parts { line: SpiLine, decoder: FrameDecoder, crc: Crc, sequencer: Sequencer, reply: Reply }
    registers { fraction: Bits<6>, dropped: Bits<8> }
    constants {
        one_frame: Bits<8> = from_u64(1),
        one_clock: Bits<6> = from_u64(1),
        last_clock: Bits<6> = from_u64(63),
    }
    connect {
        line: spi_sck, spi_cs_n, spi_mosi;
        decoder from line: received, data, bad;
        decoder from sequencer: busy, read_address;
        decoder: silence_limit;
        sequencer from decoder: request, length, sequence_number, command, count;
        sequencer from crc: crc;
        sequencer: address_limit;
        reply from sequencer: renew, put, close, read_address;
    }
}

impl Logic for SpiBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module spi_bridge");

        comment!("A tick every 64 clocks, for the time-out");
        self.fraction.d.next = self.fraction.q.val() + self.one_clock.val();
        self.decoder.tick.next = self.fraction.q.val() == self.last_clock.val();

        comment!("Lines to request");
        self.decoder.crc_holds.next = self.crc.holds.val();
        if self.decoder.dropped.val() {
            self.dropped.d.next = self.dropped.q.val() + self.one_frame.val();
        }

        comment!("One CRC, for the request, then for the reply");
        self.crc.renew.next = self.decoder.ends.val() | self.sequencer.restart.val();
        self.crc.take.next = self.decoder.take.val() | self.sequencer.take.val();
        self.crc.data.next = self.decoder.value.val();
        if self.sequencer.busy.val() {
            self.crc.data.next = self.sequencer.put_data.val();
        }

        comment!("Request to bus and reply");
        self.sequencer.request_data.next = self.decoder.read_data.val();
        self.sequencer.reply_data.next = self.reply.read_data.val();
        self.sequencer.reply_bytes.next = self.reply.bytes.val();
        self.sequencer.crc_idle.next = self.crc.idle.val();
        self.sequencer.dropped_frames.next = self.dropped.q.val();
        self.sequencer.sender_busy.next = self.line.busy.val();
        self.sequencer.readdata.next = self.avm_readdata.val();
        self.sequencer.waitrequest.next = self.avm_waitrequest.val();
        self.reply.data.next = self.sequencer.put_data.val();
        self.line.start.next = self.sequencer.send.val();
        self.line.next_byte.next = self.sequencer.send_data.val();

        comment!("Outputs");
        self.spi_miso.next = self.line.spi_miso.val();
        self.avm_address.next = self.sequencer.address.val();
        self.avm_read.next = self.sequencer.read.val();
        self.avm_write.next = self.sequencer.write.val();
        self.avm_writedata.next = self.sequencer.writedata.val();
        self.busy.next = self.sequencer.busy.val();
        self.frame_dropped.next = self.decoder.dropped.val();
    }
}
