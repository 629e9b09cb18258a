//! The position compare in hardware: a pulse when a count passes a position.
//!
//! The datasheet is `docs/compare.md`, the reference `posicast_blocks::compare`.

mod entry_list;
mod kernel;
mod pulse;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Compare;
use posicast_blocks::compare::{LATENCY_CLOCKS, LEAST_DISTANCE_COUNTS, LIST_POSITIONS, LIST_STEP_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The position compare in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Compare::default());
    Ok(Box::new(Simulated::new("compare", block, ports())?))
}

/// The position compare's Verilog, one module per file, the top last.
///
/// The top is called `posicast_compare`, or `compare` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "compare".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Position compare: a pulse when a count passes a position, one of a row or of a list in memory."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("latency_clocks", LATENCY_CLOCKS, "from count to passed and pulse"),
                Parameter::new("list_positions", LIST_POSITIONS, "most positions in the list"),
                Parameter::new(
                    "least_distance_counts",
                    LEAST_DISTANCE_COUNTS,
                    "of two positions in the list",
                ),
                Parameter::new(
                    "list_step_clocks",
                    LIST_STEP_CLOCKS,
                    "per position in the list, while ready is low",
                ),
            ],
        },
    };
    emit::emit(&Compare::default(), &options)
}
