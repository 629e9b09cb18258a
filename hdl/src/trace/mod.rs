//! The trace memory in hardware: records up to four of 16 signals, row by row, around a trigger.
//!
//! The datasheet is `docs/trace.md`, the reference `posicast_blocks::trace`.
//!
//! One kernel serves all sizes. It is compiled at three sizes, from which the emitter writes any: see `compiled`.

mod kernel;
mod memory;
mod signal_select;
mod trigger;

use crate::compiled::{self, Compiled};
use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Trace;
use posicast_blocks::trace::{PORTS, TraceConfig, ports, row_clocks};
use posicast_blocks::{ClockedBlock, port_notes};

/// Width of the recorded words.
const WORD_BITS: u32 = 32;
/// Value of the port `signals` for a row of four, the longest.
const FOUR_SIGNALS: u8 = 2;

/// The trace memory of 2^A words.
macro_rules! trace {
    ($a:literal) => {
        Compiled {
            sizes: &[$a],
            build: |config| Box::new(Trace::<$a, { $a + 1 }>::new(config)),
        }
    };
}

const SIZES: [Compiled<TraceConfig>; 3] = [trace!(11), trace!(8), trace!(10)];

/// The trace memory in RustHDL's own simulator.
///
/// It runs at a compiled size that is large enough: the ring buffer may be larger, but the outputs are the same.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &TraceConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let holding = simulated(config).ok_or(SimulationError::Size {
        block: "trace",
        word_bits: WORD_BITS,
    })?;
    Ok(Box::new(Simulated::new("trace", (holding.build)(config), ports())?))
}

/// The size at which [`simulate`] runs the trace memory, as text, if it differs from its own.
pub fn simulated_as(config: &TraceConfig) -> Option<String> {
    match simulated(config)?.sizes {
        &[address_bits] if address_bits != config.address_bits() => {
            Some(format!("a memory of {} words", 1u32 << address_bits))
        }
        _ => None,
    }
}

fn simulated(config: &TraceConfig) -> Option<&'static Compiled<TraceConfig>> {
    compiled::holding(&SIZES, &[config.address_bits()], false)
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &TraceConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &TraceConfig) -> String {
    format!("trace_{}", config.samples())
}

/// The trace memory's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &TraceConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Trace memory: records up to four of 16 signals, row by row, around a trigger.\n\
                    arm begins a trace; after its end, the words are read by address, in order of time."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("samples", config.samples(), "words; a row has 1, 2 or 4"),
                Parameter::new(
                    "row_clocks",
                    row_clocks(FOUR_SIGNALS),
                    "from a strobe to the next, at most",
                ),
            ],
        },
    };
    compiled::emit(&SIZES, config, &[config.address_bits()], &options)
}
