//! The tests of `posicast-host` in one program.
#![cfg(test)]

mod campaign;
mod compare;
mod faults;
mod home;
mod inline;
mod probe;
mod spi;
mod stage;
#[cfg(unix)]
mod terminal;
mod verilated;
