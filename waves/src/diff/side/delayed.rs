//! Values that take effect a number of samples, or a time, later.

use super::Side;
use crate::WaveError;
use crate::diff::touched::Touched;

/// Largest number of words that all delay lines of a file may hold together.
const DELAYED_WORDS: usize = 1 << 21;
impl Side {
    /// Puts the changes since the last call into the delay lines. `now` counts samples, or femtoseconds.
    pub(in crate::diff) fn pend(&mut self, now: u128) -> Result<(), WaveError> {
        if self.lines.is_empty() {
            return Ok(());
        }
        for line in &mut self.lines {
            for place in line.changed.drain(..) {
                line.is_changed[place as usize] = false;
                let (source, shown) = line.slots[place as usize];
                line.queue.push_back((now + line.by, shown));
                line.words.extend(self.values.words(source));
            }
        }
        let held: usize = self.lines.iter().map(|line| line.words.len()).sum();
        if held > DELAYED_WORDS {
            return Err(WaveError::Option(format!(
                "--latency: {held} words of delayed values, and at most {DELAYED_WORDS} are held back; give a shorter \
                 latency, or delay fewer signals"
            )));
        }
        Ok(())
    }

    /// Applies delayed values. Returns whether there were any.
    pub(in crate::diff) fn release(&mut self, now: u128, touched: &mut Touched) -> bool {
        let mut happened = false;
        for line in &mut self.lines {
            while let Some((due, shown)) = line.queue.front().copied()
                && due <= now
            {
                line.queue.pop_front();
                happened = true;
                let count = self.values.words(shown).len();
                let words: Vec<u64> = line.words.drain(..count).collect();
                self.values.set(shown, &words);
                for pair in self.pairs.get(shown) {
                    touched.waiting[*pair as usize] = false;
                    touched.listed.touch(*pair);
                }
            }
        }
        happened
    }
}
