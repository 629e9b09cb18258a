//! The documents of the steps as text for a terminal.
//!
//! There is one file per step, with a function from its document to lines; colours are escape sequences, which
//! [`output`](crate::output) removes if nobody would see them.

mod compare;
mod files;
mod generate;
mod simulate;
mod synth;

pub(crate) use compare::compare;
pub(crate) use generate::{generate, list};
pub(crate) use simulate::simulate;
pub(crate) use synth::synth;
