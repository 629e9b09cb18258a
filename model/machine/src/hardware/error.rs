//! Errors of the decision what to build, with the key of the machine file that is to blame.

use std::fmt;

/// Why a part of a machine cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct HardwareError {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// The key of the machine file to blame, such as `axis.pwm.frequency_hz`.
    pub key: String,
    /// The reason in words, with the remedy where `help` has none.
    pub reason: String,
    /// Remedy.
    pub help: Option<String>,
}

impl HardwareError {
    /// The error of a key of an axis.
    pub(crate) fn new(axis: usize, key: &str, reason: impl fmt::Display) -> Self {
        Self {
            axis,
            key: key.to_owned(),
            reason: reason.to_string(),
            help: None,
        }
    }

    /// The error with what to do about it.
    pub(crate) fn with_help(self, help: String) -> Self {
        Self {
            help: Some(help),
            ..self
        }
    }
}
