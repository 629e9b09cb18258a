//! Counts the coverage of a block that defines no bins.

use posicast_blocks::{Direction, Port};

use super::Bins;
use crate::lockstep::Clock;

/// Number of changes of each output.
pub(crate) struct Changes {
    names: Vec<String>,
    before: Vec<u64>,
    counts: Vec<u64>,
}

impl Changes {
    pub(crate) fn new(ports: &[Port]) -> Self {
        let outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let names: Vec<String> = outputs.map(|port| port.name.clone()).collect();
        Self {
            before: vec![0; names.len()],
            counts: vec![0; names.len()],
            names,
        }
    }
}

impl Bins for Changes {
    fn observe(&mut self, clock: &Clock<'_>) {
        for ((value, before), count) in clock.expected.iter().zip(&mut self.before).zip(&mut self.counts) {
            *count += u64::from(value != before);
            *before = *value;
        }
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.names.iter().cloned().zip(self.counts.iter().copied()).collect()
    }
}
