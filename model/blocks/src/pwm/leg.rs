//! The leg, between the carrier and the gates, simulated clock by clock.
//!
//! For any command, and from any state, both sides are never on together, the dead time separates the turn-off of one
//! side from the turn-on of the other, and a side that is on stays on for the minimum pulse, unless everything is
//! switched off.

/// Command of the carrier to the leg: nothing, or one side on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Want {
    #[default]
    Off,
    Low,
    High,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Leg {
    /// Whether a side has been on since everything was off.
    awake: bool,
    /// Whether `side` is on, as opposed to waiting to be on.
    lit: bool,
    /// Whether the side is the high one.
    high: bool,
    /// Remaining clocks of dead time or minimum pulse.
    pub(super) timer: u16,
}

impl Leg {
    pub(super) fn awake(&self) -> bool {
        self.awake
    }

    /// Whether the high side is on, and whether the low side is on.
    pub(super) fn sides(&self) -> (bool, bool) {
        (self.lit && self.high, self.lit && !self.high)
    }

    /// Whether the other leg of a bridge may take over: everything is off, or the low side is on.
    pub(super) fn may_turn(&self) -> bool {
        !self.awake || (self.lit && !self.high)
    }

    /// Simulates one clock. With `low_first` the low side turns on first after everything was off, for any command.
    #[inline]
    pub(super) fn clock(&mut self, want: Want, low_first: bool, dead_time: u16, minimum_pulse: u16) {
        let wants_high = want == Want::High;
        if want == Want::Off {
            *self = Self {
                timer: dead_time,
                ..Self::default()
            };
        } else if self.timer != 0 {
            self.timer -= 1;
        } else if !self.lit {
            self.high = if self.awake {
                self.high
            } else {
                wants_high && !low_first
            };
            (self.awake, self.lit) = (true, true);
            self.timer = minimum_pulse - 1;
        } else if self.high != wants_high {
            self.lit = false;
            self.high = wants_high;
            self.timer = dead_time - 1;
        }
    }
}
