//! Checks a request, executes it, and writes and sends the reply.
//!
//! ```text
//! rest ─► judge ─► look at each address ─► head ─► access each word ─► tail ─► close ─► send ─► rest
//!           │                └──── wrong ───► head ────────────────────► tail
//!           └── executed before ─────────────────────────────────────────────────► send
//! ```
//!
//! The same states pass over the addresses twice: first, while `looks` is high, they only check each address; then they
//! access the words. A request with the sequence number of the last one was executed before, unless the number is 0:
//! its reply is sent again.

use crate::prelude::*;
use posicast_blocks::link::{LinkStatus, MOST_WORDS, VERSION};

kernel! {
    pub(crate) struct Sequencer;

    inputs {
        rst: Bit,
        request: Bit,
        length: Bits<8>,
        sequence_number: Bits<8>,
        command: Bits<8>,
        count: Bits<8>,
        request_data: Bits<8>,
        reply_data: Bits<8>,
        reply_bytes: Bits<8>,
        crc: Bits<32>,
        crc_idle: Bit,
        dropped_frames: Bits<8>,
        sender_busy: Bit,
        address_limit: Bits<16>,
        readdata: Bits<32>,
        waitrequest: Bit,
    }
    outputs {
        busy: Bit,
        read: Bit,
        write: Bit,
        address: Bits<16>,
        writedata: Bits<32>,
        read_address: Bits<8>,
        renew: Bit,
        put: Bit,
        put_data: Bits<8>,
        take: Bit,
        close: Bit,
        restart: Bit,
        send: Bit,
        send_data: Bits<8>,
    }
    registers {
        phase: Bits<4>, part: Bits<2>, looks: Bit, status: Bits<8>, last_sequence: Bits<8>, at: Bits<8>, ready: Bit,
        index: Bits<2>, words_left: Bits<8>, address_q: Bits<16>, data_q: Bits<32>,
    }
    wires {
        writes: Bit, lists: Bit, is_access: Bit, is_put: Bit, is_send: Bit, fetches: Bit, exists: Bit, accesses: Bit, accessed: Bit, repeats: Bit,
        known: Bit, words_bytes: Bits<8>, address_bytes: Bits<8>, wanted_length: Bits<8>, wrong_length: Bit,
        first_status: Bits<8>, puts: Bit, sends: Bit, fetched: Bits<8>, last_byte: Bit, fine: Bit, shifted: Bits<32>, is_tail: Bit,
        read_words: Bits<8>, at_end: Bit,
    }
    constants {
        rest: Bits<4> = from_u64(0),
        judge: Bits<4> = from_u64(1),
        address_low: Bits<4> = from_u64(2),
        address_high: Bits<4> = from_u64(3),
        word: Bits<4> = from_u64(4),
        access: Bits<4> = from_u64(5),
        next_word: Bits<4> = from_u64(6),
        head: Bits<4> = from_u64(7),
        put_bytes: Bits<4> = from_u64(8),
        tail: Bits<4> = from_u64(9),
        close_frame: Bits<4> = from_u64(10),
        send_frame: Bits<4> = from_u64(11),
        head_part: Bits<2> = from_u64(0),
        word_part: Bits<2> = from_u64(1),
        tail_part: Bits<2> = from_u64(2),
        version: Bits<6> = from_u64(u64::from(VERSION) << 2),
        first_index: Bits<2> = from_u64(0),
        last_index: Bits<2> = from_u64(3),
        one_index: Bits<2> = from_u64(1),
        none: Bits<8> = from_u64(0),
        one: Bits<8> = from_u64(1),
        most_words: Bits<8> = from_u64(u64::from(MOST_WORDS)),
        header_bytes: Bits<8> = from_u64(3),
        header_and_crc: Bits<8> = from_u64(7),
        one_address: Bits<8> = from_u64(2),
        next_address: Bits<16> = from_u64(1),
        unknown_command: Bits<8> = from_u64(LinkStatus::UnknownCommand as u64),
        wrong_length_status: Bits<8> = from_u64(LinkStatus::WrongLength as u64),
        wrong_address: Bits<8> = from_u64(LinkStatus::WrongAddress as u64),
        without_sequence: Bits<8> = from_u64(LinkStatus::WriteWithoutSequence as u64),
    }
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module bridge_sequencer");
        self.is_access.next = self.phase.q.val() == self.access.val();
        self.is_put.next = self.phase.q.val() == self.put_bytes.val();
        self.is_send.next = self.phase.q.val() == self.send_frame.val();
        self.is_tail.next = self.part.q.val() == self.tail_part.val();
        self.writes.next = self.command.val().get_bit(0);
        self.lists.next = self.command.val().get_bit(1);

        comment!("The header");
        self.known.next = self.command.val().get_bits::<6>(2) == self.version.val();
        self.words_bytes.next = self.none.val();
        if self.writes.val() {
            self.words_bytes.next = self.count.val() << 2;
        }
        self.address_bytes.next = self.one_address.val();
        if self.lists.val() {
            self.address_bytes.next = self.count.val() << 1;
        }
        self.wanted_length.next = self.header_and_crc.val() + self.address_bytes.val() + self.words_bytes.val();
        self.wrong_length.next = !self.count.val().any()
            | (self.count.val() > self.most_words.val())
            | (self.length.val() != self.wanted_length.val());
        self.first_status.next = self.none.val();
        if self.writes.val() & !self.sequence_number.val().any() {
            self.first_status.next = self.without_sequence.val();
        }
        if self.wrong_length.val() {
            self.first_status.next = self.wrong_length_status.val();
        }
        if !self.known.val() {
            self.first_status.next = self.unknown_command.val();
        }
        self.repeats.next =
            self.sequence_number.val().any() & (self.sequence_number.val() == self.last_sequence.q.val());
        self.fine.next = !self.status.q.val().any();
        self.renew.next = false;

        comment!("A byte of the request takes two clocks");
        self.fetches.next = (self.phase.q.val() == self.address_low.val())
            | (self.phase.q.val() == self.address_high.val())
            | (self.phase.q.val() == self.word.val());
        self.fetched.next = self.request_data.val();
        self.last_byte.next = self.index.q.val() == self.last_index.val();
        self.ready.d.next = self.fetches.val() & !self.ready.q.val();

        if (self.phase.q.val() == self.rest.val()) & self.request.val() {
            self.phase.d.next = self.judge.val();
        }
        if self.phase.q.val() == self.judge.val() {
            self.at.d.next = self.header_bytes.val();
            self.looks.d.next = true;
            self.words_left.d.next = self.count.val();
            self.index.d.next = self.first_index.val();
            if self.repeats.val() {
                self.at.d.next = self.none.val();
                self.phase.d.next = self.send_frame.val();
            } else {
                self.renew.next = true;
                self.last_sequence.d.next = self.sequence_number.val();
                self.status.d.next = self.first_status.val();
                self.phase.d.next = self.address_low.val();
                if self.first_status.val().any() {
                    self.phase.d.next = self.head.val();
                }
            }
        }
        if self.fetches.val() & self.ready.q.val() {
            self.at.d.next = self.at.q.val() + self.one.val();
            if self.phase.q.val() == self.address_low.val() {
                self.address_q.d.next = (bit_cast::<16, 8>(self.address_q.q.val().get_bits::<8>(8)) << 8)
                    | bit_cast::<16, 8>(self.fetched.val());
                self.phase.d.next = self.address_high.val();
            }
            if self.phase.q.val() == self.address_high.val() {
                self.address_q.d.next = (bit_cast::<16, 8>(self.fetched.val()) << 8)
                    | bit_cast::<16, 8>(self.address_q.q.val().get_bits::<8>(0));
                self.phase.d.next = self.access.val();
                if self.writes.val() {
                    self.phase.d.next = self.word.val();
                }
            }
            if self.phase.q.val() == self.word.val() {
                self.data_q.d.next = (self.data_q.q.val() >> 8) | (bit_cast::<32, 8>(self.fetched.val()) << 24);
                self.index.d.next = self.index.q.val() + self.one_index.val();
                if self.last_byte.val() {
                    self.phase.d.next = self.access.val();
                }
            }
        }

        comment!("Check the address, or access the word");
        self.exists.next = self.address_q.q.val() < self.address_limit.val();
        self.accesses.next = self.is_access.val() & !self.looks.q.val() & self.exists.val();
        self.accessed.next = self.accesses.val() & !self.waitrequest.val();
        if self.is_access.val() & self.looks.q.val() {
            self.phase.d.next = self.next_word.val();
        }
        if self.is_access.val() & !self.exists.val() {
            self.status.d.next = self.wrong_address.val();
            self.phase.d.next = self.head.val();
        }
        if self.accessed.val() {
            self.phase.d.next = self.next_word.val();
            if !self.writes.val() {
                self.data_q.d.next = self.readdata.val();
                self.part.d.next = self.word_part.val();
                self.phase.d.next = self.put_bytes.val();
            }
        }
        if self.phase.q.val() == self.next_word.val() {
            self.words_left.d.next = self.words_left.q.val() - self.one.val();
            if self.words_left.q.val() == self.one.val() {
                self.phase.d.next = self.tail.val();
                if self.looks.q.val() {
                    self.phase.d.next = self.head.val();
                }
            } else {
                if self.lists.val() {
                    self.phase.d.next = self.address_low.val();
                } else {
                    self.address_q.d.next = self.address_q.q.val() + self.next_address.val();
                    self.phase.d.next = self.access.val();
                    if self.writes.val() {
                        self.phase.d.next = self.word.val();
                    }
                }
            }
        }

        comment!("The reply: head, words, CRC");
        self.read_words.next = self.none.val();
        if self.fine.val() & !self.writes.val() {
            self.read_words.next = self.count.val();
        }
        if self.phase.q.val() == self.head.val() {
            self.data_q.d.next = (bit_cast::<32, 8>(self.dropped_frames.val()) << 24)
                | (bit_cast::<32, 8>(self.read_words.val()) << 16)
                | (bit_cast::<32, 8>(self.status.q.val()) << 8)
                | bit_cast::<32, 8>(self.sequence_number.val());
            self.part.d.next = self.head_part.val();
            self.phase.d.next = self.put_bytes.val();
        }
        self.puts.next = self.is_put.val() & self.crc_idle.val();
        self.shifted.next = self.data_q.q.val() >> 8;
        if self.puts.val() {
            self.data_q.d.next = self.shifted.val();
            self.index.d.next = self.index.q.val() + self.one_index.val();
            if self.last_byte.val() {
                self.phase.d.next = self.close_frame.val();
                if self.part.q.val() == self.word_part.val() {
                    self.phase.d.next = self.next_word.val();
                }
                if self.part.q.val() == self.head_part.val() {
                    self.phase.d.next = self.tail.val();
                    if self.fine.val() {
                        self.looks.d.next = false;
                        self.at.d.next = self.header_bytes.val();
                        self.words_left.d.next = self.count.val();
                        self.phase.d.next = self.address_low.val();
                    }
                }
            }
        }
        if (self.phase.q.val() == self.tail.val()) & self.crc_idle.val() {
            self.data_q.d.next = self.crc.val();
            self.part.d.next = self.tail_part.val();
            self.phase.d.next = self.put_bytes.val();
        }
        self.close.next = self.phase.q.val() == self.close_frame.val();
        if self.close.val() {
            self.at.d.next = self.none.val();
            self.phase.d.next = self.send_frame.val();
        }

        comment!("Send the reply, then a delimiter");
        self.at_end.next = self.at.q.val() == self.reply_bytes.val();
        self.sends.next = self.is_send.val() & self.ready.q.val() & !self.sender_busy.val();
        self.send_data.next = self.reply_data.val();
        if self.at_end.val() {
            self.send_data.next = self.none.val();
        }
        if self.is_send.val() {
            self.ready.d.next = !self.sends.val();
        }
        if self.sends.val() {
            self.at.d.next = self.at.q.val() + self.one.val();
            if self.at_end.val() {
                self.phase.d.next = self.rest.val();
            }
        }

        comment!("Outputs");
        self.busy.next = self.phase.q.val().any();
        self.read.next = self.accesses.val() & !self.writes.val();
        self.write.next = self.accesses.val() & self.writes.val();
        self.address.next = self.address_q.q.val();
        self.writedata.next = self.data_q.q.val();
        self.read_address.next = self.at.q.val();
        self.put.next = self.puts.val();
        self.put_data.next = self.data_q.q.val().get_bits::<8>(0);
        self.take.next = self.puts.val() & !self.is_tail.val();
        self.restart.next = self.renew.val() | self.is_send.val();
        self.send.next = self.sends.val();
    }
}
