//! Everything that posicast writes for a device: the output folder ([`package`]), the files for Quartus ([`sopc`]),
//! the C driver ([`driver`]), the component for LinuxCNC ([`hal`]), the documents of the registers ([`register_documents`]), the datasheets
//! ([`datasheets`]), the kit for the user's own design ([`kit`]), its declarations in VHDL ([`vhdl`]), IP cores for
//! Vivado ([`amd`]), a module for LiteX ([`litex`]), and estimates of the resources ([`yosys`]) and the clock ([`clock`]) of its Verilog.
//!
//! Folder and estimates do not know how the files were made: they take bytes and file names. The others are written
//! from the register maps and ports of `posicast-blocks`.

pub mod amd;
pub mod bus_top;
pub mod clock;
pub mod core_file;
pub mod datasheets;
pub mod driver;
pub mod hal;
pub mod kit;
pub mod litex;
pub mod package;
pub mod register_documents;
pub mod sopc;
pub mod vhdl;
pub mod yosys;
