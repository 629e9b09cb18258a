//! Tests the bench itself on small hand-written Verilog and waveforms.

mod common;
mod lockstep;
mod recording;
mod simulators;
mod wave;
mod waves;
