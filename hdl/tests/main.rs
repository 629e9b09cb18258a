//! The tests of `posicast-hdl`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod axis;
mod cascade;
mod component_parts;
mod divider;
mod drive_command;
mod encoder_generator;
mod error_table;
mod excitation;
mod kernel_rules;
mod library;
mod linear_scale;
mod pitfalls;
mod pulse_counter;
mod pwm;
mod random;
mod segments;
mod shaper_rusthdl;
mod shaper_verilog;
mod sliding_mode;
mod stimulus;
mod trace;
