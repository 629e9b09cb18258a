//! The tests of the command line in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod cli;
mod export;
mod names;
mod reproduce;
mod suites;
