//! Measures how good the checks of the blocks are, and writes the tables of `ladder/RESULTS.md`.
//!
//! - [`coverage`] measures which lines, nets and conditions a lock step reaches, and requires a reason for the rest.
//! - [`mutation`] puts faults into the blocks, and finds out which checks detect them.
//! - [`proofs`] lists the proofs.
//! - [`netlist`] simulates and proves what a synthesiser made of a block; [`netlist_table`] lists those that are equal to their RTL.
//! - [`unset`] proves that a block forgets in a reset what was before.
//! - [`crossings`] checks the logic behind each asynchronous pin.
//! - [`table`] puts the results of all rungs of the verification ladder into one table.
//! - [`page`] renews a table of `ladder/RESULTS.md`.

pub mod coverage;
pub mod crossings;
pub mod mutation;
pub mod netlist;
pub mod netlist_table;
pub mod page;
pub mod proofs;
mod sides;
pub mod table;
pub mod unset;
