//! The pulser: gives one owed step after the other as soon as the times of the lines allow it.

use super::StepGeneratorConfig;

/// Registers of the pulser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pulser {
    /// Whether the direction is up.
    pub(super) up: bool,
    /// Whether a pulse lasts.
    pub(super) pulsing: bool,
    /// Whether the direction has changed since the last pulse.
    turned: bool,
    /// Whether the hold after the last pulse is over.
    held: bool,
    /// Clocks since the pulse began, since it ended, or since the direction changed, whichever came last.
    since_clocks: u64,
}

impl Pulser {
    /// After a reset, which may have changed the direction.
    pub(super) fn new() -> Self {
        Self {
            up: false,
            pulsing: false,
            turned: true,
            held: false,
            since_clocks: 0,
        }
    }

    /// Simulates one clock in which a step in this direction is wanted, or none; returns whether it is given.
    pub(super) fn clock(&mut self, config: &StepGeneratorConfig, wants_up: Option<bool>) -> bool {
        let times = config.times();
        if self.pulsing {
            let ends = self.since_clocks == times.pulse_clocks;
            (self.pulsing, self.since_clocks) = if ends {
                (false, 1)
            } else {
                (true, self.since_clocks + 1)
            };
            return false;
        }
        self.held |= self.since_clocks >= times.direction_hold_clocks;
        let may_step = self.since_clocks >= self.rests_clocks(config);
        let gives = may_step && wants_up == Some(self.up);
        let turns = self.held && wants_up == Some(!self.up);
        if gives {
            *self = Self {
                pulsing: true,
                turned: false,
                held: false,
                since_clocks: 1,
                ..*self
            };
        } else if turns {
            (self.up, self.turned, self.since_clocks) = (!self.up, true, 1);
        } else {
            self.rest(config, 1);
        }
        gives
    }

    /// Clocks without a pulse before the next one may begin.
    fn rests_clocks(&self, config: &StepGeneratorConfig) -> u64 {
        if self.turned {
            config.turned_clocks()
        } else {
            config.times().space_clocks
        }
    }

    /// Clocks of this pulse that change nothing outside; `None` between pulses.
    pub(super) fn quiet_clocks(&self, config: &StepGeneratorConfig) -> Option<u64> {
        self.pulsing
            .then(|| config.times().pulse_clocks.saturating_sub(self.since_clocks))
    }

    /// Passes some clocks in which no pulse begins or ends.
    pub(super) fn rest(&mut self, config: &StepGeneratorConfig, clocks: u64) {
        self.since_clocks += clocks;
        if !self.pulsing {
            let hold_clocks = config.times().direction_hold_clocks;
            self.held |= self.since_clocks > hold_clocks;
            // Beyond both times nothing depends on the number, and a block at rest does not change.
            self.since_clocks = self.since_clocks.min(self.rests_clocks(config).max(hold_clocks + 1));
        }
    }
}
