//! The absolute encoder in hardware: a reading of an SSI or BiSS-C encoder at every tick, as a count.
//!
//! The datasheet is `docs/absolute_encoder.md`, the reference `posicast_blocks::absolute_encoder`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `line` | clocks the encoder, and says when a bit is taken and how the reading ends |
//! | `word` | takes the bits: position, status, check |
//! | `kernel` | judges the reading: count, extrapolation, flags |
//!
//! The registers have the width of the largest encoder; constants of the configuration mask what a smaller one leaves unused, so
//! that one compiled size serves all.

mod kernel;
mod line;
mod word;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::AbsoluteEncoder;
use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, AbsoluteFrame, FrameStatusBit, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The absolute encoder in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &AbsoluteEncoderConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(AbsoluteEncoder::new(config));
    Ok(Box::new(Simulated::new("absolute_encoder", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &AbsoluteEncoderConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &AbsoluteEncoderConfig) -> String {
    let (frame, times, limits) = (config.frame(), config.times(), config.limits());
    let code = if frame.gray { "_gray" } else { "" };
    format!(
        "absolute_encoder_{}_{}x{}x{}{code}_{}{}{}_{}x{}x{}_{}x{}",
        config.protocol().name(),
        frame.leading_bits,
        frame.position_bits,
        frame.trailing_bits,
        frame.check.name(),
        status_name("e", frame.error),
        status_name("w", frame.warning),
        times.half_period_clocks,
        times.pause_clocks,
        times.answer_clocks,
        limits.largest_jump,
        limits.tolerated,
    )
}

fn status_name(letter: &str, bit: Option<FrameStatusBit>) -> String {
    let low = |bit: FrameStatusBit| if bit.active_low { "n" } else { "" };
    bit.map_or_else(String::new, |bit| format!("_{letter}{}{}", bit.place, low(bit)))
}

/// The absolute encoder's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &AbsoluteEncoderConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about:
                "Absolute encoder: a reading at every tick, as a count that is extended beyond the encoder's range.\n\
                    A frame with a wrong check never moves the count."
                    .to_owned(),
            ports: port_notes(PORTS),
            parameters: parameters(config),
        },
    };
    emit::emit(&AbsoluteEncoder::new(config), &options)
}

fn parameters(config: &AbsoluteEncoderConfig) -> Vec<Parameter> {
    let (frame, times, limits) = (config.frame(), config.times(), config.limits());
    vec![
        Parameter::new("protocol", config.protocol().name(), "of the encoder"),
        Parameter::new("frame", frame_text(frame), "bits, in the order in which they come"),
        Parameter::new("code", if frame.gray { "gray" } else { "binary" }, "of the position"),
        Parameter::new("half_period_clocks", times.half_period_clocks, "of clock_out"),
        Parameter::new("pause_clocks", times.pause_clocks, "at least, between two readings"),
        Parameter::new(
            "answer_clocks",
            times.answer_clocks,
            "at most, to the start bit (BiSS-C)",
        ),
        Parameter::new("largest_jump", limits.largest_jump, "counts per reading"),
        Parameter::new("tolerated", limits.tolerated, "failed readings in a row"),
        Parameter::new(
            "valid_clocks",
            config.most_valid_clocks(),
            "at most, from tick to valid",
        ),
        Parameter::new("least_tick_clocks", config.least_tick_clocks(), "from tick to tick"),
    ]
}

fn frame_text(frame: &AbsoluteFrame) -> String {
    format!(
        "{} leading, {} position, {} trailing, {} check ({})",
        frame.leading_bits,
        frame.position_bits,
        frame.trailing_bits,
        frame.check.bits(),
        frame.check.name(),
    )
}
