//! The bridge from SPI to the registers in hardware.
//!
//! The datasheet is `docs/spi_bridge.md`, the reference `posicast_blocks::spi_bridge`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `kernel` | counts the units of the time-out, and connects the others |
//! | `line` | receives and sends bytes on the SPI lines |
//! | those of `link_frames` | turn bytes into bus accesses and back; shared with [`uart_bridge`](crate::uart_bridge) |

mod kernel;
mod line;

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::simulation::{Simulated, SimulationError};
use kernel::SpiBridge;
use posicast_blocks::spi_bridge::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The bridge in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(SpiBridge::default());
    Ok(Box::new(Simulated::new("spi_bridge", block, ports())?))
}

/// The bridge's Verilog, one module per file, the top last.
///
/// The top is called `posicast_spi_bridge`, or `spi_bridge` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "spi_bridge".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Bridge from SPI (mode 0) to registers: frames with COBS and CRC-32, Avalon-MM host.\n\
                    Reads and writes words only for a complete frame with a correct CRC."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&SpiBridge::default(), &options)
}
