//! Reads numbers that were computed elsewhere.

use serde_json::Value;

/// Returns the list under `key` of a JSON text.
pub(crate) fn rows(text: &str, key: &str) -> Vec<Value> {
    let document: Value = serde_json::from_str(text).unwrap();
    document[key].as_array().unwrap().clone()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

#[track_caller]
pub(crate) fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found} instead of {expected}"
    );
}
