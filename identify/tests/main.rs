//! The tests of `posicast-identify`, in one program: linking is most of what a program of its own would cost.
#![cfg(test)]

mod log;
mod motor;
mod position;
mod position_bad;
mod position_noise;
mod sweep;
