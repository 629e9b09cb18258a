//! The bridge from AXI4-Lite to the registers in hardware.
//!
//! The datasheet is `docs/axi_lite_bridge.md`, the reference `posicast_blocks::axi_lite_bridge`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `kernel` | begins an access per clock, and connects the queues |
//! | `queue` | keeps two entries between a `valid` and a `ready`, neither of which reaches the other in the same clock |

mod kernel;
mod queue;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::AxiLiteBridge;
use posicast_blocks::axi_lite_bridge::{PORTS, READ_CLOCKS, WRITE_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The bridge in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(AxiLiteBridge::default());
    Ok(Box::new(Simulated::new("axi_lite_bridge", block, ports())?))
}

/// The bridge's Verilog, one module per file, the top last.
///
/// The top is called `posicast_axi_lite_bridge`, or `axi_lite_bridge` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "axi_lite_bridge".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Bridge from AXI4-Lite to registers: one access per clock, SLVERR for a word without a register."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new(
                    "read_clocks",
                    READ_CLOCKS,
                    "from the address to its answer, where nothing waits",
                ),
                Parameter::new(
                    "write_clocks",
                    WRITE_CLOCKS,
                    "from address and data to their answer, likewise",
                ),
            ],
        },
    };
    emit::emit(&AxiLiteBridge::default(), &options)
}
