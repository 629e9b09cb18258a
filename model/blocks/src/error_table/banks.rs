//! The two tables: how bank 1 is loaded, and how a host reads an entry back.

use super::config::{ErrorTableConfig, MOST_ENTRIES};
use super::ports::Inputs;

/// Bank 0, the machine's, and bank 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Banks {
    machine: Vec<i32>,
    /// Of bank 1; the first `loaded` were written since the reset, the rest is arbitrary.
    entries: Vec<i32>,
    loaded: usize,
    most_step: i32,
    refused: bool,
    read_waits: bool,
    /// Word of the memory in this clock, if it is for the host.
    served: Option<i32>,
    found: i32,
}

impl Banks {
    pub(super) fn new(config: &ErrorTableConfig) -> Self {
        Self {
            machine: config.entries().to_vec(),
            entries: vec![0; MOST_ENTRIES],
            loaded: 0,
            most_step: config.format().most_step(),
            refused: false,
            read_waits: false,
            served: None,
            found: 0,
        }
    }

    pub(super) fn reset(&mut self) {
        self.loaded = 0;
        (self.refused, self.read_waits, self.served, self.found) = Default::default();
    }

    pub(super) fn complete(&self) -> bool {
        self.loaded == self.machine.len()
    }

    /// The entries of a bank.
    pub(super) fn entries(&self, loaded: bool) -> &[i32] {
        if loaded {
            &self.entries[..self.loaded]
        } else {
            &self.machine
        }
    }

    pub(super) fn refused(&self) -> bool {
        self.refused
    }

    pub(super) fn found(&self) -> i32 {
        self.found
    }

    pub(super) fn read_waits(&self) -> bool {
        self.read_waits
    }

    /// Whether a clock changes something of a host's read.
    pub(super) fn reads(&self, error_read: bool, busy: bool) -> bool {
        error_read && !self.read_waits || self.read_waits && (self.served.is_some() || !busy)
    }

    /// One clock. `in_use`: bank 1 is; `busy`: a pass reads.
    pub(super) fn step(&mut self, inputs: &Inputs, in_use: bool, busy: bool) {
        let index = usize::from(inputs.error_index);
        let serves = self.read_waits && self.served.is_none() && !busy && !inputs.error_write;
        self.found = self.served.unwrap_or(self.found);
        self.read_waits = inputs.error_read || self.read_waits && self.served.is_none();
        self.served = serves.then(|| self.entries(inputs.error_bank).get(index).copied().unwrap_or(0));
        let taken = inputs.error_bank && !in_use && self.takes(index, inputs.error_entry);
        if inputs.error_write && taken {
            self.entries[index] = inputs.error_entry;
            self.loaded = index + 1;
        }
        self.refused = inputs.error_write && !taken;
    }

    /// The first entry begins anew; others follow in turn, none too far from the one before.
    fn takes(&self, index: usize, entry: i32) -> bool {
        let Some(before) = index.checked_sub(1) else {
            return true;
        };
        index == self.loaded && !self.complete() && (entry - self.entries[before]).abs() <= self.most_step
    }
}
