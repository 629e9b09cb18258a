//! What the bridges of all lines share: from bytes to the bus and back, in hardware.
//!
//! A bridge joins a line, which gives and takes bytes, with these four. The reference is `posicast_blocks::link_frames`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `decoder` | COBS of the request, which it stores |
//! | `crc` | the checksum of both |
//! | `sequencer` | checks, executes, replies |
//! | `reply` | COBS of the reply, which it stores |

mod crc;
mod decoder;
mod reply;
mod sequencer;

pub(crate) use crc::Crc;
pub(crate) use decoder::FrameDecoder;
pub(crate) use reply::Reply;
pub(crate) use sequencer::Sequencer;
