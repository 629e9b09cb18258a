//! The line: a synchroniser, and a filter that knows no level until the line has been quiet once.

/// Clocks after a reset in which the synchroniser does not yet show the line.
const PRIMING_CLOCKS: u8 = 2;

/// The registers of the line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct CaptureLine {
    synchroniser: [bool; 2],
    /// Number of clocks since the reset, up to [`PRIMING_CLOCKS`].
    primed: u8,
    /// Synchronised line of the clock before.
    last: bool,
    /// Number of clocks that the line has had its new level; while no level is known, any level.
    lasted: u16,
    pub(super) level: bool,
    pub(super) known: bool,
    /// `level` has changed in this clock.
    changed: bool,
}

impl CaptureLine {
    /// The edge of this clock: whether it rises.
    pub(super) fn edge(&self) -> Option<bool> {
        self.changed.then_some(self.level)
    }

    pub(super) fn clock(&mut self, pin: bool, filter_clocks: u16) {
        let now = self.synchroniser[1];
        let is_new = self.primed == PRIMING_CLOCKS && !(self.known && now == self.level);
        // The count is below 2^16 - 1 here, because that many clocks satisfy every filter.
        let lasts = if self.known || now == self.last {
            self.lasted + 1
        } else {
            1
        };
        let settles = is_new && lasts >= filter_clocks;
        self.changed = settles && self.known;
        self.lasted = if is_new && !settles { lasts } else { 0 };
        if settles {
            (self.level, self.known) = (now, true);
        }
        self.last = now;
        self.synchroniser = [pin, self.synchroniser[0]];
        self.primed = (self.primed + 1).min(PRIMING_CLOCKS);
    }
}
