//! Tells whether signals change more than once from edge to edge.
//!
//! Most designs change signals at only one time between two edges, in the order of their declarations or in the reverse order. Each change
//! is marked only in designs that do not.

use super::batch::Change;

/// What has changed since the last edge.
#[derive(Default)]
pub(super) struct SinceEdge {
    /// Number of the stretch from edge to edge, and the last one in which each slot changed.
    stretch: u32,
    marks: Vec<u32>,
    /// Start of the changes that are not marked yet, all of different slots.
    unmarked: Option<usize>,
    is_busy: bool,
    /// Whether unmarked changes were handed over.
    is_lost: bool,
}

impl SinceEdge {
    /// Begins the next stretch.
    #[inline]
    pub(super) fn begin(&mut self) {
        self.stretch = self.stretch.wrapping_add(1);
        (self.unmarked, self.is_busy, self.is_lost) = (None, false, false);
    }

    /// Forgets where changes are in the batch.
    pub(super) fn forget_batch(&mut self) {
        self.is_lost |= self.unmarked.take().is_some();
    }

    /// Adds the changes of a step, from `from` on. Returns whether a slot other than the clock changes again in the stretch.
    #[inline]
    pub(super) fn add(&mut self, changes: &[Change], from: usize, clock: u32, slots: usize) -> bool {
        let step = &changes[from..];
        if step.is_empty() || matches!(step, [only] if only.slot() == clock) {
            return false;
        }
        if !std::mem::replace(&mut self.is_busy, true) {
            let rise = |pair: &[Change]| pair[0].slot() < pair[1].slot();
            let fall = |pair: &[Change]| pair[0].slot() > pair[1].slot();
            if step.windows(2).all(rise) || step.windows(2).all(fall) {
                self.unmarked = Some(from);
                return false;
            }
        }
        if self.marks.is_empty() {
            self.marks.resize(slots, self.stretch.wrapping_sub(1));
        }
        let mut again = self.is_lost;
        for change in &changes[self.unmarked.take().unwrap_or(from)..] {
            let slot = change.slot();
            if slot != clock {
                again |= std::mem::replace(&mut self.marks[slot as usize], self.stretch) == self.stretch;
            }
        }
        again
    }
}
