//! The tests of `wavecmp` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod complaints;
mod dialects;
mod diff;
mod files;
mod fst;
mod fuzz;
mod hostile;
mod options;
mod producers;
mod program;
mod recordings;
mod second_reading;
mod support;
mod text;
