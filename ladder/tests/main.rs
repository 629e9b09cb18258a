//! The tests of `posicast-ladder` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod coverage;
mod crossings;
mod mutation;
mod netlist;
mod proof_tables;
mod stage_datasheet;
mod stage_wires;
mod unset;
mod verification_page;
