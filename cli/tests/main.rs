//! The tests of the command line, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod cli;
mod names;
mod reproduce;
mod suites;
