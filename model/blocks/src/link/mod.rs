//! The host link: requests and replies in frames over a serial line, through which a host reads and writes registers.
//!
//! This module is the one source of the frames' layout. The host's library encodes and decodes with it, the byte-exact
//! model of the bridge ([`LinkBridge`]) answers with it, and the cycle-accurate model of the hardware
//! (`rtl::uart_bridge`) takes its constants from here. The datasheet is `docs/uart_bridge.md`.
//!
//! ```text
//!  request   sequence | command | count | addresses and words | CRC-32        at most 247 bytes
//!  reply     sequence | status  | count | dropped | words     | CRC-32        at most 168 bytes
//!  on the line: COBS(bytes) 00      a 00 ends every frame and occurs nowhere else; an empty frame is ignored
//! ```
//!
//! - Numbers are little-endian: addresses 16 bits, words and the CRC 32.
//! - The CRC is that of IEEE 802.3 (`zlib`, `crc32` of Python's `binascii`) over all bytes before it.
//! - A frame that is damaged gets no reply and does nothing. The host sends it again after a while, *with the same
//!   sequence number*: if the bridge has already executed it, it repeats its reply and executes nothing.
//! - A host begins with the sequence number 0 and a read; then it uses 1 to 255, 1 to 255, and so on. A request with 0 is always
//!   executed, so a write with 0 is refused: it could be executed twice.
//! - A request whose CRC holds is executed completely or not at all: all of it is checked before the first word is read
//!   or written.
//!
//! | part | what it does |
//! |---|---|
//! | [`cobs`] | consistent overhead byte stuffing: bytes without 00 |
//! | [`Crc`] | the checksum |
//! | [`Request`], [`Reply`] | what the frames contain |
//! | [`FrameDecoder`] | takes the line byte by byte, as the bridge does |
//! | [`LinkBridge`] | the bridge, byte by byte: bytes in, bus accesses, bytes out |
//!
//! ```
//! use posicast_blocks::link::{Bus, LinkBridge, Reply, Request};
//! # struct Registers([u32; 8]);
//! # impl Bus for Registers {
//! #     fn read(&mut self, address: u16) -> u32 { self.0[usize::from(address)] }
//! #     fn write(&mut self, address: u16, word: u32) { self.0[usize::from(address)] = word; }
//! # }
//!
//! let mut registers = Registers([0; 8]);
//! let mut bridge = LinkBridge::new(8);
//! let frame = Request::Write { address: 2, words: vec![7, 9] }.encode(1)?;
//! let answer = frame.iter().find_map(|byte| bridge.byte(*byte, &mut registers)).unwrap_or_default();
//! assert_eq!(registers.0[2..4], [7, 9]);
//! let reply = Reply::decode(&answer[..answer.len() - 1])?;
//! assert_eq!((reply.sequence, reply.status.is_ok()), (1, true));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bridge;
pub mod cobs;
mod crc;
mod decoder;
mod reply;
mod request;

pub use bridge::{Bus, LinkBridge};
pub use crc::{CRC_START, Crc, POLYNOMIAL, RESIDUE};
pub use decoder::{FrameDecoder, FrameEnd};
pub use reply::{LinkStatus, Reply, ReplyError};
pub use request::{Request, RequestError, RequestHeader};

/// Ends every frame, and occurs nowhere else.
pub const DELIMITER: u8 = 0;
/// Most words of a request.
pub const MOST_WORDS: u8 = 40;
/// Bytes of a request before its addresses and words.
pub const REQUEST_HEADER_BYTES: usize = 3;
/// Bytes of a reply before its words.
pub const REPLY_HEADER_BYTES: usize = 4;
/// Bytes of the CRC.
pub const CRC_BYTES: usize = 4;
/// Bytes of the longest request before it is encoded: 40 words, each with its address.
pub const MOST_REQUEST_BYTES: usize = REQUEST_HEADER_BYTES + 6 * MOST_WORDS as usize + CRC_BYTES;
/// Bytes of the longest reply before it is encoded.
pub const MOST_REPLY_BYTES: usize = REPLY_HEADER_BYTES + 4 * MOST_WORDS as usize + CRC_BYTES;
/// Version of the protocol; the upper half of every command.
pub const VERSION: u8 = 1;
