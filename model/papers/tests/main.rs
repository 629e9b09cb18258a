//! The tests of `posicast-papers` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod controllers;
mod papers;
