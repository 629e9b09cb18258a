//! AXI4-Lite to registers: addresses, words and answers wait in queues; an access begins where all that it needs is there.

use super::queue::Queue;
use crate::prelude::*;

kernel! {
    pub(super) struct AxiLiteBridge;
    ports posicast_blocks::axi_lite_bridge_ports;

    parts {
        write_addresses: Queue<16>,
        write_words: Queue<36>,
        write_answers: Queue<2>,
        read_addresses: Queue<16>,
        read_words: Queue<34>,
        read_answers: Queue<34>,
    }
    registers { awake: Bit, open_reads: Bits<3>, read_first: Bit, reading: Bit, failed: Bit }
    wires {
        can_write: Bit, can_read: Bit, writes: Bit, reads: Bit, answered: Bit, moves: Bit, bytes: Bits<4>,
        wide_word: Bits<36>, wide_data: Bits<34>, read_answer: Bits<2>,
    }
    constants {
        one: Bits<3> = from_u64(1),
        okay: Bits<2> = from_u64(0),
        slverr: Bits<2> = from_u64(2),
    }
}

impl Logic for AxiLiteBridge {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axi_lite_bridge");
        comment!("Nothing is taken in the clock after a reset");
        self.awake.d.next = true;
        self.s_axi_awready.next = self.awake.q.val() & !self.write_addresses.full.val();
        self.s_axi_wready.next = self.awake.q.val() & !self.write_words.full.val();
        self.s_axi_arready.next = self.awake.q.val() & !self.read_addresses.full.val();

        comment!("A write and a read that wait take turns");
        self.can_write.next =
            self.write_addresses.holds.val() & self.write_words.holds.val() & !self.write_answers.full.val();
        self.can_read.next = self.read_addresses.holds.val() & !self.open_reads.q.val().get_bit(2);
        self.writes.next = self.can_write.val() & !(self.read_first.q.val() & self.can_read.val());
        self.reads.next = self.can_read.val() & (self.read_first.q.val() | !self.can_write.val());
        if self.writes.val() | self.reads.val() {
            self.read_first.d.next = self.writes.val();
        }

        comment!("Writes");
        self.write_addresses.put.next = self.awake.q.val() & self.s_axi_awvalid.val();
        self.write_addresses.entry.next = self.s_axi_awaddr.val().get_bits::<16>(2);
        self.write_addresses.take.next = self.writes.val();
        self.wide_word.next = bit_cast::<36, 32>(self.s_axi_wdata.val());
        self.write_words.put.next = self.awake.q.val() & self.s_axi_wvalid.val();
        self.write_words.entry.next = (self.wide_word.val() << 4) | bit_cast::<36, 4>(self.s_axi_wstrb.val());
        self.write_words.take.next = self.writes.val();
        self.write_answers.put.next = self.writes.val();
        self.write_answers.entry.next = self.okay.val();
        if !self.avm_mapped.val() {
            self.write_answers.entry.next = self.slverr.val();
        }
        self.write_answers.take.next = self.s_axi_bready.val();
        self.s_axi_bresp.next = self.write_answers.first.val();
        self.s_axi_bvalid.next = self.write_answers.holds.val();

        comment!("Reads: the registers answer a clock later");
        self.read_addresses.put.next = self.awake.q.val() & self.s_axi_arvalid.val();
        self.read_addresses.entry.next = self.s_axi_araddr.val().get_bits::<16>(2);
        self.read_addresses.take.next = self.reads.val();
        self.reading.d.next = self.reads.val();
        self.failed.d.next = !self.avm_mapped.val();
        self.read_answer.next = self.okay.val();
        if self.failed.q.val() {
            self.read_answer.next = self.slverr.val();
        }
        self.wide_data.next = bit_cast::<34, 32>(self.avm_readdata.val());
        self.read_words.put.next = self.reading.q.val();
        self.read_words.entry.next = (self.wide_data.val() << 2) | bit_cast::<34, 2>(self.read_answer.val());
        self.moves.next = self.read_words.holds.val() & !self.read_answers.full.val();
        self.read_words.take.next = self.moves.val();
        self.read_answers.put.next = self.moves.val();
        self.read_answers.entry.next = self.read_words.first.val();
        self.read_answers.take.next = self.s_axi_rready.val();
        self.s_axi_rdata.next = self.read_answers.first.val().get_bits::<32>(2);
        self.s_axi_rresp.next = self.read_answers.first.val().get_bits::<2>(0);
        self.s_axi_rvalid.next = self.read_answers.holds.val();

        comment!("No more reads than the queues hold");
        self.answered.next = self.read_answers.holds.val() & self.s_axi_rready.val();
        if self.reads.val() & !self.answered.val() {
            self.open_reads.d.next = self.open_reads.q.val() + self.one.val();
        }
        if self.answered.val() & !self.reads.val() {
            self.open_reads.d.next = self.open_reads.q.val() - self.one.val();
        }

        comment!("The access");
        self.avm_address.next = self.read_addresses.first.val();
        if self.writes.val() {
            self.avm_address.next = self.write_addresses.first.val();
        }
        self.bytes.next = self.write_words.first.val().get_bits::<4>(0);
        self.avm_read.next = self.reads.val();
        self.avm_write.next = self.writes.val() & self.bytes.val().any();
        self.avm_byteenable.next = self.bytes.val();
        self.avm_writedata.next = self.write_words.first.val().get_bits::<32>(4);
    }
}
