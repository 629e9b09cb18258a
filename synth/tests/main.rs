//! The tests of `posicast-synth`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod clock;
mod driver;
mod independent;
mod package;
mod processor;
mod yosys;
