//! The plan of a machine: the tap tables of all its axes with one common `F` and, with `[stage]`, one delay.
//!
//! [`design_machine`] makes it, [`certify_axis`] bounds the residual of its integer tables, and [`blame()`] names the key of the machine
//! file to change if there is no plan.

mod blame;
mod certificate;
pub mod family;
mod machine;
pub mod matching;

pub use blame::{DesignBlame, blame};
pub use certificate::{AxisCertificate, CornerFigures, ModeCertificate, certify_axis, measure_corners};
pub use family::{FamilyMember, TableFamily};
pub use machine::{AxisTables, MachineDesign, ModeFigures, design_machine};
pub use matching::{AxisDelay, StageDelay};
