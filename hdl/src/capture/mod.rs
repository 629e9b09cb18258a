//! The position capture in hardware: an edge of a line takes the positions of the axes into a memory.
//!
//! The datasheet is `docs/capture.md`, the reference `posicast_blocks::capture`.

mod kernel;
mod line;
mod memory;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Capture;
use posicast_blocks::capture::{ENTRIES, LATENCY_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The position capture in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Capture::default());
    Ok(Box::new(Simulated::new("capture", block, ports())?))
}

/// The position capture's Verilog, one module per file, the top last.
///
/// The top is called `posicast_capture`, or `capture` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "capture".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Position capture: an edge of the line takes the positions of the axes and a time stamp into a memory,\n\
                    from which they are read in order."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new(
                    "latency_clocks",
                    LATENCY_CLOCKS,
                    "from the line to the captured positions, plus filter_clocks",
                ),
                Parameter::new("entries", ENTRIES, "in the memory"),
            ],
        },
    };
    emit::emit(&Capture::default(), &options)
}
