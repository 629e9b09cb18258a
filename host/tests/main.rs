//! The tests of `posicast-host` in one program.
#![cfg(test)]

mod campaign;
mod faults;
mod home;
mod inline;
mod spi;
mod stage;
#[cfg(unix)]
mod terminal;
mod verilated;
