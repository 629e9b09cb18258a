//! The bench itself, tried on small hand-written Verilog and waveforms.

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
