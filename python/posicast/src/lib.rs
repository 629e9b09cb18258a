//! The native module of the Python package `posicast`: private functions and classes, which the Python files beside it wrap.
//!
//! Nothing is computed here. Shapers come from `posicast-machine` and `posicast-shaper`, the hardware's integers from `posicast-blocks`,
//! documents and steps from `posicast-flow`, the command from `posicast`.

mod design;
mod error;
mod machine;
mod taps;
mod waited;
mod worker;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `posicast` with these words, and returns its exit status.
#[pyfunction]
fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| posicast_cli::main(words))
}

/// Version of the package.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The JSON Schema with this name; `None` if there is none.
#[pyfunction]
fn schema(name: &str) -> Option<String> {
    posicast_cli::schema::text(name)
}

/// Names of the schemas.
#[pyfunction]
fn schema_names() -> Vec<String> {
    posicast_cli::schema::names()
}

/// Functions and classes of the package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::design::{Design, RealStream, compare_text, design_text};
    #[pymodule_export]
    use super::machine::{MachineFile, identify_log};
    #[pymodule_export]
    use super::taps::{Stream, Taps};
    #[pymodule_export]
    use super::worker::worker;
    #[pymodule_export]
    use super::{program, schema, schema_names, version};
}
