//! The documents of the steps as text for a terminal.
//!
//! There is one file per step, with a function from its document to lines; colours are escape sequences, which
//! [`output`](crate::output) removes if nobody would see them.

mod bitstream;
pub(crate) mod campaign;
mod compare;
mod design;
mod files;
mod generate;
mod identify;
pub(crate) mod run;
mod simulate;
mod synth;
mod verify;

pub(crate) use bitstream::bitstream;
pub(crate) use compare::compare;
pub(crate) use design::design;
pub(crate) use generate::{block, generate, list, list_block};
pub(crate) use identify::identify;
pub(crate) use simulate::simulate;
pub(crate) use synth::synth;
pub(crate) use verify::{verify, verify_with_reached};
