//! RustHDL's simulator behind the interface that all blocks share.
//!
//! It works like RustHDL's `simulate`, for any block behind one type. RustHDL's threaded `Simulation` is a hundred
//! times slower.

use crate::prelude::*;
use posicast_blocks::{ClockedBlock, Direction, Port, StepError};

/// Largest number of updates of a design within one clock edge; more count as an oscillation.
const MOST_UPDATES: usize = 100;

/// Why a block cannot be simulated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SimulationError {
    /// RustHDL's checks found an open or looping signal. This is an error of the block, not of its user.
    #[error("RustHDL refuses the block `{block}`: {reason}")]
    Refused {
        /// Name of the block.
        block: &'static str,
        /// RustHDL's message.
        reason: String,
    },
    /// No compiled size of the kernel can represent the requested one.
    #[error("RustHDL's simulator has no `{block}` for words of {word_bits} bits: simulate its Verilog instead")]
    Size {
        /// Name of the block.
        block: &'static str,
        /// Width of its words in bits.
        word_bits: u32,
    },
}

/// A block whose ports are raw bit patterns, in port order, without `clk`.
pub(crate) trait Pins: Block {
    /// Sets the level of `clk`.
    fn set_clk(&mut self, level: bool);
    /// Sets the inputs.
    fn drive(&mut self, inputs: &[u64]);
    /// Reads the outputs.
    fn read(&self, outputs: &mut [u64]);
}

/// An input port, or an array of them.
pub(crate) trait InputPins {
    /// Takes the next raw bit patterns; bits above a port's width are ignored.
    fn drive(&mut self, patterns: &mut dyn Iterator<Item = u64>);
}

/// An output port, or an array of them.
pub(crate) trait OutputPins {
    /// Writes its raw bit patterns to the next elements.
    fn read(&self, patterns: &mut dyn Iterator<Item = &mut u64>);
}

/// Conversion between a port's value and its bit pattern.
pub(crate) trait Pattern: Synth {
    fn from_pattern(pattern: u64) -> Self;
    fn pattern(self) -> u64;
}

impl Pattern for Bit {
    fn from_pattern(pattern: u64) -> Self {
        pattern & 1 != 0
    }

    fn pattern(self) -> u64 {
        self.into()
    }
}

impl<const N: usize> Pattern for Bits<N> {
    fn from_pattern(pattern: u64) -> Self {
        from_u64(pattern)
    }

    fn pattern(self) -> u64 {
        self.into()
    }
}

impl<const N: usize> Pattern for Signed<N> {
    fn from_pattern(pattern: u64) -> Self {
        from_i64(pattern as i64)
    }

    fn pattern(self) -> u64 {
        unsigned_cast(self).into()
    }
}

impl<T: Pattern> InputPins for Signal<In, T> {
    fn drive(&mut self, patterns: &mut dyn Iterator<Item = u64>) {
        self.next = T::from_pattern(patterns.next().unwrap_or_default());
    }
}

impl<T: Pattern> OutputPins for Signal<Out, T> {
    fn read(&self, patterns: &mut dyn Iterator<Item = &mut u64>) {
        if let Some(place) = patterns.next() {
            *place = self.val().pattern();
        }
    }
}

impl<P: InputPins, const N: usize> InputPins for [P; N] {
    fn drive(&mut self, patterns: &mut dyn Iterator<Item = u64>) {
        self.iter_mut().for_each(|pin| pin.drive(patterns));
    }
}

impl<P: OutputPins, const N: usize> OutputPins for [P; N] {
    fn read(&self, patterns: &mut dyn Iterator<Item = &mut u64>) {
        self.iter().for_each(|pin| pin.read(patterns));
    }
}

/// A block in RustHDL's simulator.
pub(crate) struct Simulated {
    block: Box<dyn Pins>,
    ports: Vec<Port>,
    inputs: usize,
    /// The inputs of a clock, extended to 64 bits.
    driven: Vec<u64>,
}

impl Simulated {
    /// Connects and checks `block`. `ports` may be narrower than the block's: inputs are extended with zeros or their
    /// sign, and only the low bits of outputs are used.
    pub(crate) fn new(name: &'static str, mut block: Box<dyn Pins>, ports: Vec<Port>) -> Result<Self, SimulationError> {
        block.connect_all();
        check_all(block.as_ref()).map_err(|error| SimulationError::Refused {
            block: name,
            reason: format!("{error:?}"),
        })?;
        let inputs = ports.iter().filter(|port| port.direction == Direction::Input).count();
        Ok(Self {
            block,
            ports,
            inputs,
            driven: Vec::new(),
        })
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
        let of = |direction| move |port: &&Port| port.direction == direction;
        let ports = self.ports.iter().filter(of(Direction::Input));
        self.driven.clear();
        self.driven
            .extend(ports.zip(inputs).map(|(port, input)| extended(*input, port)));
        self.block.drive(&self.driven);
        self.block.set_clk(false);
        self.settle()?;
        self.block.read(outputs);
        let ports = self.ports.iter().filter(of(Direction::Output));
        for (port, output) in ports.zip(outputs) {
            *output &= u64::MAX >> (64 - port.width);
        }
        self.block.set_clk(true);
        self.settle()
    }
}

/// The pattern of a port extended to 64 bits.
fn extended(pattern: u64, port: &Port) -> u64 {
    let above = 64 - port.width;
    if port.signed {
        ((pattern << above) as i64 >> above) as u64
    } else {
        pattern << above >> above
    }
}
