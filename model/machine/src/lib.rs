//! A machine as its owner describes it, and what follows from that: the tables and the hardware that are built, the words
//! and gains of its controller, its motion, and its simulated plant.
//!
//! ```text
//! machine_file ─► plan: tap tables of all axes ─► hardware: what is built of all that
//!   └─► control ─► gains            └─► motion, contour ─► simulation on the plant
//! ```
//!
//! Shapers come from `posicast_shaper`, blocks from `posicast_blocks`. Nothing here reads or writes files.

pub mod compare;
pub mod contour;
pub mod control;
pub mod hardware;
pub mod machine_file;
pub mod mechanics;
pub mod motion;
pub mod plan;
pub mod plant;
pub mod simulation;
pub mod spelling;
pub mod unit;
