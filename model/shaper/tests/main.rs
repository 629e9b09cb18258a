//! The tests of `posicast-shaper` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod hump_limits;
mod kind_tables;
mod motor_held;
mod prop_kinds;
