//! Compares RTL with the bit-exact models: stimuli, simulators, lock step, waveforms.
//!
//! ```text
//!  stimuli ──┬──► model  (posicast_model::rtl::ClockedBlock) ─┐
//!            │                                                ├─► lockstep ─► report, first mismatch with its clocks
//!            └──► device (verilator, icarus, RustHDL)  ───────┘       │
//!                                                                     └─► wave ─► *.vcd ─► diff ─► verdict
//! ```
//!
//! - [`verilator`] builds Verilog into a shared object, once per content, and drives it: the fast way.
//! - [`icarus`] runs the same Verilog in a second, independent simulator that knows `x`.
//! - [`stimuli`] makes inputs: directed cases, seeded random mixtures, real motion; and counts what they reached.
//! - [`lockstep`] steps model and device side by side and compares every output in every clock.
//! - [`blocks`] is the list of hardware blocks, each with its Verilog, model, stimuli and coverage.
//! - [`campaign`] is the order of stimuli that a machine goes through; [`recording`] runs a real move into waveforms.
//! - [`fault_campaign`] puts a stage with its machine in every fault, at random clocks of a move.
//! - [`register_tests`] asks registers, through the bus, for what their description promises.
//! - [`stage_bench`] joins a stage with its simulated machine; [`stage_run`] moves it and measures.
//! - [`asynchronous`] tests what no clock sees.
//! - [`crosssim`] compares the waveforms of two simulators.
//! - [`coverage`] measures which lines and nets a lock step reaches, and wants a reason for the rest.
//! - [`formal`] proves what property files say of the blocks.
//! - [`netlist`] simulates and proves what a synthesiser made of a block.
//! - [`replay`] plays a recording into model and RTL.
//! - [`ladder`] puts the results of all rungs into one table.
//! - [`mutation`] puts faults into the blocks, and finds out which checks notice.
//! - [`wave`] writes waveforms; the crate `wavecmp` compares two of them.
//! - [`wording`] counts things and writes times for people.

pub mod asynchronous;
pub mod blocks;
pub mod campaign;
pub mod coverage;
pub mod crosssim;
mod error;
pub mod fault_campaign;
pub mod formal;
pub mod icarus;
pub mod ladder;
pub mod lockstep;
pub mod mutation;
pub mod netlist;
pub mod page;
pub mod recording;
pub mod register_tests;
pub mod replay;
pub mod stage_bench;
pub mod stage_run;
pub mod stimuli;
mod tool;
pub mod verilator;
pub mod wave;

pub use error::{BlockError, Error};
pub use wavecmp::wording;
