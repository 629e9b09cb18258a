//! The frame of a reading, bit by bit: position, status, check.

use super::config::AbsoluteEncoderConfig;
use super::frame::FrameCheck;
use super::line::TakenBit;

/// x^6 + x + 1 without its highest term.
const POLYNOMIAL: u8 = 0b11;
const CRC_TOP: u8 = 1 << 5;

/// What has come of a frame.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct FrameWord {
    pub(super) position: u64,
    crc: u8,
    odd: bool,
    pub(super) error: bool,
    pub(super) warning: bool,
}

impl FrameWord {
    /// Takes a bit.
    pub(super) fn take(&mut self, config: &AbsoluteEncoderConfig, TakenBit { level, place }: TakenBit) {
        let frame = config.frame();
        let behind = place - frame.position_bits as i32;
        if place >= 0 && behind < 0 {
            let bit = level ^ (frame.gray && self.position & 1 == 1);
            self.position = self.position << 1 | u64::from(bit);
        }
        for (bit, seen) in [(frame.error, &mut self.error), (frame.warning, &mut self.warning)] {
            if let Some(bit) = bit
                && behind == bit.place as i32
            {
                *seen = level != bit.active_low;
            }
        }
        self.odd ^= level;
        // The CRC is sent inverted.
        let is_check = behind >= frame.trailing_bits as i32;
        let feedback = (self.crc & CRC_TOP != 0) != (level != is_check);
        self.crc = (self.crc << 1 ^ if feedback { POLYNOMIAL } else { 0 }) & (2 * CRC_TOP - 1);
    }

    /// Whether the check of a whole frame is wrong.
    pub(super) fn is_wrong(&self, config: &AbsoluteEncoderConfig) -> bool {
        match config.frame().check {
            FrameCheck::None => false,
            FrameCheck::EvenParity => self.odd,
            FrameCheck::OddParity => !self.odd,
            FrameCheck::Crc6 => self.crc != 0,
        }
    }
}
