//! What an absolute encoder sends: its protocol, the bits of a frame, and their order.

use super::AbsoluteEncoderConfigError;
use std::ops::RangeInclusive;

/// Bits of a position.
pub const POSITION_BITS: RangeInclusive<u32> = 8..=40;
/// Most bits before the position, and most between the position and the check.
pub const MOST_OTHER_BITS: u32 = 16;

/// How encoder and block talk.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AbsoluteProtocol {
    /// Synchronous serial interface: the first falling edge holds the position, a bit follows each rising edge.
    #[default]
    Ssi,
    /// BiSS C, unidirectional, one encoder: the first rising edge holds the position; answer, start bit and a bit 0 precede the frame.
    BissC,
}

impl AbsoluteProtocol {
    /// Name in Verilog and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ssi => "ssi",
            Self::BissC => "biss_c",
        }
    }
}

/// What protects a frame. Each check is over all bits before it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FrameCheck {
    /// Nothing.
    #[default]
    None,
    /// A bit that makes the number of ones even.
    EvenParity,
    /// A bit that makes the number of ones odd.
    OddParity,
    /// CRC of x^6 + x + 1 from 0, inverted, most significant bit first: that of BiSS.
    Crc6,
}

impl FrameCheck {
    /// Name in Verilog and documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "unchecked",
            Self::EvenParity => "even",
            Self::OddParity => "odd",
            Self::Crc6 => "crc6",
        }
    }

    /// Bits of the check.
    pub fn bits(self) -> u32 {
        match self {
            Self::None => 0,
            Self::EvenParity | Self::OddParity => 1,
            Self::Crc6 => 6,
        }
    }
}

/// One of the bits behind the position that says how the encoder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameStatusBit {
    /// Its place: 0 is the first bit behind the position.
    pub place: u32,
    /// Low says that something is wrong.
    pub active_low: bool,
}

/// The bits of a frame, in the order in which they come: leading bits, position, trailing bits, check.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AbsoluteFrame {
    /// Bits before the position, whose values do not matter.
    pub leading_bits: u32,
    /// Bits of the position, turns and place in the turn together, most significant first.
    pub position_bits: u32,
    /// Bits behind the position.
    pub trailing_bits: u32,
    /// The position is in Gray code.
    pub gray: bool,
    /// What protects the frame.
    pub check: FrameCheck,
    /// The trailing bit that says that the position is wrong.
    pub error: Option<FrameStatusBit>,
    /// The trailing bit that says that the encoder wants care.
    pub warning: Option<FrameStatusBit>,
}

impl AbsoluteFrame {
    /// A position in binary code, and nothing else.
    pub fn ssi(position_bits: u32) -> Self {
        Self {
            position_bits,
            ..Self::default()
        }
    }

    /// The frame of BiSS-C: position, error and warning (active low), CRC.
    pub fn biss_c(position_bits: u32) -> Self {
        let active_low = |place| {
            Some(FrameStatusBit {
                place,
                active_low: true,
            })
        };
        Self {
            position_bits,
            trailing_bits: 2,
            check: FrameCheck::Crc6,
            error: active_low(0),
            warning: active_low(1),
            ..Self::default()
        }
    }

    /// Bits of a frame, without what precedes a frame of BiSS.
    pub fn bits(&self) -> u32 {
        self.leading_bits + self.position_bits + self.trailing_bits + self.check.bits()
    }

    pub(super) fn checked(&self, protocol: AbsoluteProtocol) -> Result<(), AbsoluteEncoderConfigError> {
        use AbsoluteEncoderConfigError as Wrong;

        if !POSITION_BITS.contains(&self.position_bits) {
            return Err(Wrong::PositionBits(self.position_bits));
        }
        for (name, bits) in [("leading", self.leading_bits), ("trailing", self.trailing_bits)] {
            if bits > MOST_OTHER_BITS {
                return Err(Wrong::OtherBits { name, bits });
            }
        }
        for (name, bit) in [("error", self.error), ("warning", self.warning)] {
            if let Some(FrameStatusBit { place, .. }) = bit
                && place >= self.trailing_bits
            {
                return Err(Wrong::StatusPlace {
                    name,
                    place,
                    trailing_bits: self.trailing_bits,
                });
            }
        }
        if protocol == AbsoluteProtocol::BissC && self.check != FrameCheck::Crc6 {
            return Err(Wrong::BissCheck(self.check.name()));
        }
        Ok(())
    }
}
