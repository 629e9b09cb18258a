//! Counts of the events in a lockstep run of an inline shaper.

use posicast_blocks::inline_shaper::InlineConfig;

use crate::lockstep::Clock;

/// The events, in the order of the counters.
const EVENTS: [&str; 9] = [
    "drives on",
    "drives off at once",
    "settles",
    "bypassed",
    "shaped again",
    "faults",
    "faults cleared",
    "edges of the steps",
    "edges of the steps while bypassed",
];
/// Outputs before those of the axes.
const SHARED: usize = 4;
/// Outputs of an axis.
const OF_AXIS: usize = 5;

/// Counts of the events in a lockstep run of an inline shaper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InlineShaperCoverage {
    axes: usize,
    before: Vec<u64>,
    counts: [u64; EVENTS.len()],
}

impl InlineShaperCoverage {
    /// Creates the counters.
    pub fn new(config: &InlineConfig) -> Self {
        Self {
            axes: config.axes.len(),
            before: Vec::new(),
            counts: [0; EVENTS.len()],
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let now = clock.expected;
        if self.before.len() == now.len() && now.len() >= SHARED + OF_AXIS * self.axes {
            let before = &self.before;
            let rises = |at: usize| now[at] > before[at];
            let falls = |at: usize| now[at] < before[at];
            let lines = (0..self.axes).flat_map(|axis| [SHARED + OF_AXIS * axis, SHARED + OF_AXIS * axis + 1]);
            let edges = lines.filter(|line| now[*line] != before[*line]).count() as u64;
            let events = [
                rises(0).into(),
                falls(0).into(),
                rises(1).into(),
                rises(2).into(),
                falls(2).into(),
                rises(3).into(),
                falls(3).into(),
                edges,
                edges * now[2],
            ];
            for (count, event) in self.counts.iter_mut().zip(events) {
                *count += event;
            }
        }
        self.before.clear();
        self.before.extend_from_slice(now);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); EVENTS.len()] {
        std::array::from_fn(|at| (EVENTS[at], self.counts[at]))
    }
}
