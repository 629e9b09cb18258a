//! Bitstreams by open tools, and evidence that their bits compute the bit-exact model.
//!
//! ```text
//! top (Verilog) ─► yosys ─► nextpnr ─► text ─► packed file ─► text ─► netlist of the bits
//!                              │         └─ structure: tiles ──┘        │          │
//!                              └─ placed netlist ─ structure: cells ────┘          │
//!                                                  behaviour: lock step with the model of the top
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`boards`] | the boards, with two sources for each pin |
//! | [`top`] | the board's top module: the machine's shapers behind a serial line |
//! | [`model`] | the bit-exact model of that top |
//! | [`toolchain`] | the steps above, as each family has them |
//! | [`ice40`] | iCE40: a bitstream as text, its netlist by icebox_vlog, and the comparison with the router's result |
//! | [`ecp5`] | ECP5: the same, with the netlist by Project Trellis' database |
//! | [`gowin`] | Gowin: the same, with the netlist by apycula's chip database |
//! | [`network`] | the netlist of the bits in the form that is simulated, whatever the family |
//! | [`behaviour`] | runs the netlist of the bits beside the model |
//! | [`flips`] | makes single faults in the bits, which the comparisons must find |
//! | [`label`] | the comment in a packed file that says of which design it is |
//! | [`report`] | what the comparisons report |
//!
//! What a netlist has and this crate does not know is an error that names it, never a guess.

pub mod behaviour;
pub mod boards;
pub mod ecp5;
mod error;
pub mod flips;
mod function;
pub mod gowin;
pub mod ice40;
pub mod label;
pub mod model;
pub mod network;
mod program;
mod random;
pub mod report;
pub mod toolchain;
pub mod top;

pub use error::BitstreamError;
