//! RustHDL's simulator behind the interface that every block has.
//!
//! What RustHDL's `simulate` does, done here for any block behind one type; its threaded `Simulation` is a hundred times
//! slower.

use crate::prelude::*;
use posicast_model::rtl::{ClockedBlock, Port, StepError};

/// Updates of a design within one edge before it counts as an oscillator.
const MOST_UPDATES: usize = 100;

/// Why a block cannot be simulated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SimulationError {
    /// RustHDL's checks found an open or looping signal: an error of the block, not of its user.
    #[error("RustHDL refuses the block `{block}`: {reason}")]
    Refused {
        /// The block.
        block: &'static str,
        /// What RustHDL says.
        reason: String,
    },
}

/// A block whose ports take and give raw bit patterns, in port order, without `clk`.
pub(crate) trait Pins: Block {
    /// The level of `clk`.
    fn set_clk(&mut self, level: bool);
    /// Sets the inputs.
    fn drive(&mut self, inputs: &[u64]);
    /// Reads the outputs.
    fn read(&self, outputs: &mut [u64]);
}

/// A block in RustHDL's simulator.
pub(crate) struct Simulated {
    block: Box<dyn Pins>,
    ports: Vec<Port>,
    inputs: usize,
}

impl Simulated {
    /// Connects and checks `block`.
    pub(crate) fn new(name: &'static str, mut block: Box<dyn Pins>, ports: Vec<Port>) -> Result<Self, SimulationError> {
        block.connect_all();
        check_all(block.as_ref()).map_err(|error| SimulationError::Refused {
            block: name,
            reason: format!("{error:?}"),
        })?;
        let inputs = ports
            .iter()
            .filter(|p| p.direction == posicast_model::rtl::Direction::Input)
            .count();
        Ok(Self { block, ports, inputs })
    }

    fn settle(&mut self) -> Result<(), StepError> {
        for _ in 0..MOST_UPDATES {
            self.block.update_all();
            if !self.block.has_changed() {
                return Ok(());
            }
        }
        Err(StepError(format!(
            "the block did not settle within {MOST_UPDATES} updates: it has a loop"
        )))
    }
}

impl ClockedBlock for Simulated {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let expected = (self.inputs, self.ports.len() - self.inputs);
        if (inputs.len(), outputs.len()) != expected {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the block has {} and {}",
                inputs.len(),
                outputs.len(),
                expected.0,
                expected.1
            )));
        }
        self.block.drive(inputs);
        self.block.set_clk(false);
        self.settle()?;
        self.block.read(outputs);
        self.block.set_clk(true);
        self.settle()
    }
}
