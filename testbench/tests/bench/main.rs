//! The bench itself, tried on small hand-written Verilog and waveforms.

mod common;
mod diff;
mod hostile;
mod lockstep;
mod simulators;
mod wave;
