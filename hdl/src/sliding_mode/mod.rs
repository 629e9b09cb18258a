//! The controller in hardware: computes the drive's command from reference and measurement, by sliding mode, PD or
//! PID.
//!
//! The datasheet is `docs/sliding_mode.md`, the reference `posicast_blocks::sliding_mode`.
//!
//! | part | what it does |
//! |---|---|
//! | `sequencer` | 17 steps of up to 39 clocks |
//! | `tracking` | the error e, saturated |
//! | `operands` | the operand of a step |
//! | `scaled_product` | the one multiplier, and the shift after it |
//! | `accumulator` | sums of products, saturated to words |
//! | `integral` | the integral ∫e, which can be frozen |
//! | `limiter` | keeps a word during a computation; clamps the command, and counts consecutive clamped ticks |
//! | `sticky` | the flags of one side |
//! | `kernel` | the use of each sum |

mod accumulator;
mod integral;
mod kernel;
mod limiter;
mod operands;
mod scaled_product;
mod sequencer;
mod sticky;
mod tracking;

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::simulation::{Simulated, SimulationError};
use kernel::SlidingMode;
use posicast_blocks::sliding_mode::{CONTROL_CLOCKS, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

/// The controller in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate() -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(SlidingMode::default());
    Ok(Box::new(Simulated::new("sliding_mode", block, ports())?))
}

/// The controller's Verilog, one module per file, the top last.
///
/// The top is called `posicast_sliding_mode`, or `sliding_mode` where `prefix` is empty.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: "sliding_mode".to_owned(),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Controller: computes the drive's command from reference and measurement, by sliding mode, PD or \
                PID.\n\
                    Each step reads its gain at setting_address: the word comes in the next clock, as from a block RAM."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "control_clocks".to_owned(),
                value: CONTROL_CLOCKS.to_string(),
                meaning: "from start to valid".to_owned(),
            }],
        },
    };
    emit::emit(&SlidingMode::default(), &options)
}
