//! The tests of `posicast-host` in one program.
#![cfg(test)]

mod faults;
#[cfg(unix)]
mod terminal;
