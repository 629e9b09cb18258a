//! The supervisor of an axis in hardware: it switches the outputs, starts and stops the motion, and reacts to faults.
//!
//! The datasheet is `docs/axis.md`, the reference `posicast_blocks::axis`.

mod at_tick;
mod bytes;
mod causes;
mod kernel;
mod larger;
mod lasts;
mod line;
mod monitors;
mod nibbles;
mod nonzero;
mod size_limit;
mod soft_limits;
mod states;
mod tick_count;
mod timer;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::Axis;
pub(crate) use line::Line;
use posicast_blocks::axis::{CLEAR_CLOCKS, LINE_CLOCKS, PORTS, WATCH_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The supervisor in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Axis::default());
    Ok(Box::new(Simulated::new("axis", block, ports())?))
}

/// The supervisor's Verilog, one module per file, the top last.
///
/// The top is called `posicast_axis`, or `axis` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "axis".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Supervisor of an axis: OFF, READY, HOLD, RUN, QUICK_STOP, FAULT.\n\
                    Every cause ends in a stop: outputs off at once, or a quick stop and then the brake."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new(
                    "line_clocks",
                    LINE_CLOCKS,
                    "from a line to the state, plus filter_clocks",
                ),
                Parameter::new(
                    "watch_clocks",
                    WATCH_CLOCKS,
                    "from a tick to the state, for the checks at ticks",
                ),
                Parameter::new(
                    "clear_clocks",
                    CLEAR_CLOCKS,
                    "from clear_faults until causes that are over are forgotten",
                ),
            ],
        },
    };
    emit::emit(&Axis::default(), &options)
}
