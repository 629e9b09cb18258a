//! The error table in hardware: a measured error of screw or scale over position, taken from the position reference.
//!
//! The datasheet is `docs/error_table.md`, the reference `posicast_blocks::error_table`.

mod average;
mod entry_banks;
mod kernel;
mod lookup;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::ErrorTable;
use posicast_blocks::error_table::{ErrorTableConfig, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The error table in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &ErrorTableConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(ErrorTable::new(config));
    Ok(Box::new(Simulated::new("error_table", block, ports())?))
}

/// Name of the last module that [`emit()`] writes; it contains a machine's table.
pub fn name(prefix: &str) -> String {
    emit::own_name(prefix, "error_table")
}

/// The error table's Verilog, one module per file, the top last.
///
/// [`name`] gives the top's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &ErrorTableConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let format = config.format();
    let options = EmitOptions {
        top: "error_table".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Error table: interpolates the measured error of screw or scale over position, and subtracts it\n\
                    from the position reference, times a weight that goes up and down slowly."
                .to_owned(),
            parameters: vec![
                Parameter::new("entries", config.entries().len(), "per bank"),
                Parameter::new("first_counts", format.first_counts, "user's position of the first"),
                Parameter::new(
                    "spacing_counts",
                    (1u32 << format.spacing_bits).to_string(),
                    "from entry to entry",
                ),
                Parameter::new("most_step", format.most_step(), "between neighbours"),
                Parameter::new(
                    "latency_clocks",
                    config.latency_clocks(),
                    "from valid to compensated_valid",
                ),
            ],
            ports: port_notes(PORTS),
        },
    };
    emit::emit(&ErrorTable::new(config), &options)
}
