//! What leaves posicast for a device: the output folder ([`package`]), what of it is opened in Quartus ([`sopc`]), and the
//! estimates of what its Verilog costs ([`yosys`]) and how fast it is ([`clock`]).
//!
//! Folder and estimate do not know how the files came to be: they take bytes and file names. The package for an SOPC reads the
//! model's register maps and ports.

pub mod clock;
pub mod package;
mod process;
pub mod sopc;
pub mod yosys;
