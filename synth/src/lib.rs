//! What leaves posicast for a device: the output folder ([`package`]), what of it is opened in Quartus ([`sopc`]), and the
//! estimate of what its Verilog costs ([`yosys`]).
//!
//! Folder and estimate do not know how the files came to be: they take bytes and file names. The package for an SOPC reads the
//! model's register maps and ports.

pub mod package;
pub mod sopc;
pub mod yosys;
