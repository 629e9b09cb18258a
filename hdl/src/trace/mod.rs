//! The trace memory in hardware: records up to four of 16 signals, row by row, around a trigger.
//!
//! The datasheet is `docs/trace.md`, the reference `posicast_model::rtl::trace`.
//!
//! One kernel serves all sizes. A size is a type in RustHDL, so `block` lists the types and selects the one for a
//! [`TraceConfig`].

mod kernel;
mod memory;
mod signal_select;
mod trigger;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Pins, Simulated, SimulationError};
use kernel::Trace;
use posicast_model::rtl::trace::{PORTS, TraceConfig, ports, row_clocks};
use posicast_model::rtl::{ClockedBlock, port_notes};

/// Value of the port `signals` for a row of four, the longest.
const FOUR_SIGNALS: u8 = 2;

/// The trace memory in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &TraceConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("trace", block(config), ports())?))
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
    let parameter = |name: &str, value: u32, meaning: &str| Parameter {
        name: name.to_owned(),
        value: value.to_string(),
        meaning: meaning.to_owned(),
    };
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Trace memory: records up to four of 16 signals, row by row, around a trigger.\n\
                    arm begins; the words are read by address, in order of time, when it is over."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                parameter("samples", config.samples(), "words; a row has 1, 2 or 4"),
                parameter(
                    "row_clocks",
                    row_clocks(FOUR_SIGNALS),
                    "from a strobe to the next, at most",
                ),
            ],
        },
    };
    emit::emit(block(config).as_ref(), &options)
}

/// The kernel of this size. The last arm is the largest size; [`TraceConfig`] allows no other.
fn block(config: &TraceConfig) -> Box<dyn Pins> {
    match config.address_bits() {
        8 => Box::<Trace<8, 9>>::default(),
        9 => Box::<Trace<9, 10>>::default(),
        10 => Box::<Trace<10, 11>>::default(),
        _ => Box::<Trace<11, 12>>::default(),
    }
}
