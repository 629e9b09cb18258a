//! The native module of the Python package `wavecmp`: the comparison and the command, which the Python files beside it wrap.

#[path = "../../posicast/src/waited.rs"]
mod waited;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `wavecmp` with these words, and returns its exit status.
#[pyfunction]
fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| wavecmp::cli::main(words))
}

/// Compares two files as the command with these words does; returns the JSON document, or `None` and the message of
/// an error.
#[pyfunction]
fn compare(py: Python<'_>, words: Vec<OsString>) -> PyResult<(Option<String>, Option<String>)> {
    let compared = waited::waited(py, move || {
        let compared = wavecmp::cli::compare(words).map_err(|error| error.to_string())?;
        serde_json::to_string(&compared).map_err(|error| error.to_string())
    })?;
    Ok(match compared {
        Ok(document) => (Some(document), None),
        Err(message) => (None, Some(message)),
    })
}

/// Version of the package.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// The JSON Schema of a comparison.
#[pyfunction]
fn schema() -> &'static str {
    wavecmp::diff::JSON_SCHEMA
}

/// Functions of the package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{compare, program, schema, version};
}
