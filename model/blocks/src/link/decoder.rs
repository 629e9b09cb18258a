//! The bridge's decoder of frames. It takes the line byte by byte, valid or not.

use super::cobs::UNUSED_CODE;
use super::{Crc, DELIMITER, MOST_REQUEST_BYTES, RequestHeader};

/// State of the frame that a delimiter ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameEnd {
    /// A frame whose CRC holds.
    Whole,
    /// A damaged frame.
    Dropped,
    /// No frame: the delimiter follows another one.
    Empty,
}

/// Takes the line byte by byte. The bytes before a delimiter do not affect the decoding after it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameDecoder {
    /// Bytes until the next code.
    left: u8,
    /// Whether a byte of the frame has come.
    begun: bool,
    /// The frame is damaged: the rest of it is ignored.
    skips: bool,
    crc: Crc,
    length: usize,
    bytes: [u8; MOST_REQUEST_BYTES],
}

impl Default for FrameDecoder {
    fn default() -> Self {
        Self {
            left: 0,
            begun: false,
            skips: false,
            crc: Crc::default(),
            length: 0,
            bytes: [0; MOST_REQUEST_BYTES],
        }
    }
}

impl FrameDecoder {
    /// Takes a byte. For a delimiter it returns the state of the frame; the bytes of a whole frame are available from
    /// [`Self::bytes`] until the next byte.
    pub fn byte(&mut self, byte: u8) -> Option<FrameEnd> {
        if byte == DELIMITER {
            let whole = self.begun && !self.skips && self.left == 0 && self.crc.holds();
            let empty = !self.begun && !self.skips;
            (self.left, self.begun, self.skips, self.crc) = (0, false, false, Crc::default());
            return Some(match (whole, empty) {
                (true, _) => FrameEnd::Whole,
                (_, true) => FrameEnd::Empty,
                _ => FrameEnd::Dropped,
            });
        }
        if !self.skips {
            if !self.begun {
                self.length = 0;
            }
            if self.left > 0 {
                self.left -= 1;
                self.push(byte);
            } else {
                if self.begun {
                    self.push(0);
                }
                self.left = byte - 1;
                self.skips |= byte == UNUSED_CODE;
            }
            self.begun = true;
        }
        None
    }

    fn push(&mut self, byte: u8) {
        match self.bytes.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
                self.crc.add(byte);
            }
            None => self.skips = true,
        }
    }

    /// The frame is damaged: a byte without its stop bit, a byte while the bridge is busy.
    pub fn spoil(&mut self) {
        self.skips = true;
    }

    /// A byte did not come in time: the frame, if one has begun, is damaged.
    pub fn expire(&mut self) {
        self.skips |= self.begun;
    }

    /// Whether a byte of a frame has come.
    pub fn has_begun(&self) -> bool {
        self.begun
    }

    /// The bytes of the frame, decoded.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// The first bytes of the frame; those that have not come are those of the frame before.
    pub fn header(&self) -> RequestHeader {
        let [sequence, command, count, ..] = self.bytes;
        RequestHeader {
            sequence,
            command,
            count,
        }
    }
}
