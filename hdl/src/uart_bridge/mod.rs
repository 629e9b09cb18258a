//! The bridge from a serial line to the registers in hardware.
//!
//! The datasheet is `docs/uart_bridge.md`, the reference `posicast_blocks::uart_bridge`.
//!
//! | kernel | what it does |
//! |---|---|
//! | `kernel` | divides the clock, and connects the others |
//! | `receiver`, `transmitter` | receive and send the bytes of the line |
//! | those of `link_frames` | turn bytes into bus accesses and back; shared with [`spi_bridge`](crate::spi_bridge) |

mod kernel;
mod receiver;
mod transmitter;

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::simulation::{Simulated, SimulationError};
use kernel::UartBridge;
use posicast_blocks::uart_bridge::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The bridge in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(UartBridge::default());
    Ok(Box::new(Simulated::new("uart_bridge", block, ports())?))
}

/// The bridge's Verilog, one module per file, the top last.
///
/// The top is called `posicast_uart_bridge`, or `uart_bridge` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "uart_bridge".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Bridge from a serial line (8N1) to registers: frames with COBS and CRC-32, Avalon-MM host.\n\
                    Reads and writes words only for a complete frame with a correct CRC."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&UartBridge::default(), &options)
}
