//! The sources that turn the outputs off: fault latch, filtered faults, PLL, watchdog.

use super::ports::Inputs;

/// A synchroniser and a filter; the fault is active once the line has been low for more than `filter_clocks`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct FilteredFault {
    fault: [bool; 2],
    clocks: u8,
}

impl FilteredFault {
    #[inline]
    fn clock(&mut self, fault: bool, filter_clocks: u8) -> bool {
        let long = self.clocks >= filter_clocks;
        let active = self.fault[1] && long;
        self.clocks = match self.fault[1] {
            false => 0,
            true if long => self.clocks,
            true => self.clocks + 1,
        };
        self.fault = [fault, self.fault[0]];
        active
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Trip {
    /// Whether the fault latch is clear; it is set after reset.
    armed: bool,
    armed_seen: [bool; 2],
    fault_free: [bool; 2],
    unlocked: [bool; 2],
    lines: [FilteredFault; 2],
    filtered: [bool; 2],
    pll: bool,
    watchdog: bool,
    /// Number of valleys since the last `feed`.
    unfed: u8,
}

impl Trip {
    /// Whether the pins may be on, given the raw inputs of this clock.
    #[inline]
    pub(super) fn armed(&self, inputs: &Inputs) -> bool {
        self.armed && inputs.fault_n && inputs.pll_locked
    }

    #[inline]
    pub(super) fn tripped(&self) -> bool {
        !self.armed_seen[1] || self.filtered[0] || self.filtered[1] || self.pll || self.watchdog
    }

    pub(super) fn causes(&self) -> u8 {
        let causes = [
            !self.armed_seen[1],
            self.filtered[0],
            self.filtered[1],
            self.pll,
            self.watchdog,
        ];
        (0..).zip(causes).map(|(at, cause)| u8::from(cause) << at).sum()
    }

    /// Simulates one clock; `running` and `valley` are of this clock.
    #[inline]
    pub(super) fn clock(&mut self, inputs: &Inputs, running: bool, valley: bool) {
        let armed = self.armed(inputs);
        let over = !self.armed_seen[1] && self.fault_free[1] && !self.unlocked[1];
        let clears_latch = inputs.clear_trip && !running && over;
        self.armed = inputs.fault_n && inputs.pll_locked && (self.armed || clears_latch);
        self.armed_seen = [armed, self.armed_seen[0]];

        let keep = !inputs.clear_trip;
        for (at, line) in self.lines.iter_mut().enumerate() {
            let fault = inputs.filtered_fault_n >> at & 1 == 0;
            self.filtered[at] = line.clock(fault, inputs.filter_clocks) || (self.filtered[at] && keep);
        }
        self.pll = self.unlocked[1] || (self.pll && keep);
        self.fault_free = [inputs.fault_n, self.fault_free[0]];
        self.unlocked = [!inputs.pll_locked, self.unlocked[0]];

        let waits = running && !inputs.feed;
        let starved = valley && inputs.watchdog_periods != 0 && self.unfed >= inputs.watchdog_periods;
        self.watchdog = (waits && starved) || (self.watchdog && keep);
        self.unfed = if waits {
            self.unfed.saturating_add(u8::from(valley))
        } else {
            0
        };
    }
}
