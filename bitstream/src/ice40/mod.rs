//! iCE40: the bits are decoded by icebox_vlog.

pub mod asc;
mod legal;
mod memory;
mod netlist;
mod read;
pub mod structure;
pub mod tools;

pub use legal::{MEMORY_MODEL, legal_verilog};
pub(crate) use memory::MemoryState;
pub use netlist::{CarryCell, CellOutput, CellPlace, Flop, IceboxNetlist, LutCell, MEMORY_WORDS, MemoryCell};
