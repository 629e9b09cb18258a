//! What the bridges of all lines share: from bytes to the bus and back.
//!
//! A bridge has a line, which hears and sends bytes, and [`Frames`]. The datasheet of the frames is `docs/uart_bridge.md`.

mod sequencer;

use self::sequencer::Sequencer;
use crate::link::{DELIMITER, FrameDecoder, FrameEnd};

/// Width of the time-out's counter in bits.
pub(super) const SILENCE_BITS: u32 = 20;

/// Outputs of a line's receiver in a clock.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Heard {
    /// A byte has come.
    pub(super) byte: Option<u8>,
    /// A byte was damaged.
    pub(super) bad: bool,
    /// A unit of the time-out is over.
    pub(super) tick: bool,
}

/// The registers' side of a bridge, and its constants.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Registers {
    pub(super) silence_limit: u32,
    pub(super) address_limit: u16,
    pub(super) readdata: u32,
    pub(super) waitrequest: bool,
}

/// The outputs to the registers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub(super) address: u16,
    pub(super) read: bool,
    pub(super) write: bool,
    pub(super) writedata: u32,
    pub(super) busy: bool,
    pub(super) frame_dropped: bool,
}

/// Decoder, sequencer and time-out.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Frames {
    frame: FrameDecoder,
    /// Units of the time-out since the last byte.
    silence: u32,
    /// A whole frame has ended.
    request: bool,
    frame_dropped: bool,
    dropped: u8,
    sequencer: Sequencer,
}

impl Frames {
    /// The outputs in a clock.
    pub(super) fn asked(&self, address_limit: u16) -> Asked {
        let accesses = self.sequencer.accesses(address_limit);
        let writes = self.frame.header().writes();
        Asked {
            address: self.sequencer.address,
            read: accesses && !writes,
            write: accesses && writes,
            writedata: self.sequencer.data,
            busy: self.sequencer.is_busy(),
            frame_dropped: self.frame_dropped,
        }
    }

    /// Simulates a clock. Returns the byte that is sent.
    pub(super) fn clock(&mut self, heard: Heard, registers: &Registers, sender_busy: bool) -> Option<u8> {
        let busy = self.sequencer.is_busy();
        let sent = self
            .sequencer
            .clock(self.request, (&self.frame, self.dropped), registers, sender_busy);
        if self.silence == registers.silence_limit {
            self.frame.expire();
        }
        if heard.bad {
            self.frame.spoil();
        }
        let end = heard.byte.and_then(|byte| {
            if busy && byte != DELIMITER {
                self.frame.spoil();
            }
            self.frame.byte(byte)
        });
        self.request = end == Some(FrameEnd::Whole);
        self.frame_dropped = end == Some(FrameEnd::Dropped);
        self.dropped = self.dropped.wrapping_add(u8::from(self.frame_dropped));
        self.silence = match heard.byte {
            Some(_) => 0,
            None => self.silence + u32::from(heard.tick && self.silence != registers.silence_limit),
        } & ((1 << SILENCE_BITS) - 1);
        sent
    }
}
