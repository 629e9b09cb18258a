//! Replies of the bridge.

use super::{CRC_BYTES, Crc, DELIMITER, REPLY_HEADER_BYTES, cobs};

/// Result of a request.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, thiserror::Error)]
pub enum LinkStatus {
    /// 0: it was executed.
    #[default]
    #[error("executed")]
    Ok,
    /// 1: the bridge does not know the command; perhaps it has another version of the protocol.
    #[error("the bridge does not know the command: host and bridge have different versions of the protocol")]
    UnknownCommand,
    /// 2: no words, more than [`MOST_WORDS`](super::MOST_WORDS), or a frame whose length does not fit to their number.
    #[error("the number of words does not match the frame's length")]
    WrongLength,
    /// 3: an address beyond the registers. Nothing was read or written.
    #[error("an address beyond the registers")]
    WrongAddress,
    /// 4: a write with the sequence number 0.
    #[error("a write with the sequence number 0")]
    WriteWithoutSequence,
}

impl LinkStatus {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::Ok,
        Self::UnknownCommand,
        Self::WrongLength,
        Self::WrongAddress,
        Self::WriteWithoutSequence,
    ];

    /// Whether the request was executed.
    pub fn is_ok(self) -> bool {
        self == Self::Ok
    }
}

/// A reply of the bridge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// Sequence number of the request.
    pub sequence: u8,
    /// Result of the request.
    pub status: LinkStatus,
    /// Number of frames that the bridge has dropped since its reset, modulo 256.
    pub dropped: u8,
    /// The words that were read.
    pub words: Vec<u32>,
}

/// Why a frame is no reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// Not encoded as a frame: bytes are missing or too many.
    #[error("the reply has too few or too many bytes")]
    Frame,
    /// The CRC does not hold.
    #[error("the reply's checksum is wrong")]
    Crc,
    /// The contents are not those of a reply, although the CRC holds.
    #[error("the received bytes are not a reply of this protocol: is something else on the line?")]
    Contents,
}

impl Reply {
    /// The bytes of its frame on the line, with the 00 that ends it. Of more than
    /// [`MOST_WORDS`](super::MOST_WORDS) words the last ones are left out.
    pub fn encode(&self) -> Vec<u8> {
        let words = &self.words[..self.words.len().min(usize::from(super::MOST_WORDS))];
        let mut bytes = vec![self.sequence, self.status as u8, words.len() as u8, self.dropped];
        bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend(Crc::of(&bytes).to_le_bytes());
        let mut frame = cobs::encode(&bytes).unwrap_or_default();
        frame.push(DELIMITER);
        frame
    }

    /// Decodes a frame, without the 00 that ends it.
    ///
    /// # Errors
    /// [`ReplyError`] if it is damaged or no reply.
    pub fn decode(frame: &[u8]) -> Result<Self, ReplyError> {
        let bytes = cobs::decode(frame).ok_or(ReplyError::Frame)?;
        let (contents, crc) = bytes.split_last_chunk::<CRC_BYTES>().ok_or(ReplyError::Frame)?;
        if Crc::of(contents) != u32::from_le_bytes(*crc) {
            return Err(ReplyError::Crc);
        }
        let (&[sequence, status, count, dropped], words) = contents
            .split_first_chunk::<REPLY_HEADER_BYTES>()
            .ok_or(ReplyError::Contents)?;
        let status = LinkStatus::ALL.get(usize::from(status)).ok_or(ReplyError::Contents)?;
        let (words, rest) = words.as_chunks::<4>();
        if words.len() != usize::from(count) || !rest.is_empty() {
            return Err(ReplyError::Contents);
        }
        Ok(Self {
            sequence,
            status: *status,
            dropped,
            words: words.iter().map(|word| u32::from_le_bytes(*word)).collect(),
        })
    }
}
