//! The excitation in hardware: adds a test signal to the position reference, behind the shaper.
//!
//! The datasheet is `docs/excitation.md`, the reference `posicast_blocks::excitation`.

mod kernel;
mod wave;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Excitation;
use posicast_blocks::excitation::{LATENCY_CLOCKS, PORTS, TICK_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The excitation in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Excitation::default());
    Ok(Box::new(Simulated::new("excitation", block, ports())?))
}

/// The excitation's Verilog, one module per file, the top last.
///
/// The top is called `posicast_excitation`, or `excitation` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "excitation".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Excitation: PRBS, chirp or square on the position reference, behind the shaper.\n\
                    It ends by itself, and is 0 in the tick after enable or allowed falls."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("latency_clocks", LATENCY_CLOCKS, "from valid to reference_valid"),
                Parameter::new(
                    "tick_clocks",
                    TICK_CLOCKS,
                    "from a valid until the next is ready, at most",
                ),
            ],
        },
    };
    emit::emit(&Excitation::default(), &options)
}
