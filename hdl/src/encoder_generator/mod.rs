//! The internal encoder in hardware: quadrature at a set rate, in place of the pins.
//!
//! The datasheet is `docs/encoder_generator.md`, the reference `posicast_blocks::encoder_generator`.

mod kernel;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::EncoderGenerator;
use posicast_blocks::encoder_generator::{LATENCY_CLOCKS, PORTS, RATE_FRACTION, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The internal encoder in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(EncoderGenerator::default());
    Ok(Box::new(Simulated::new("encoder_generator", block, ports())?))
}

/// The internal encoder's Verilog, one module per file, the top last.
///
/// The top is called `posicast_encoder_generator`, or `encoder_generator` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "encoder_generator".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Internal encoder: A, B and Z at a set rate, in place of the pins while loop_back is high.\n\
                    The synchronisers of the pulse counter must follow."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new(
                    "rate_fraction",
                    RATE_FRACTION,
                    "fraction bits of rate, in counts per clock",
                ),
                Parameter::new("latency_clocks", LATENCY_CLOCKS, "from a pin to its output"),
            ],
        },
    };
    emit::emit(&EncoderGenerator::default(), &options)
}
