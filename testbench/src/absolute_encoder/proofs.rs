//! The proofs of the absolute encoder: both protocols at a few bits, where a whole frame is reached, and as machines have them.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteProtocol, FrameCheck, FrameStatusBit, ports,
};
use posicast_hdl::absolute_encoder::emit;

use super::trials::{small_biss, small_ssi};
use super::{biss, ssi};
use crate::Error;
use crate::formal::{INDUCTION, Task, refused};

pub(super) fn all() -> Result<Vec<Task>, Error> {
    let few = small_ssi()?;
    let frame = AbsoluteFrame {
        gray: true,
        check: FrameCheck::EvenParity,
        ..AbsoluteFrame::ssi(8)
    };
    let short = AbsoluteEncoderConfig::new(AbsoluteProtocol::Ssi, frame, few.times(), few.limits()).map_err(refused)?;
    Ok(vec![
        proof(short, true, "SSI, 8 bits in Gray code with parity")?,
        proof(few, false, "SSI, 8 bits among others")?,
        proof(small_biss()?, false, "BiSS-C, 8 bits")?,
        proof(ssi()?, false, "SSI, 25 bits in Gray code with parity")?,
        proof(biss()?, false, "BiSS-C, 32 bits")?,
    ])
}

fn bit(level: bool) -> String {
    format!("1'b{}", u8::from(level))
}

/// `is_short`: a whole frame is near enough to the reset for the search of covers.
fn proof(config: AbsoluteEncoderConfig, is_short: bool, size: &str) -> Result<Task, Error> {
    let (frame, times, limits) = (config.frame(), config.times(), config.limits());
    let bits = |bits: u32| format!("7'd{bits}");
    let at = |status: Option<FrameStatusBit>| {
        bits(status.map_or(0, |bit| frame.leading_bits + frame.position_bits + bit.place))
    };
    let is_low = |status: Option<FrameStatusBit>| bit(status.is_some_and(|bit| bit.active_low));
    // The register of the other check is not read, and a netlist has it not.
    let (check_known, unread) = match frame.check {
        FrameCheck::None => ("1'b1", &["u_word.crc", "u_word.odd"][..]),
        FrameCheck::EvenParity | FrameCheck::OddParity => ("odd == ones", &["u_word.crc"][..]),
        FrameCheck::Crc6 => ("crc == rest", &["u_word.odd"][..]),
    };
    let is_read = |line: &&str| !unread.iter().any(|register| line.contains(register));
    let text: Vec<&str> = include_str!("absolute_encoder.sv").lines().filter(is_read).collect();
    let macros = [
        ("CHECK_KNOWN", format!("({check_known})")),
        ("HALF", format!("17'd{}", times.half_period_clocks)),
        ("PAUSE", format!("17'd{}", times.pause_clocks)),
        ("BITS", bits(frame.bits())),
        ("LEADING", bits(frame.leading_bits)),
        ("POSITION", bits(frame.position_bits)),
        ("GRAY", bit(frame.gray)),
        ("CRC6", bit(frame.check == FrameCheck::Crc6)),
        ("EVEN", bit(frame.check == FrameCheck::EvenParity)),
        ("ODD", bit(frame.check == FrameCheck::OddParity)),
        ("HAS_ERROR", bit(frame.error.is_some())),
        ("ERROR_AT", at(frame.error)),
        ("ERROR_LOW", is_low(frame.error)),
        ("HAS_WARNING", bit(frame.warning.is_some())),
        ("WARNING_AT", at(frame.warning)),
        ("WARNING_LOW", is_low(frame.warning)),
        ("LARGEST", format!("32'sd{}", limits.largest_jump)),
        ("MOST", format!("32'sd{}", limits.largest_jump * limits.tolerated)),
        ("TOLERATED", format!("8'd{}", limits.tolerated)),
        ("SHORT", bit(is_short)),
    ];
    let block = (emit(&config, "")?, ports());
    Ok(Task::new("absolute_encoder", size, INDUCTION, block).properties(&macros, &(text.join("\n") + "\n")))
}
