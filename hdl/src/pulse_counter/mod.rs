//! The pulse counter in hardware: turns encoder or scale signals into position, index and velocity.
//!
//! The datasheet is `docs/pulse_counter.md`, the reference `posicast_blocks::pulse_counter`.

mod decoder;
mod glitch_filter;
mod kernel;
mod line;
mod velocity;

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::simulation::{Simulated, SimulationError};
pub(crate) use glitch_filter::GlitchFilter;
use kernel::PulseCounter;
use posicast_blocks::pulse_counter::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The pulse counter in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(PulseCounter::default());
    Ok(Box::new(Simulated::new("pulse_counter", block, ports())?))
}

/// The pulse counter's Verilog, one module per file, the top last.
///
/// The top is called `posicast_pulse_counter`, or `pulse_counter` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "pulse_counter".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Pulse counter: turns encoder or scale signals into position, index and velocity.\n\
                    The count never jumps: a preset moves the origin, position = count - origin."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    emit::emit(&PulseCounter::default(), &options)
}
