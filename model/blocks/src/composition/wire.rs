//! A net in a running composition.

/// A net. Times count in clocks of the composition.
#[derive(Debug, Clone, Default)]
pub(super) struct Wire {
    /// Value in the clock `since` and after it.
    value: u64,
    since: u64,
    /// For a counter, the mask of its width: it goes up by one per clock, starting from `value`.
    counts: Option<u64>,
    /// Inputs of members that depend on it even while they are quiet.
    pub(super) watchers: Vec<MemberInput>,
    /// Inputs of members that read it only in clocks that are not quiet.
    pub(super) ignorers: Vec<MemberInput>,
    /// Index of the output of the composition that shows it.
    pub(super) output: Option<usize>,
}

/// An input of a member, by their indices.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemberInput {
    pub(super) member: usize,
    pub(super) input: usize,
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

    /// Its value in a clock, which must not lie before its last change.
    #[inline]
    pub(super) fn at(&self, clock: u64) -> u64 {
        self.later(self.value, clock.wrapping_sub(self.since))
    }

    /// Sets its value from this clock on.
    #[inline]
    pub(super) fn set(&mut self, value: u64, clock: u64) {
        (self.value, self.since) = (value, clock);
    }
}
