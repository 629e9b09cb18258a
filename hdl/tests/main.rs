//! The tests of `posicast-hdl` in one program, because linking takes most of the time of a small test program.
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
mod spi_bridge;
mod stimulus;
mod trace;
mod uart_bridge;
