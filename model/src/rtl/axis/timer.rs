//! The timer of brake and shaper, in ticks.

use super::ports::Inputs;

/// What begins, and how long it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Begins {
    /// The brake is released: `brake_release_ticks`.
    Release,
    /// The shaped command settles: `settle_ticks`.
    Settle,
    /// The brake is applied: `brake_apply_ticks`.
    Apply,
}

/// Loaded a clock after what begins, and over two clocks after that at the earliest: both are between two ticks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Timer {
    left: u16,
    /// No tick was left a clock ago.
    over: bool,
    /// What began a clock ago.
    loads: Option<Begins>,
}

impl Timer {
    /// With so many ticks left, and nothing that begins.
    #[cfg(test)]
    pub(super) fn left(left: u16) -> Self {
        Self {
            left,
            over: left == 0,
            loads: None,
        }
    }

    /// Is it over?
    pub(super) fn elapsed(&self) -> bool {
        self.over && self.loads.is_none()
    }

    /// One clock: `counts` a tick, and what begins in it.
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
