//! A net in a running composition: its value, now and in the clock before.

/// A net. Times count in clocks of the composition.
#[derive(Debug, Clone, Default)]
pub(super) struct Wire {
    /// Value in the clock `since` and after it.
    value: u64,
    /// Value in the clock before `since`.
    before: u64,
    since: u64,
    /// For a counter, the mask of its width: it goes up by one per clock, starting from `value`.
    counts: Option<u64>,
    /// Members that depend on it even while they are quiet.
    pub(super) watchers: Vec<usize>,
    /// Members that read it only in clocks that are not quiet.
    pub(super) ignorers: Vec<usize>,
    /// Whether the composition shows it.
    pub(super) is_output: bool,
}

impl Wire {
    /// A net whose driver is a [counter](crate::OutputKind::Counter) of this many bits.
    pub(super) fn counter(width: u32) -> Self {
        Self {
            counts: Some(u64::MAX >> (64 - width.clamp(1, 64))),
            ..Self::default()
        }
    }

    pub(super) fn counts(&self) -> bool {
        self.counts.is_some()
    }

    /// Its value this many clocks after `value`, if nothing happens.
    #[inline]
    pub(super) fn later(&self, value: u64, clocks: u64) -> u64 {
        match self.counts {
            None => value,
            Some(ones) => value.wrapping_add(clocks) & ones,
        }
    }

    /// Its value in a clock, which must not lie before the one before its last change.
    #[inline]
    pub(super) fn at(&self, clock: u64) -> u64 {
        if clock < self.since {
            self.before
        } else {
            self.later(self.value, clock - self.since)
        }
    }

    /// Sets its value from this clock on. Returns whether that is a change.
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
