//! Warnings about a machine file: each names its file, line and key.

use crate::machine;
use crate::observer::Observer;
use std::path::Path;

/// A warning about a key of a machine file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Warning {
    /// Index of the axis, from 0; any index for a key outside the axes.
    pub(crate) axis: usize,
    /// The dotted key, such as `axis.limits.watchdog_s`; the line is that of its table if the key is absent.
    pub(crate) key: String,
    /// What was found, and what to do.
    pub(crate) text: String,
}

impl Warning {
    pub(crate) fn new(axis: usize, key: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            axis,
            key: key.into(),
            text: text.into(),
        }
    }

    /// Reports it to the front; `path` is the machine file, or the folder that contains it.
    pub(crate) fn tell(&self, path: &Path, observer: &dyn Observer) {
        let placed = machine::place(path, self.axis, &self.key, &self.text);
        observer.say(&format!("warning: {placed}"));
    }
}
