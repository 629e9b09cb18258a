//! The tests of `posicast-synth` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod clock;
mod driver;
mod independent;
mod package;
mod processor;
mod yosys;
