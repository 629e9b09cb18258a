//! The tests of `wavecmp`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod diff;
mod fuzz;
mod hostile;
mod options;
mod producers;
mod support;
mod text;
