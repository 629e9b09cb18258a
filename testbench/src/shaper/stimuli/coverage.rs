//! Counts what a run reached.

use std::fmt;

use crate::lockstep::Clock;
use crate::shaper::Layout;

/// Counts of the events, over all shapers of a [`Layout`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Coverage {
    /// Number of clocks.
    pub clocks: u64,
    /// Number of clocks with `rst`.
    pub resets: u64,
    /// Number of clocks with `strobe`.
    pub strobes: u64,
    /// Number of strobes with `start`.
    pub starts: u64,
    /// Number of taps written.
    pub tap_writes: u64,
    /// Number of clocks with `valid`.
    pub valid: u64,
    /// Number of times that `saturated` rose.
    pub saturated: u64,
    /// Number of times that `overrun` rose.
    pub overrun: u64,
    /// Number of times that `refused` rose.
    pub refused: u64,
    /// Number of times that a host's read returned a tap.
    pub taps_read_back: u64,
    /// Number of times that a swap became pending.
    pub swaps_requested: u64,
    /// Number of times that `bank` changed to a bank other than 0.
    pub swaps: u64,
    /// Number of times that a swap took effect without being complete, so that a handover began. Only a motion shaper
    /// has handovers.
    pub handovers: u64,
    /// Number of times that a handover ended: by itself, by a start or by a reset.
    pub handovers_over: u64,
    /// Number of times that a sticky flag was cleared.
    pub flags_cleared: u64,
    seen: Vec<[u64; 6]>,
}

impl Coverage {
    /// Adds a clock.
    pub fn observe(&mut self, layout: &Layout, clock: &Clock<'_>) {
        self.seen.resize(layout.axes.len(), [0; 6]);
        let strobe = clock.inputs[layout.strobe] & 1;
        self.clocks += 1;
        self.resets += clock.inputs[layout.rst] & 1;
        self.strobes += strobe;
        for (axis, seen) in layout.axes.iter().zip(&mut self.seen) {
            let out = clock.expected;
            self.starts += strobe & clock.inputs[axis.start];
            self.valid += out[axis.valid];
            let mut now = [0; 6];
            now[1] = out[axis.overrun];
            if let Some(tables) = &axis.tables {
                self.tap_writes += clock.inputs[tables.tap_write] & 1;
                now = [
                    out[tables.saturated],
                    out[axis.overrun],
                    out[tables.refused],
                    out[tables.swap_pending],
                    out[tables.bank],
                    out[tables.tap_read_waits],
                ];
                let is_read = now[5] < seen[5] && out[tables.loaded_coefficient] != 0;
                self.taps_read_back += u64::from(is_read);
            }
            let rose = |flag: usize| u64::from(now[flag] > seen[flag]);
            self.saturated += rose(0);
            self.overrun += rose(1);
            self.refused += rose(2);
            self.swaps_requested += rose(3);
            self.swaps += u64::from(now[4] != seen[4] && now[4] != 0);
            self.handovers += u64::from(now[3] != 0 && now[4] != seen[4]);
            self.handovers_over += u64::from(now[3] < seen[3] && now[4] == seen[4]);
            self.flags_cleared += (0..3).map(|flag| u64::from(now[flag] < seen[flag])).sum::<u64>();
            *seen = now;
        }
    }

    /// Returns the names of the counters that are zero.
    pub fn missing(&self) -> Vec<&'static str> {
        let all = self.counts();
        all.iter()
            .filter(|(_, count)| *count == 0)
            .map(|(name, _)| *name)
            .collect()
    }

    /// Returns each event's name and count, without handovers, which not every shaper has.
    pub fn counts(&self) -> [(&'static str, u64); 12] {
        [
            ("resets", self.resets),
            ("strobes", self.strobes),
            ("starts", self.starts),
            ("tap writes", self.tap_writes),
            ("valid", self.valid),
            ("saturated", self.saturated),
            ("overrun", self.overrun),
            ("refused", self.refused),
            ("taps read back", self.taps_read_back),
            ("swaps requested", self.swaps_requested),
            ("swaps", self.swaps),
            ("flags cleared", self.flags_cleared),
        ]
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} clocks", self.clocks)?;
        self.counts()
            .iter()
            .try_for_each(|(name, count)| write!(f, ", {name} {count}"))
    }
}
