//! The tests of `posicast-hdl` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod cascade;
mod component_parts;
mod kernel_rules;
mod pitfalls;
mod random;
mod segments;
mod shaper_rusthdl;
mod shaper_verilog;
mod stimulus;
mod trace;
