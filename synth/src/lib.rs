//! What leaves posicast for a device: the output folder ([`package`]), what of it is opened in Quartus ([`sopc`]), the C driver
//! ([`driver`]), the documents of the registers ([`register_documents`]) and the datasheets ([`datasheets`]), what takes the shapers
//! into a design of one's own ([`kit`]), and the estimates of what its Verilog costs ([`yosys`])
//! and how fast it is ([`clock`]).
//!
//! Folder and estimates do not know how the files came to be: they take bytes and file names. The others are written from the
//! register maps and ports of `posicast-model`.

pub mod clock;
pub mod core_file;
pub mod datasheets;
pub mod driver;
pub mod kit;
pub mod package;
pub mod register_documents;
pub mod sopc;
pub mod yosys;
