//! Counts of the events in a lockstep run of the position capture.

use posicast_blocks::capture::{ENTRIES, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs};

use crate::lockstep::Clock;

/// Names of the counted events.
const NAMES: [&str; 27] = [
    "rising edges captured",
    "falling edges captured",
    "edges that are not wanted",
    "edges while disabled",
    "edges at the first position of the window",
    "edges at the last position of the window",
    "edges below the window",
    "edges above the window",
    "edges at an empty window",
    "edges captured by the second axis",
    "edges captured by the third axis",
    "edges captured by the last axis",
    "edges in two successive clocks",
    "memory full",
    "edges at a full memory",
    "edges at a full memory outside the window",
    "edges at a full memory in the clock of take",
    "edges in the clock of clear",
    "last entries taken in the clock of an edge",
    "takes of nothing",
    "takes of an entry that is not yet shown",
    "clears of entries",
    "flags in the clock of clear_flags",
    "resets with entries",
    "first level high",
    "first level low",
    "changes of filter_clocks",
];

/// Counts of the events in a lockstep run of the position capture.
#[derive(Debug, Clone)]
pub struct CaptureCoverage {
    counts: [u64; NAMES.len()],
    before: Option<(Inputs, Outputs)>,
    edge_before: bool,
}

impl Default for CaptureCoverage {
    fn default() -> Self {
        Self {
            counts: [0; NAMES.len()],
            before: None,
            edge_before: false,
        }
    }
}

impl CaptureCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(outputs)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let (inputs, now) = (Inputs::from_raw(inputs), Outputs::from_raw(outputs));
        if let Some((asked, before)) = self.before {
            self.count(&inputs, &asked, &before, &now);
        }
        self.before = Some((inputs, now));
    }

    fn count(&mut self, inputs: &Inputs, asked: &Inputs, before: &Outputs, now: &Outputs) {
        let has_edge = !inputs.rst && before.level_known && now.level_known && now.level != before.level;
        let wanted = has_edge && inputs.wants(now.level);
        let count = inputs.count[usize::from(inputs.window_axis)];
        let (first, last) = (inputs.window_first, inputs.window_last);
        let is_empty = first > last;
        let windowed = wanted && inputs.windowed && !is_empty;
        let offered = wanted && inputs.is_inside();
        let is_full = usize::from(now.entries) == ENTRIES;
        let makes_room = inputs.clear || (inputs.take && now.entry_valid);
        let by_axis = |axis| offered && inputs.windowed && inputs.window_axis == axis;
        let shown_first = now.level_known && !before.level_known;
        let set = |of: fn(&Outputs) -> bool| of(now) && (!of(before) || asked.clear_flags);
        let events = [
            offered && now.level && (!is_full || makes_room),
            offered && !now.level && (!is_full || makes_room),
            has_edge && inputs.enable && !wanted,
            has_edge && !inputs.enable,
            windowed && count == first && first < last,
            windowed && count == last && first < last,
            windowed && count < first,
            windowed && count > last,
            wanted && inputs.windowed && is_empty,
            by_axis(1),
            by_axis(2),
            by_axis(3),
            has_edge && self.edge_before,
            is_full,
            offered && is_full && !makes_room,
            wanted && !offered && is_full,
            offered && is_full && inputs.take && !inputs.clear,
            wanted && inputs.clear,
            offered && inputs.take && now.entry_valid && now.entries == 1,
            inputs.take && now.entries == 0,
            inputs.take && now.entries > 0 && !now.entry_valid,
            inputs.clear && now.entries > 0,
            asked.clear_flags && (set(|shown| shown.overflowed) || set(|shown| shown.outside)),
            inputs.rst && now.entries > 0,
            shown_first && now.level,
            shown_first && !now.level,
            inputs.filter_clocks != asked.filter_clocks,
        ];
        for (count, event) in self.counts.iter_mut().zip(events) {
            *count += u64::from(event);
        }
        self.edge_before = has_edge;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        NAMES.into_iter().zip(self.counts)
    }
}
