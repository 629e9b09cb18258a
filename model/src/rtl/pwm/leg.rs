//! The leg: what stands between the carrier and the gates, clock by clock.
//!
//! Whatever it is told, and from whatever state: never are both sides on; between one side's off and the other's on there is
//! the dead time; a side that is on stays on for the minimum pulse, unless all goes off.

/// What the carrier wants of the leg: nothing, or one side on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Want {
    #[default]
    Off,
    Low,
    High,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Leg {
    /// A side has been on since all was off.
    awake: bool,
    /// `side` is on, not yet to be.
    lit: bool,
    /// The high side, else the low side.
    high: bool,
    /// Clocks of dead time or minimum pulse that are left.
    pub(super) timer: u16,
}

impl Leg {
    pub(super) fn awake(&self) -> bool {
        self.awake
    }

    /// High side on, low side on.
    pub(super) fn sides(&self) -> (bool, bool) {
        (self.lit && self.high, self.lit && !self.high)
    }

    /// Whether the other leg of a bridge may take over: all is off, or the low side is on.
    pub(super) fn may_turn(&self) -> bool {
        !self.awake || (self.lit && !self.high)
    }

    /// `low_first`: after all was off, the low side comes first, whatever is wanted by then.
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
