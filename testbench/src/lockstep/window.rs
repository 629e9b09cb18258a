//! The clocks around a mismatch: a ring of the latest ones, and the few that follow.

use posicast_blocks::{Direction, Port};

/// One clock with all ports.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) time: u64,
    pub(super) inputs: Vec<u64>,
    pub(super) expected: Vec<u64>,
    pub(super) actual: Vec<u64>,
    pub(super) unknown: Vec<u64>,
}

impl Row {
    fn copy_from(&mut self, time: u64, inputs: &[u64], expected: &[u64], actual: &[u64], unknown: &[u64]) {
        self.time = time;
        self.inputs.copy_from_slice(inputs);
        self.expected.copy_from_slice(expected);
        self.actual.copy_from_slice(actual);
        self.unknown.copy_from_slice(unknown);
    }
}

/// Rows before, at and after one clock. Until a mismatch is found it is a ring that drops the oldest row.
#[derive(Debug, Clone)]
pub(super) struct Window {
    rows: Vec<Row>,
    /// Index of the oldest row once the ring is full.
    next: usize,
    filled: usize,
    clocks_after: usize,
    /// Clock and output of the mismatch.
    pub(super) mismatch: (u64, usize),
}

impl Window {
    /// Keeps the latest `clocks` rows and the present one.
    pub(super) fn new(ports: &[Port], clocks: usize) -> Self {
        let count = |direction| ports.iter().filter(|p| p.direction == direction).count();
        let outputs = vec![0; count(Direction::Output)];
        let row = Row {
            time: 0,
            inputs: vec![0; count(Direction::Input)],
            expected: outputs.clone(),
            actual: outputs.clone(),
            unknown: outputs,
        };
        // Nobody reads more than this, and a huge number must not use up the memory.
        let clocks = clocks.min(1000);
        Self {
            rows: vec![row; clocks + 1],
            next: 0,
            filled: 0,
            clocks_after: clocks,
            mismatch: (0, 0),
        }
    }

    /// Number of clocks that are kept.
    pub(super) fn clocks(&self) -> u64 {
        self.rows.len() as u64
    }

    /// Stores a clock and drops the oldest one.
    pub(super) fn push(&mut self, time: u64, inputs: &[u64], expected: &[u64], actual: &[u64], unknown: &[u64]) {
        self.rows[self.next].copy_from(time, inputs, expected, actual, unknown);
        self.next = (self.next + 1) % self.rows.len();
        self.filled = (self.filled + 1).min(self.rows.len());
    }

    /// The rows so far, in order, as the start of the window around a mismatch in the latest clock.
    pub(super) fn opened_at(&self, time: u64, output: usize) -> Self {
        let oldest = if self.filled < self.rows.len() { 0 } else { self.next };
        let ordered = (0..self.filled).map(|n| self.rows[(oldest + n) % self.rows.len()].clone());
        Self {
            rows: ordered.collect(),
            next: 0,
            filled: 0,
            clocks_after: self.clocks_after,
            mismatch: (time, output),
        }
    }

    /// Adds a clock after the mismatch, if it still belongs to the window.
    pub(super) fn extend(&mut self, time: u64, inputs: &[u64], expected: &[u64], actual: &[u64], unknown: &[u64]) {
        if time - self.mismatch.0 > self.clocks_after as u64 {
            return;
        }
        self.rows.push(Row {
            time,
            inputs: inputs.to_vec(),
            expected: expected.to_vec(),
            actual: actual.to_vec(),
            unknown: unknown.to_vec(),
        });
    }

    /// The rows in order of time, once the window was opened.
    pub(super) fn rows(&self) -> &[Row] {
        &self.rows
    }
}
