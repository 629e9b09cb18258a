//! The command FIFO in hardware: segments of constant jerk, integrated exactly, tick by tick.
//!
//! The datasheet is `docs/segments.md`, the reference `posicast_blocks::segments`.

mod fifo;
mod integrator;
mod kernel;
mod passes;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Segments;
use posicast_blocks::segments::{ENTRIES_MAX, LATENCY_CLOCKS, PORTS, TICK_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The command FIFO in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Segments::default());
    Ok(Box::new(Simulated::new("segments", block, ports())?))
}

/// The command FIFO's Verilog, one module per file, the top last.
///
/// The top is called `posicast_segments`, or `segments` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "segments".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Motion commands: a FIFO of segments of constant jerk, integrated exactly at every tick.\n\
                    If no entry is left while moving: constant velocity for `extrapolation` ticks, then a quick stop."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("entries", u32::from(ENTRIES_MAX), "including the one being played"),
                Parameter::new("latency_clocks", LATENCY_CLOCKS, "from tick to valid"),
                Parameter::new("tick_clocks", TICK_CLOCKS, "from a tick until the next one is taken"),
            ],
        },
    };
    emit::emit(&Segments::default(), &options)
}
