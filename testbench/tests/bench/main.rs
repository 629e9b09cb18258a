//! The bench itself, tried on small hand-written Verilog and waveforms.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

mod common;
mod diff;
mod fuzz;
mod hostile;
mod lockstep;
mod options;
mod producers;
mod recording;
mod simulators;
mod text;
mod wave;
mod waves;
