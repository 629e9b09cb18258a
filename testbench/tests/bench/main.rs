//! The bench itself, tried on small hand-written Verilog and waveforms.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

mod common;
mod diff;
mod hostile;
mod lockstep;
mod simulators;
mod wave;
