//! The tests of `posicast-blocks` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod absolute_encoder;
mod axis;
mod capture;
mod capture_prop;
mod cascade_prop;
mod compare;
mod composed;
mod controller_commit;
mod divider;
mod drive_command;
mod encoder_generator;
mod excitation;
mod inline_shaper;
mod linear_scale;
mod link;
mod port_tables;
mod pulse_counter;
mod pwm;
mod quiet;
mod registers;
mod shaper_motion;
mod shaper_prop;
mod shaper_protocol;
mod spi_bridge;
mod step_generator;
mod support;
mod trace;
mod uart_bridge;
