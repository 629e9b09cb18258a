//! The sequencer: checks a request, executes it, and writes the reply.

use super::Registers;
use crate::link::{CRC_BYTES, Crc, FrameDecoder, LinkStatus, REPLY_HEADER_BYTES, REQUEST_HEADER_BYTES};

/// Clocks in which the CRC takes a byte.
const CRC_CLOCKS: u8 = 8;
/// Bytes of the memory for the reply.
const REPLY_MEMORY: usize = 256;

/// Action of the sequencer in a clock.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Rest,
    /// Looks at the header.
    Judge,
    AddressLow,
    AddressHigh,
    /// Fetches the word that is written.
    Word,
    /// Reads or writes, or looks at the address first.
    Access,
    /// Goes to the next word.
    Next,
    /// Begins the reply.
    Head,
    /// Appends the bytes of `data` to the reply.
    Put,
    /// Waits for the CRC of the reply.
    Tail,
    /// Puts the last distance of COBS into the reply.
    Close,
    Send,
}

/// Bytes that `Put` appends to the reply.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Part {
    #[default]
    Head,
    Word,
    Tail,
}

/// All registers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Sequencer {
    phase: Phase,
    part: Part,
    /// The first pass over a request: no accesses, only its addresses are checked.
    looks: bool,
    status: LinkStatus,
    last_sequence: u8,
    /// Place in the request or in the reply that is read.
    at: usize,
    /// The memory has the byte at `at`.
    ready: bool,
    /// Byte of a word.
    index: u8,
    words_left: u8,
    pub(super) address: u16,
    pub(super) data: u32,
    crc: Crc,
    crc_left: u8,
    reply: [u8; REPLY_MEMORY],
    /// Place of the distance to the next 0, and of the next byte.
    code_at: u8,
    put_at: u8,
}

impl Default for Sequencer {
    fn default() -> Self {
        Self {
            phase: Phase::Rest,
            part: Part::Head,
            looks: false,
            status: LinkStatus::Ok,
            last_sequence: 0,
            at: 0,
            ready: false,
            index: 0,
            words_left: 0,
            address: 0,
            data: 0,
            crc: Crc::default(),
            crc_left: 0,
            reply: [0; REPLY_MEMORY],
            code_at: 0,
            put_at: 0,
        }
    }
}

impl Sequencer {
    pub(super) fn is_busy(&self) -> bool {
        self.phase != Phase::Rest
    }

    /// Whether it accesses the bus, which needs a valid address.
    pub(super) fn accesses(&self, address_limit: u16) -> bool {
        self.phase == Phase::Access && !self.looks && self.address < address_limit
    }

