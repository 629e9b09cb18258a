//! What leaves posicast for a device: the output folder ([`package`]) and the estimate of what its Verilog costs
//! ([`yosys`]).
//!
//! Neither knows how the files came to be: this crate takes bytes and file names, and depends on no other crate of the
//! workspace.

pub mod package;
pub mod yosys;
