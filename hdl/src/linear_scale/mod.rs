//! The linear scale in hardware: relates the counts of a motor's encoder to those of a linear scale.
//!
//! The datasheet is `docs/linear_scale.md`, the reference `posicast_blocks::linear_scale`.

mod kernel;
mod serial_ratio;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::LinearScale;
use posicast_blocks::linear_scale::{LATENCY_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The linear scale in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(LinearScale::default());
    Ok(Box::new(Simulated::new("linear_scale", block, ports())?))
}

/// The linear scale's Verilog, one module per file, the top last.
///
/// The top is called `posicast_linear_scale`, or `linear_scale` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "linear_scale".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Compares motor and linear scale: deviation since align, position and velocity of the loop's \
                counter.\n\
                    Multiplies one bit per clock, one product at a time, in the registers of deviation and velocity."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "latency_clocks".to_owned(),
                value: LATENCY_CLOCKS.to_string(),
                meaning: "from tick to deviation_valid, from velocity_valid to velocity".to_owned(),
            }],
        },
    };
    emit::emit(&LinearScale::default(), &options)
}
