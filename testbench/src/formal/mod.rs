//! Proofs about the emitted Verilog: Yosys and ABC check blocks against property files.
//!
//! ```text
//!  block's modules ──┐
//!  formal/NAME.sv ───┼─► Yosys ─► design.il ──► sat -tempinduct ─┐
//!  formal_top.sv ────┘     │                                     ├─► proven, counterexample (VCD), unknown
//!  (written here)          ├────► asserts.aig ─► abc pdr, bmc3 ──┘
//!                          └────► covers.aig ──► abc bmc3 ───────► clocks until each cover is reached
//! ```
//!
//! A property file holds one module, `NAME_properties`. Its inputs are the block's ports (the macro `PORTS`) and
//! registers inside of the block, which the attribute `peek` names: `(* peek = "u_leg.timer" *) input wire [9:0] leg_timer`. The
//! top written here leaves all inputs of the block free in every clock, resets included, and joins both. Rows start at power-up, where
//! every register has its reset value. Block RAM is left out but where a task keeps it: what is read from it is anything, in every
//! clock; so are products and whole blocks where a task says so.
//!
//! There are two engines, both unbounded: [`Engine::Pdr`] finds its invariants itself; [`Engine::Induction`] needs
//! them among the properties. If an engine does not find a proof, a counterexample of at most [`SEARCHED_CLOCKS`] is
//! searched.

mod fingerprint;
mod missing;
mod names;
mod task;
mod tool;

pub use self::missing::missing_tools;
pub use self::task::{Engine, Task};
pub(crate) use self::task::{INDUCTION, part, refused};
pub(crate) use self::tool::{ABC, YOSYS, asserted};
pub use self::tool::{ProofOutcome, ProofVerdict, Reached, SEARCHED_CLOCKS, files, proves, run, search};
