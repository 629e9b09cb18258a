//! The tests of `wavecmp` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod diff;
mod fuzz;
mod hostile;
mod options;
mod producers;
mod support;
mod text;
