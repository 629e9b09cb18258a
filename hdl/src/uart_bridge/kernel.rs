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
    connect {
        receiver: uart_rx;
        decoder from receiver: received, data, bad;
        decoder from sequencer: busy, read_address;
        decoder: silence_limit;
        sequencer from decoder: request, length, sequence_number, command, count;
        sequencer from crc: crc;
        sequencer: address_limit;
        reply from sequencer: renew, put, close, read_address;
    }
}

impl Logic for UartBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module uart_bridge");

        comment!("A tick in each eighth of a bit");
        self.sum.next = bit_cast::<17, 16>(self.fraction.q.val()) + bit_cast::<17, 16>(self.baud_step.val());
        self.fraction.d.next = self.sum.val().get_bits::<16>(0);
        self.tick.d.next = self.sum.val().get_bit(16);

        comment!("Line to request");
        self.receiver.tick.next = self.tick.q.val();
        self.decoder.tick.next = self.tick.q.val();
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
        self.sequencer.sender_busy.next = self.transmitter.busy.val();
        self.sequencer.readdata.next = self.avm_readdata.val();
        self.sequencer.waitrequest.next = self.avm_waitrequest.val();
        self.reply.data.next = self.sequencer.put_data.val();

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