    /// Simulates a clock. `request` is high after the end of a whole frame. Returns the byte that is sent.
    pub(super) fn clock(
        &mut self,
        request: bool,
        (frame, dropped): (&FrameDecoder, u8),
        registers: &Registers,
        sender_busy: bool,
    ) -> Option<u8> {
        let crc_left = self.crc_left;
        self.crc_left = crc_left.saturating_sub(1);
        let ready = self.ready;
        self.ready = false;
        let header = frame.header();
        match self.phase {
            Phase::Rest => {
                if request {
                    self.phase = Phase::Judge;
                }
            }
            Phase::Judge => {
                self.at = REQUEST_HEADER_BYTES;
                self.looks = true;
                self.words_left = header.count;
                (self.index, self.crc) = (0, Crc::default());
                if header.sequence != 0 && header.sequence == self.last_sequence {
                    self.at = 0;
                    self.phase = Phase::Send;
                } else {
                    self.last_sequence = header.sequence;
                    (self.code_at, self.put_at) = (0, 1);
                    self.status = header.status(frame.bytes().len());
                    self.phase = if self.status.is_ok() {
                        Phase::AddressLow
                    } else {
                        Phase::Head
                    };
                }
            }
            Phase::AddressLow | Phase::AddressHigh | Phase::Word => {
                self.ready = !ready;
                if ready {
                    self.fetched(frame.bytes().get(self.at).copied().unwrap_or(0), header.writes());
                    self.at += 1;
                }
            }
            Phase::Access => {
                let exists = self.address < registers.address_limit;
                if self.looks || !exists {
                    self.phase = Phase::Next;
                    if !exists {
                        self.status = LinkStatus::WrongAddress;
                        self.phase = Phase::Head;
                    }
                } else if !registers.waitrequest {
                    self.phase = Phase::Next;
                    if !header.writes() {
                        self.data = registers.readdata;
                        self.part = Part::Word;
                        self.phase = Phase::Put;
                    }
                }
            }
            Phase::Next => {
                self.words_left -= 1;
                if self.words_left == 0 {
                    self.phase = if self.looks { Phase::Head } else { Phase::Tail };
                } else if header.lists() {
                    self.phase = Phase::AddressLow;
                } else {
                    self.address = self.address.wrapping_add(1);
                    self.phase = if header.writes() { Phase::Word } else { Phase::Access };
                }
            }
            Phase::Head => {
                let words = if self.status.is_ok() && !header.writes() {
                    header.count
                } else {
                    0
                };
                let head: [u8; REPLY_HEADER_BYTES] = [header.sequence, self.status as u8, words, dropped];
                self.data = u32::from_le_bytes(head);
                self.part = Part::Head;
                self.phase = Phase::Put;
            }
            Phase::Put => {
                if crc_left == 0 {
                    self.put(header.count);
                }
            }
            Phase::Tail => {
                if crc_left == 0 {
                    self.data = self.crc.value();
                    self.part = Part::Tail;
                    self.phase = Phase::Put;
                }
            }
            Phase::Close => {
                self.reply[usize::from(self.code_at)] = self.put_at.wrapping_sub(self.code_at);
                self.at = 0;
                self.phase = Phase::Send;
            }
            Phase::Send => {
                self.ready = true;
                if ready && !sender_busy {
                    return Some(self.sent());
                }
            }
        }
        None
    }

    /// Takes a byte of the request.
    fn fetched(&mut self, byte: u8, writes: bool) {
        let byte_above = |word: u32| (word >> 8) | (u32::from(byte) << 24);
        match self.phase {
            Phase::AddressLow => {
                self.address = (self.address & 0xff00) | u16::from(byte);
                self.phase = Phase::AddressHigh;
            }
            Phase::AddressHigh => {
                self.address = (self.address & 0x00ff) | (u16::from(byte) << 8);
                self.phase = if writes { Phase::Word } else { Phase::Access };
            }
            _ => {
                self.data = byte_above(self.data);
                self.index = (self.index + 1) % 4;
                if self.index == 0 {
                    self.phase = Phase::Access;
                }
            }
        }
    }

    /// Puts a byte of `data` into the reply.
    fn put(&mut self, count: u8) {
        let byte = self.data as u8;
        let put_at = usize::from(self.put_at);
        if byte == 0 {
            self.reply[usize::from(self.code_at)] = self.put_at.wrapping_sub(self.code_at);
            self.code_at = self.put_at;
        } else {
            self.reply[put_at] = byte;
        }
        self.put_at = self.put_at.wrapping_add(1);
        self.data >>= 8;
        if self.part != Part::Tail {
            self.crc.add(byte);
            self.crc_left = CRC_CLOCKS;
        }
        self.index = (self.index + 1) % CRC_BYTES as u8;
        if self.index != 0 {
            return;
        }
        self.phase = match self.part {
            Part::Head if self.status.is_ok() => {
                self.looks = false;
                self.at = REQUEST_HEADER_BYTES;
                self.words_left = count;
                Phase::AddressLow
            }
            Part::Head => Phase::Tail,
            Part::Word => Phase::Next,
            Part::Tail => Phase::Close,
        };
    }

    /// The next byte of the reply, or the delimiter behind it.
    fn sent(&mut self) -> u8 {
        self.ready = false;
        if self.at == usize::from(self.put_at) {
            self.phase = Phase::Rest;
            return crate::link::DELIMITER;
        }
        self.at += 1;
        self.reply[self.at - 1]
    }
}
