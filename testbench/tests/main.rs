//! The tests of `posicast-testbench` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod axis;
mod bench;
mod coverage;
mod crossings;
mod crosssim;
mod error_table;
mod error_table_loop;
mod fault_campaign;
mod first_clocks;
mod formal;
mod latency;
mod linked_stage;
mod moving_modes;
mod mutation;
mod netlist;
mod pwm;
mod pwm_fault;
mod pwm_pins;
mod registers;
mod shaper;
mod sliding_mode;
mod stage;
mod stage_bring_up;
mod stage_datasheet;
mod stage_guards;
mod stage_hold;
mod stage_range;
mod stage_run;
mod stage_wires;
mod support;
mod unset;
mod verification_page;
mod wrong_sign;
