//! The timer of brake and shaper, which counts ticks.

use super::ports::Inputs;

/// Event that starts the timer, with the time that it takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Begins {
    /// The brake is released: `brake_release_ticks`.
    Release,
    /// The shaped command settles: `settle_ticks`.
    Settle,
    /// The brake is applied: `brake_apply_ticks`.
    Apply,
}

/// A timer that is loaded a clock after its event and over two clocks after that at the earliest; both come between
/// two ticks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Timer {
    left: u16,
    /// Whether no tick was left one clock ago.
    over: bool,
    /// Event of the clock before, which loads the timer.
    loads: Option<Begins>,
}

impl Timer {
    /// A timer with this many ticks left and no event.
    #[cfg(test)]
    pub(super) fn left(left: u16) -> Self {
        Self {
            left,
            over: left == 0,
            loads: None,
        }
    }

    /// Returns whether the time is over.
    pub(super) fn elapsed(&self) -> bool {
        self.over && self.loads.is_none()
    }

    /// Simulates one clock. With `counts` a tick counts down the time; `begins` is the event of this clock.
    pub(super) fn clock(&mut self, inputs: &Inputs, counts: bool, begins: Option<Begins>) {
        self.over = self.left == 0 && self.loads.is_none();
        self.left = match self.loads {
            Some(Begins::Release) => inputs.brake_release_ticks,
            Some(Begins::Settle) => inputs.settle_ticks,
            Some(Begins::Apply) => inputs.brake_apply_ticks,
            None => self.left.saturating_sub(u16::from(counts)),
        };
        self.loads = begins;
    }
}
