//! The tests of `posicast-testbench` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod axis;
mod bench;
mod crosssim;
mod error_table;
mod first_clocks;
mod library;
mod linked_stage;
mod pwm;
mod pwm_fault;
mod pwm_pins;
mod registers;
mod shaper;
mod sliding_mode;
mod stage;
mod support;
