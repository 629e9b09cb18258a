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
//! | [`network`] | the netlist of the bits in the form that is simulated, whatever the family |
//! | [`ice40`] | iCE40: the programs, a bitstream as text, its netlist, and the comparison with the router's result |
//! | [`behaviour`] | runs the netlist of the bits beside the model |
//! | [`flips`] | makes single faults in the bits, which the comparisons must find |
//!
//! Only iCE40 is built in. What a netlist has and this crate does not know is an error that names it, never a guess.

pub mod behaviour;
pub mod boards;
mod error;
pub mod flips;
pub mod ice40;
pub mod model;
pub mod network;
mod random;
pub mod top;

pub use error::BitstreamError;
