//! What leaves posicast for a device: the output folder ([`package`]), the C driver ([`driver`]), and the estimate of what its
//! Verilog costs ([`yosys`]).
//!
//! The driver is written from the register maps of `posicast-model`. The other two do not know how the files came to be: they
//! take bytes and file names.

pub mod driver;
pub mod package;
pub mod yosys;
