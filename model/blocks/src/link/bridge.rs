//! The bridge, byte by byte: the behaviour of the hardware without its timing.

use super::{CRC_BYTES, FrameDecoder, FrameEnd, LinkStatus, REQUEST_HEADER_BYTES, Reply};

/// The registers that a bridge reads and writes.
pub trait Bus {
    /// Reads a word.
    fn read(&mut self, address: u16) -> u32;
    /// Writes a word.
    fn write(&mut self, address: u16, word: u32);
}

/// The bridge. It answers a request before it takes the next byte.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkBridge {
    decoder: FrameDecoder,
    /// Addresses below it exist.
    address_limit: u16,
    /// Sequence number of the request that was executed last; 0: none that could be repeated.
    last_sequence: u8,
    /// Its reply, as it is on the line.
    last_reply: Vec<u8>,
    dropped: u8,
}

impl LinkBridge {
    /// A bridge after reset, for registers with addresses below `address_limit`.
    pub fn new(address_limit: u16) -> Self {
        Self {
            decoder: FrameDecoder::default(),
            address_limit,
            last_sequence: 0,
            last_reply: Vec::new(),
            dropped: 0,
        }
    }

    /// Takes a byte from the line, and executes the request that it completes. Returns the bytes of the reply.
    pub fn byte(&mut self, byte: u8, bus: &mut impl Bus) -> Option<Vec<u8>> {
        match self.decoder.byte(byte)? {
            FrameEnd::Whole => Some(self.answer(bus)),
            FrameEnd::Dropped => {
                self.dropped = self.dropped.wrapping_add(1);
                None
            }
            FrameEnd::Empty => None,
        }
    }

    /// A byte came without its stop bit.
    pub fn bad_byte(&mut self) {
        self.decoder.spoil();
    }

    /// No byte has come for the time-out.
    pub fn silence(&mut self) {
        self.decoder.expire();
    }

    /// Number of frames dropped since the reset, modulo 256.
    pub fn dropped(&self) -> u8 {
        self.dropped
    }

    fn answer(&mut self, bus: &mut impl Bus) -> Vec<u8> {
        let header = self.decoder.header();
        if header.sequence == 0 || header.sequence != self.last_sequence {
            self.last_sequence = header.sequence;
            let bytes = self.decoder.bytes();
            let mut status = header.status(bytes.len());
            let accesses = if status.is_ok() {
                accesses(bytes, header)
            } else {
                Vec::new()
            };
            if accesses.iter().any(|(address, _)| *address >= self.address_limit) {
                status = LinkStatus::WrongAddress;
            }
            let mut words = Vec::new();
            if status.is_ok() {
                for (address, word) in accesses {
                    match word {
                        Some(word) => bus.write(address, word),
                        None => words.push(bus.read(address)),
                    }
                }
            }
            let (sequence, dropped) = (header.sequence, self.dropped);
            let reply = Reply {
                sequence,
                status,
                dropped,
                words,
            };
            self.last_reply = reply.encode();
        }
        self.last_reply.clone()
    }
}

/// The addresses of a request, each with the word that is written.
fn accesses(bytes: &[u8], header: super::RequestHeader) -> Vec<(u16, Option<u32>)> {
    let mut rest = bytes[REQUEST_HEADER_BYTES..bytes.len() - CRC_BYTES]
        .iter()
        .map(|byte| u32::from(*byte));
    let mut number = |bytes: u32| (0..bytes).fold(0, |number, place| number | rest.next().unwrap_or(0) << (8 * place));
    let mut address = 0_u16;
    let access = |index: u8| {
        address = if index == 0 || header.lists() {
            number(2) as u16
        } else {
            address.wrapping_add(1)
        };
        (address, header.writes().then(|| number(4)))
    };
    (0..header.count).map(access).collect()
}
