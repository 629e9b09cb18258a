//! The tests of `wavecmp`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod complaints;
mod diff;
mod files;
mod fuzz;
mod hostile;
mod options;
mod producers;
mod program;
mod support;
mod text;
