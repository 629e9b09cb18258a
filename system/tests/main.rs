//! The tests of `posicast-system` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod output;
