//! The sequential divider in hardware: `quotient = steps · T · 2^16 / elapsed`, truncated toward zero.
//!
//! The datasheet is `docs/divider.md`, the reference `posicast_blocks::divider`.

mod kernel;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Divider;
use posicast_blocks::divider::{DIVISION_CLOCKS, DividerConfig, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The divider in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &DividerConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Divider::new(config));
    Ok(Box::new(Simulated::new("divider", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &DividerConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &DividerConfig) -> String {
    format!("divider_{}", config.tick_clocks())
}

/// The divider's Verilog.
///
/// [`name`] gives the module's name; names have no prefix where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &DividerConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Velocity: quotient = steps * tick_clocks * 2^16 / elapsed, toward zero, in Q16.16\n\
                    elapsed = 0 stands for one tick. One division at a time; each takes the same time."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("tick_clocks", config.tick_clocks(), "clocks per tick"),
                Parameter::new("division_clocks", DIVISION_CLOCKS, "from start to done"),
            ],
        },
    };
    emit::emit(&Divider::new(config), &options)
}
