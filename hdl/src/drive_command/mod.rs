//! The drive command in hardware: it selects the duty for the PWM, which is the controller's, in direct mode a manual
//! one, or 0.
//!
//! The datasheet is `docs/drive_command.md`, the reference `posicast_blocks::drive_command`.

mod kernel;

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::simulation::{Simulated, SimulationError};
use kernel::DriveCommand;
use posicast_blocks::drive_command::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The drive command in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(DriveCommand::default());
    Ok(Box::new(Simulated::new("drive_command", block, ports())?))
}

/// The drive command's Verilog.
///
/// The module is called `posicast_drive_command`, or `drive_command` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "drive_command".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Selects the PWM's duty. Direct mode (READY, kick not expired): the limited manual duty.\n\
                    Otherwise the controller's duty, saturated, or 0 while the drive is off."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&DriveCommand::default(), &options)
}
