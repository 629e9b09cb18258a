//! What leaves posicast for a device: the output folder ([`package`]), the C driver ([`driver`]), the documents of its registers
//! ([`register_documents`]), and the estimate of what its Verilog costs ([`yosys`]).
//!
//! Driver and documents are written from the register maps of `posicast-model`. The other two do not know how the files came to be: they
//! take bytes and file names.

pub mod core_file;
pub mod driver;
pub mod package;
pub mod register_documents;
pub mod yosys;
