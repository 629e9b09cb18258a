//! Bitstreams by open tools, and evidence that their bits compute the bit-exact model.
//!
//! ```text
//! top (Verilog) ─► yosys ─► nextpnr ─► .asc ─► icepack ─► .bin ─► iceunpack ─► .asc ─► icebox_vlog ─► netlist of the bits
//!                              │        └── structure: tile by tile ──────────┘                         │         │
//!                              └── placed netlist ───── structure: cell by cell, connection by connection ┘         │
//!                                                       behaviour: lock step with the model of the top ─────────────┘
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`boards`] | the boards, with two sources for each pin |
//! | [`top`] | the board's top module: the machine's shapers behind a serial line |
//! | [`model`] | the bit-exact model of that top |
//! | [`tools`] | the programs that build a bitstream and read it back, with limits of time and memory |
//! | [`asc`] | a bitstream as text: its tiles, and single flips |
//! | [`netlist`] | the netlist of the bits, and its simulation |
//! | [`structure`] | compares the bits with the router's result |
//! | [`behaviour`] | runs the netlist of the bits beside the model |
//! | [`flips`] | makes single faults in the bits, which the comparisons must find |
//!
//! Only iCE40 is built in. What a netlist has and this crate does not know is an error that names it, never a guess.

pub mod asc;
pub mod behaviour;
pub mod boards;
mod error;
pub mod flips;
pub mod model;
pub mod netlist;
mod random;
pub mod structure;
pub mod tools;
pub mod top;

pub use error::BitstreamError;
