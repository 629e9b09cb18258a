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
}

impl Logic for SpiBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module spi_bridge");
        self.line.clk.next = self.clk.val();
        self.line.rst.next = self.rst.val();
        self.decoder.clk.next = self.clk.val();
        self.decoder.rst.next = self.rst.val();
        self.crc.clk.next = self.clk.val();
        self.crc.rst.next = self.rst.val();
        self.sequencer.clk.next = self.clk.val();
        self.sequencer.rst.next = self.rst.val();
        self.reply.clk.next = self.clk.val();
        self.reply.rst.next = self.rst.val();

        comment!("A tick every 64 clocks, for the time-out");
        self.fraction.d.next = self.fraction.q.val() + self.one_clock.val();
        self.decoder.tick.next = self.fraction.q.val() == self.last_clock.val();

        comment!("Lines to request");
        self.line.spi_sck.next = self.spi_sck.val();
        self.line.spi_cs_n.next = self.spi_cs_n.val();
        self.line.spi_mosi.next = self.spi_mosi.val();
        self.decoder.received.next = self.line.received.val();
        self.decoder.data.next = self.line.data.val();
        self.decoder.bad.next = self.line.bad.val();
        self.decoder.busy.next = self.sequencer.busy.val();
        self.decoder.crc_holds.next = self.crc.holds.val();
        self.decoder.silence_limit.next = self.silence_limit.val();
        self.decoder.read_address.next = self.sequencer.read_address.val();
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
        self.sequencer.request.next = self.decoder.request.val();
        self.sequencer.length.next = self.decoder.length.val();
        self.sequencer.sequence_number.next = self.decoder.sequence_number.val();
        self.sequencer.command.next = self.decoder.command.val();
        self.sequencer.count.next = self.decoder.count.val();
        self.sequencer.request_data.next = self.decoder.read_data.val();
        self.sequencer.reply_data.next = self.reply.read_data.val();
        self.sequencer.reply_bytes.next = self.reply.bytes.val();
        self.sequencer.crc.next = self.crc.crc.val();
        self.sequencer.crc_idle.next = self.crc.idle.val();
        self.sequencer.dropped_frames.next = self.dropped.q.val();
        self.sequencer.sender_busy.next = self.line.busy.val();
        self.sequencer.address_limit.next = self.address_limit.val();
        self.sequencer.readdata.next = self.avm_readdata.val();
        self.sequencer.waitrequest.next = self.avm_waitrequest.val();
        self.reply.renew.next = self.sequencer.renew.val();
        self.reply.put.next = self.sequencer.put.val();
        self.reply.data.next = self.sequencer.put_data.val();
        self.reply.close.next = self.sequencer.close.val();
        self.reply.read_address.next = self.sequencer.read_address.val();
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
