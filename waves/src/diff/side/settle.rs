//! Values that take effect when they have lasted long enough: shorter ones are glitches.

use std::collections::VecDeque;

use super::{Following, Side};
use crate::WaveError;
use crate::diff::touched::Touched;
use crate::reader::Values;

/// Largest number of changes that may be delayed until it is known whether they are glitches.
const HELD_CHANGES: usize = 1 << 20;

/// Delays values until they have lasted long enough.
#[derive(Debug)]
pub(super) struct Settle {
    pub(super) width_fs: u128,
    /// The next value and its beginning, by slot.
    pub(super) next: Values,
    pub(super) since: Vec<Option<u128>>,
    pub(super) queue: VecDeque<(u128, u32)>,
}

impl Side {
    pub(super) fn hold_back(&mut self, time_fs: u128) -> Result<(), WaveError> {
        let Some(settle) = &mut self.settle else { return Ok(()) };
        self.feed.each_change(|slot, words| {
            settle.next.set(slot, words);
            settle.since[slot as usize] = Some(time_fs);
            settle.queue.push_back((time_fs, slot));
        });
        if settle.queue.len() > HELD_CHANGES {
            return Err(WaveError::Option(format!(
                "--glitch: {} changes within one glitch, and at most {HELD_CHANGES} are held back; give a shorter time",
                settle.queue.len()
            )));
        }
        Ok(())
    }

    /// Takes in the values that have lasted long enough.
    pub(super) fn take_in_settled(&mut self, time_fs: u128, touched: &mut Touched) -> bool {
        let Some(settle) = &mut self.settle else { return false };
        let mut happened = false;
        while let Some((since, slot)) = settle.queue.front().copied()
            && since + settle.width_fs <= time_fs
        {
            settle.queue.pop_front();
            // Another value has come since: this one did not last.
            if settle.since[slot as usize] != Some(since) {
                continue;
            }
            happened = true;
            if self.values.set(slot, settle.next.words(slot)) {
                for pair in self.pairs.get(slot) {
                    touched.listed.touch(*pair);
                }
                let following = Following {
                    pairs: &self.pairs,
                    parts: &self.parts,
                    delayed: &self.delayed,
                };
                following.follow(slot, &mut self.values, &mut self.lines, &mut touched.listed);
            }
        }
        happened
    }
}
