//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck, FrameStatusBit,
};

use super::AbsoluteEncoderBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

/// Short lines of SSI: a reading of few clocks.
const SHORT_SSI: AbsoluteTimes = AbsoluteTimes {
    half_period_clocks: 2,
    pause_clocks: 16,
    answer_clocks: 0,
};
/// Short lines of BiSS, whose delay may still be several bits.
const SHORT_BISS: AbsoluteTimes = AbsoluteTimes {
    half_period_clocks: 2,
    pause_clocks: 32,
    answer_clocks: 48,
};
const FEW: AbsoluteLimits = AbsoluteLimits {
    largest_jump: 20,
    tolerated: 2,
};

/// Eight bits in Gray code with parity and status bits.
pub(super) fn small_ssi() -> Result<AbsoluteEncoderConfig, Error> {
    let frame = AbsoluteFrame {
        leading_bits: 1,
        trailing_bits: 2,
        gray: true,
        check: FrameCheck::EvenParity,
        error: Some(FrameStatusBit {
            place: 0,
            active_low: false,
        }),
        warning: Some(FrameStatusBit {
            place: 1,
            active_low: true,
        }),
        ..AbsoluteFrame::ssi(8)
    };
    AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, SHORT_SSI, FEW).map_err(refused)
}

/// Eight bits.
pub(super) fn small_biss() -> Result<AbsoluteEncoderConfig, Error> {
    AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(8), SHORT_BISS, FEW).map_err(refused)
}

/// The largest and the simplest of SSI, and a long frame of BiSS.
pub(super) fn others() -> Result<[AbsoluteEncoderConfig; 3], Error> {
    let largest = AbsoluteFrame {
        leading_bits: 3,
        trailing_bits: 16,
        check: FrameCheck::OddParity,
        error: Some(FrameStatusBit {
            place: 15,
            active_low: true,
        }),
        ..AbsoluteFrame::ssi(40)
    };
    let slow = AbsoluteTimes {
        half_period_clocks: 9,
        pause_clocks: 90,
        answer_clocks: 0,
    };
    let wide = AbsoluteLimits {
        largest_jump: (1 << 29) - 1,
        tolerated: 3,
    };
    let none = AbsoluteLimits {
        largest_jump: 500,
        tolerated: 0,
    };
    let long = AbsoluteFrame {
        leading_bits: 2,
        trailing_bits: 5,
        ..AbsoluteFrame::biss_c(32)
    };
    let fast = AbsoluteTimes {
        half_period_clocks: 5,
        pause_clocks: 80,
        answer_clocks: 150,
    };
    let new =
        |protocol, frame, times, limits| AbsoluteEncoderConfig::new(protocol, frame, times, limits).map_err(refused);
    Ok([
        new(AbsoluteProtocol::Ssi, largest, slow, wide)?,
        new(AbsoluteProtocol::Ssi, AbsoluteFrame::ssi(12), SHORT_SSI, none)?,
        new(AbsoluteProtocol::BissC, long, fast, FEW)?,
    ])
}

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let [largest, simple, long] = others()?;
    let trial = |config, seeds, least| Trial::new(AbsoluteEncoderBlock::new(config, ""), seeds, least);
    Ok(vec![
        trial(small_biss()?, &[1, 2], 20).size("biss c, 8 bits"),
        trial(small_ssi()?, &[3, 4], 20).size("ssi, 8 bits in gray code with parity"),
        trial(simple, &[5], 5).size("ssi, 12 bits alone"),
        trial(largest, &[6], 0).size("ssi, 40 bits"),
        trial(long, &[7], 2).size("biss c, 32 bits"),
    ])
}

const IN_GRAY_CODE: &str = "ssi, 8 bits in gray code with parity";

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a crc that is not looked at", "CRC6 & (|crc)", "CRC6 & 1'b0"),
    BlockMutant::new("a crc that is not sent inverted", "level ^ is_check", "level"),
    BlockMutant::new("an error bit that is not looked at", "!right | word_error", "!right"),
    BlockMutant::new(
        "a limit that is one too high downwards",
        "is_below & (magnitude == most)",
        "is_below & 1'b0",
    ),
    BlockMutant::new("a limit that does not grow", "allowed + LARGEST_JUMP", "allowed"),
    BlockMutant::new(
        "an extrapolation without an end",
        "last_miss = missed == TOLERATED",
        "last_miss = 1'b0",
    ),
    BlockMutant::new(
        "a change of several readings that is taken for that of one",
        "accepts & known_q & first_miss",
        "accepts & known_q",
    ),
    BlockMutant::new(
        "a delay that is one clock too long",
        "SYNCHRONISER_DELAY = 16'd65534",
        "SYNCHRONISER_DELAY = 16'd65535",
    ),
    BlockMutant::new("an encoder that may compute for ever", "elapsed >= ANSWER", "1'b0"),
    BlockMutant::new(
        "a reading of a line that is low",
        "at_rest & starts & pin_level",
        "at_rest & starts",
    ),
    BlockMutant::new("a pause that is a clock too short", "PAUSE = 16'd32", "PAUSE = 16'd31"),
    BlockMutant::new(
        "gray code that is taken for binary",
        "GRAY & position_q[0]",
        "GRAY & 1'b0",
    )
    .of(IN_GRAY_CODE),
    BlockMutant::new(
        "a parity that is not looked at",
        "EVEN_PARITY & odd",
        "EVEN_PARITY & 1'b0",
    )
    .of(IN_GRAY_CODE),
    BlockMutant::new(
        "a line behind the last bit that may be high",
        "in_low & !pin_level",
        "in_low",
    )
    .of(IN_GRAY_CODE),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a frame whose check is not looked at",
        "right = whole & !word_wrong",
        "right = whole",
    )
    .violates("known_failed"),
    ProofMutant::new(
        "a clock of the encoder that is too fast",
        "half_timer == HALF",
        "half_timer != HALF",
    )
    .violates(""),
    ProofMutant::new(
        "a position that goes on without bound",
        "last_miss = missed == TOLERATED",
        "last_miss = 1'b0",
    )
    .violates(""),
];
