//! Delays values by a number of samples, or by a time.

use std::collections::VecDeque;

/// Values that take effect later. Times are in the unit in which the caller counts: samples or femtoseconds.
#[derive(Debug)]
pub(super) struct DelayLine {
    pub(super) by: u128,
    /// Slot whose value is delayed, and the slot that shows the delayed value.
    pub(super) slots: Vec<(u32, u32)>,
    /// Indices in `slots` that changed since the last [`super::side::Side::pend`], and for each index whether it is
    /// in the list.
    pub(super) changed: Vec<u32>,
    pub(super) is_changed: Vec<bool>,
    pub(super) queue: VecDeque<(u128, u32)>,
    pub(super) words: VecDeque<u64>,
}

impl DelayLine {
    pub(super) fn new(by: u128) -> Self {
        Self {
            by,
            slots: Vec::new(),
            changed: Vec::new(),
            is_changed: Vec::new(),
            queue: VecDeque::new(),
            words: VecDeque::new(),
        }
    }

    pub(super) fn mark(&mut self, place: u32) {
        if !std::mem::replace(&mut self.is_changed[place as usize], true) {
            self.changed.push(place);
        }
    }
}
