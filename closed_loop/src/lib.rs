//! A stage in lock step with its simulated machine.
//!
//! - [`stage_bench`] joins model, RTL and simulated axes, clock by clock.
//! - [`stage_run`] switches a stage on, moves it along moves and contours, and measures.
//! - [`fault_campaign`] injects every fault into a stage with its machine, at random clocks of a move.
//! - [`linked_bench`] puts a stage with its simulated machine behind a serial line.

pub mod fault_campaign;
pub mod linked_bench;
pub mod stage_bench;
pub mod stage_run;
