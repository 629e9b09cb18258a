//! A stage in lock step with its simulated machine.
//!
//! - [`stage_bench`] joins model, RTL and simulated axes, clock by clock.
//! - [`stage_run`] switches a stage on, moves it along moves and contours, and measures.
//! - [`fault_campaign`] injects every fault into a stage with its machine, at random clocks of a move.
//! - [`inline_bench`] is an inline shaper with a controller at its pins, and [`inline_run`] measures what it does with its machine.
//! - [`touching`] puts a touch probe at a stage's capture line.
//! - [`linked_bench`] puts a stage with its simulated machine, or an inline shaper, behind a serial line.

pub mod fault_campaign;
pub mod inline_bench;
pub mod inline_run;
pub mod linked_bench;
pub mod stage_bench;
pub mod stage_run;
pub mod touching;
