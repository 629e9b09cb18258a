//! Requests of a host.

use super::{CRC_BYTES, Crc, DELIMITER, LinkStatus, MOST_WORDS, REQUEST_HEADER_BYTES, VERSION, cobs};

/// Bit of a command: words are written, not read.
pub(super) const WRITES: u8 = 1;
/// Bit of a command: each word has its own address.
pub(super) const LISTS: u8 = 2;

/// A request of a host. Addresses count words, as in the register tables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Request {
    /// Reads words at consecutive addresses.
    Read {
        /// The first address.
        address: u16,
        /// Number of words.
        count: u8,
    },
    /// Writes words at consecutive addresses.
    Write {
        /// The first address.
        address: u16,
        /// The words.
        words: Vec<u32>,
    },
    /// Reads a word at each of these addresses, in this order.
    ReadList(Vec<u16>),
    /// Writes a word at each of these addresses, in this order. An address may occur several times.
    WriteList(Vec<(u16, u32)>),
}

/// Why a request cannot be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// No words, or too many.
    #[error("a request of {0} words: it has 1 to {MOST_WORDS}; send several requests")]
    Words(usize),
    /// A write with the sequence number 0.
    #[error("a write with the sequence number 0, which is for reads: write with 1 to 255")]
    Sequence,
}

impl Request {
    /// The command: the protocol's version, and the bits above.
    pub fn command(&self) -> u8 {
        VERSION << 4
            | match self {
                Self::Read { .. } => 0,
                Self::Write { .. } => WRITES,
                Self::ReadList(_) => LISTS,
                Self::WriteList(_) => WRITES | LISTS,
            }
    }

    /// Number of words that are read or written.
    pub fn words(&self) -> usize {
        match self {
            Self::Read { count, .. } => usize::from(*count),
            Self::Write { words, .. } => words.len(),
            Self::ReadList(addresses) => addresses.len(),
            Self::WriteList(pairs) => pairs.len(),
        }
    }

    /// Whether it writes.
    pub fn is_write(&self) -> bool {
        self.command() & WRITES != 0
    }

    /// The bytes of its frame on the line, with the 00 that ends it.
    ///
    /// # Errors
    /// [`RequestError`] for no words or more than [`MOST_WORDS`], and for a write with the sequence number 0.
    pub fn encode(&self, sequence: u8) -> Result<Vec<u8>, RequestError> {
        let words = self.words();
        let count = u8::try_from(words)
            .ok()
            .filter(|count| (1..=MOST_WORDS).contains(count));
        let count = count.ok_or(RequestError::Words(words))?;
        if self.is_write() && sequence == 0 {
            return Err(RequestError::Sequence);
        }
        let mut bytes = vec![sequence, self.command(), count];
        match self {
            Self::Read { address, .. } => bytes.extend(address.to_le_bytes()),
            Self::Write { address, words } => {
                bytes.extend(address.to_le_bytes());
                bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
            }
            Self::ReadList(addresses) => bytes.extend(addresses.iter().flat_map(|address| address.to_le_bytes())),
            Self::WriteList(pairs) => {
                for (address, word) in pairs {
                    bytes.extend(address.to_le_bytes());
                    bytes.extend(word.to_le_bytes());
                }
            }
        }
        bytes.extend(Crc::of(&bytes).to_le_bytes());
        // At most 247 bytes, which COBS takes.
        let mut frame = cobs::encode(&bytes).ok_or(RequestError::Words(words))?;
        frame.push(DELIMITER);
        Ok(frame)
    }
}

/// The first bytes of a request, as the bridge reads them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RequestHeader {
    /// Sequence number.
    pub sequence: u8,
    /// Command.
    pub command: u8,
    /// Number of words.
    pub count: u8,
}

impl RequestHeader {
    /// Whether words are written.
    pub fn writes(&self) -> bool {
        self.command & WRITES != 0
    }

    /// Whether each word has its own address.
    pub fn lists(&self) -> bool {
        self.command & LISTS != 0
    }

    /// Bytes of a request with this header before it is encoded, 16 bits; meaningful for a known command.
    pub fn bytes(&self) -> usize {
        let addresses = if self.lists() { usize::from(self.count) } else { 1 };
        let words = if self.writes() { usize::from(self.count) } else { 0 };
        REQUEST_HEADER_BYTES + 2 * addresses + 4 * words + CRC_BYTES
    }

    /// Judges a request of `length` bytes, whose CRC holds, before its addresses are looked at.
    pub fn status(&self, length: usize) -> LinkStatus {
        if self.command & !(WRITES | LISTS) != VERSION << 4 {
            LinkStatus::UnknownCommand
        } else if !(1..=MOST_WORDS).contains(&self.count) || length != self.bytes() {
            LinkStatus::WrongLength
        } else if self.writes() && self.sequence == 0 {
            LinkStatus::WriteWithoutSequence
        } else {
            LinkStatus::Ok
        }
    }
}
