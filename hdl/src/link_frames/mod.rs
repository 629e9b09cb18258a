//! The common part of the bridges of all lines in hardware: it turns bytes into bus accesses and back.
//!
//! A bridge connects a line, which receives and sends bytes, to these four kernels. The reference is
//! `posicast_blocks::link_frames`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `decoder` | decodes the COBS of a request, and stores it |
//! | `crc` | computes the CRC of request and reply |
//! | `sequencer` | checks and executes the request, and writes and sends the reply |
//! | `reply` | encodes the reply in COBS, and stores it |

mod crc;
mod decoder;
mod reply;
mod sequencer;

pub(crate) use crc::Crc;
pub(crate) use decoder::FrameDecoder;
pub(crate) use reply::Reply;
pub(crate) use sequencer::Sequencer;
