//! The bridge: serial line, frames, bus.

use super::receiver::Receiver;
use super::transmitter::Transmitter;
use crate::link_frames::{Crc, FrameDecoder, Reply, Sequencer};
use crate::prelude::*;

kernel! {
    pub(super) struct UartBridge;
    ports posicast_blocks::uart_bridge_ports;

    parts {
        receiver: Receiver, decoder: FrameDecoder, crc: Crc, sequencer: Sequencer, reply: Reply,
        transmitter: Transmitter,
    }
    registers { fraction: Bits<16>, tick: Bit, dropped: Bits<8> }
    wires { sum: Bits<17> }
    constants { one_frame: Bits<8> = from_u64(1) }
}

impl Logic for UartBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module uart_bridge");
        self.receiver.clk.next = self.clk.val();
        self.receiver.rst.next = self.rst.val();
        self.decoder.clk.next = self.clk.val();
        self.decoder.rst.next = self.rst.val();
        self.crc.clk.next = self.clk.val();
        self.crc.rst.next = self.rst.val();
        self.sequencer.clk.next = self.clk.val();
        self.sequencer.rst.next = self.rst.val();
        self.reply.clk.next = self.clk.val();
        self.reply.rst.next = self.rst.val();
        self.transmitter.clk.next = self.clk.val();
        self.transmitter.rst.next = self.rst.val();

        comment!("A tick in each eighth of a bit");
        self.sum.next = bit_cast::<17, 16>(self.fraction.q.val()) + bit_cast::<17, 16>(self.baud_step.val());
        self.fraction.d.next = self.sum.val().get_bits::<16>(0);
        self.tick.d.next = self.sum.val().get_bit(16);

        comment!("Line to request");
        self.receiver.tick.next = self.tick.q.val();
        self.receiver.uart_rx.next = self.uart_rx.val();
        self.decoder.tick.next = self.tick.q.val();
        self.decoder.received.next = self.receiver.received.val();
        self.decoder.data.next = self.receiver.data.val();
        self.decoder.bad.next = self.receiver.bad.val();
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
        self.sequencer.sender_busy.next = self.transmitter.busy.val();
        self.sequencer.address_limit.next = self.address_limit.val();
        self.sequencer.readdata.next = self.avm_readdata.val();
        self.sequencer.waitrequest.next = self.avm_waitrequest.val();
        self.reply.renew.next = self.sequencer.renew.val();
        self.reply.put.next = self.sequencer.put.val();
        self.reply.data.next = self.sequencer.put_data.val();
        self.reply.close.next = self.sequencer.close.val();
        self.reply.read_address.next = self.sequencer.read_address.val();

        comment!("Reply to line");
        self.transmitter.tick.next = self.tick.q.val();
        self.transmitter.start.next = self.sequencer.send.val();
        self.transmitter.data.next = self.sequencer.send_data.val();

        comment!("Outputs");
        self.uart_tx.next = self.transmitter.uart_tx.val();
        self.avm_address.next = self.sequencer.address.val();
        self.avm_read.next = self.sequencer.read.val();
        self.avm_write.next = self.sequencer.write.val();
        self.avm_writedata.next = self.sequencer.writedata.val();
        self.busy.next = self.sequencer.busy.val();
        self.frame_dropped.next = self.decoder.dropped.val();
    }
}
