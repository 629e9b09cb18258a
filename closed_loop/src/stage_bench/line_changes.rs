//! The lines of an axis with steps in the tick that has most of them, for a picture.

/// Number of changes in a tick that are recorded.
const MOST_CHANGES: usize = 64;

/// Levels of an axis's two lines from a clock on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LineChange {
    /// Number of clocks since the tick.
    pub clock: u64,
    /// The first line and the second, as its mode names them.
    pub levels: [bool; 2],
}

/// Finds the busiest tick of a run.
#[derive(Debug, Clone, Default)]
pub(super) struct LineRecord {
    tick: u64,
    /// Changes since the last tick, which begin with the levels at the tick.
    present: Vec<LineChange>,
    busiest: Vec<LineChange>,
}

impl LineRecord {
    /// Begins a tick, in this clock.
    pub(super) fn tick(&mut self, now: u64) {
        if self.present.len() > self.busiest.len() {
            self.busiest.clone_from(&self.present);
        }
        let last = self.present.last().copied();
        self.present.clear();
        self.present.extend(last.map(|last| LineChange { clock: 0, ..last }));
        self.tick = now;
    }

    /// Takes the levels of a clock.
    pub(super) fn pass(&mut self, now: u64, levels: [bool; 2]) {
        let is_new = self.present.last().is_none_or(|last| last.levels != levels);
        if is_new && self.present.len() < MOST_CHANGES {
            let clock = now - self.tick;
            self.present.push(LineChange { clock, levels });
        }
    }

    /// The changes of the busiest tick that is over, the first at its beginning; empty if no line changed in any.
    pub(super) fn busiest(self) -> Vec<LineChange> {
        if self.busiest.len() > 1 {
            self.busiest
        } else {
            Vec::new()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_busiest_tick_is_kept_with_the_levels_at_its_beginning() {
        let mut record = LineRecord::default();
        record.pass(0, [false, false]);
        // A step in the first tick, two in the second, and one in the third.
        for (tick, pulses) in [(10, vec![12]), (20, vec![21, 25]), (30, vec![34])] {
            record.tick(tick);
            for pulse in pulses {
                record.pass(pulse, [true, tick == 20]);
                record.pass(pulse + 1, [true, tick == 20]);
                record.pass(pulse + 2, [false, tick == 20]);
            }
        }
        record.tick(40);
        let found: Vec<_> = record
            .busiest()
            .iter()
            .map(|change| (change.clock, change.levels))
            .collect();
        assert_eq!(
            found,
            [
                (0, [false, false]),
                (1, [true, true]),
                (3, [false, true]),
                (5, [true, true]),
                (7, [false, true])
            ]
        );
    }

    #[test]
    fn lines_at_rest_show_nothing() {
        let mut record = LineRecord::default();
        for now in 0..100 {
            if now % 10 == 0 {
                record.tick(now);
            }
            record.pass(now, [false, true]);
        }
        assert_eq!(record.busiest(), []);
    }
}
