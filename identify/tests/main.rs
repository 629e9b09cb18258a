//! The tests of `posicast-identify` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod columns;
mod expected;
mod irregular;
mod log;
mod low_modes;
mod motor;
mod position;
mod position_bad;
mod position_noise;
mod sweep;
mod sweep_excitation;
mod sweep_gaps;
mod sweep_random;
mod trial;
