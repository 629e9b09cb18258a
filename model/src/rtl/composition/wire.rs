//! A net while its composition is clocked: its value, now and in the clock before.

/// A net. Times are in clocks of the composition.
#[derive(Debug, Clone, Default)]
pub(super) struct Wire {
    /// In the clock `since`, and in those after it.
    value: u64,
    /// In the clock before `since`.
    before: u64,
    since: u64,
    /// Of a counter: ones in its width. It goes up by one per clock from `value` on.
    counts: Option<u64>,
    /// The members that look at it even while they are quiet.
    pub(super) watchers: Vec<usize>,
}

impl Wire {
    /// A net whose driver is a [counter](crate::rtl::OutputKind::Counter) of so many bits.
    pub(super) fn counter(width: u32) -> Self {
        Self {
            counts: Some(u64::MAX >> (64 - width.clamp(1, 64))),
            ..Self::default()
        }
    }

    pub(super) fn counts(&self) -> bool {
        self.counts.is_some()
    }

    /// What it shows so many clocks after it showed `value`, if nothing happens.
    #[inline]
    pub(super) fn later(&self, value: u64, clocks: u64) -> u64 {
        match self.counts {
            None => value,
            Some(ones) => value.wrapping_add(clocks) & ones,
        }
    }

    /// Its value in a clock: from the one before its last change on.
    #[inline]
    pub(super) fn at(&self, clock: u64) -> u64 {
        if clock < self.since {
            self.before
        } else {
            self.later(self.value, clock - self.since)
        }
    }

    /// Gives it a value from this clock on. Returns whether that is a change.
    #[inline]
    pub(super) fn set(&mut self, value: u64, clock: u64) -> bool {
        if self.at(clock) == value {
            return false;
        }
        if self.since < clock {
            self.before = self.at(clock - 1);
            self.since = clock;
        }
        self.value = value;
        true
    }
}
