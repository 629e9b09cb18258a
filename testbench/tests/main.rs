//! The tests of `posicast-testbench` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod axis;
mod bench;
mod cascade;
mod coverage;
mod crosssim;
mod divider;
mod drive_command;
mod encoder_generator;
mod error_table;
mod error_table_loop;
mod excitation;
mod fault_campaign;
mod formal;
mod linear_scale;
mod moving_modes;
mod mutation;
mod netlist;
mod parts;
mod pulse_counter;
mod pwm;
mod pwm_fault;
mod pwm_pins;
mod registers;
mod segments;
mod shaper;
mod sliding_mode;
mod stage;
mod stage_bring_up;
mod stage_guards;
mod stage_hold;
mod stage_range;
mod stage_run;
mod support;
mod trace;
mod wrong_sign;
