//! The table that shapes a sample. In a handover there are two tables, and each increment of the command passes one of them.
//!
//! A handover begins at a sample `n0`: the increments up to it belong to the old table (`A`), later ones to the new
//! table (`B`). With `m = n − n0`, and all increments of the history written out and collected again by sample:
//!
//! ```text
//! position               Σ A_i · x[n − max(d_i, m)] + Σ B_i · x[n − min(d_i, m)] − 2^F · x[n0]
//! velocity, acceleration Σ A_i · x[n − d_i] over d_i ≥ m  +  Σ B_i · x[n − d_i] over d_i < m
//! ```
//!
//! Once `m` exceeds the longest delay of both, `Σ B_i · x[n − d_i]` remains and the handover ends. (For the position
//! it could end one sample earlier, but a velocity at that delay still belongs to the old table.) Weights that fade
//! from one output to the other would keep neither property: the velocity would no longer be the position's
//! derivative.

use posicast_taps::Tap;

/// The tables that shape a sample.
pub(super) struct Tables<'a> {
    /// The active table.
    pub(super) active: &'a [Tap],
    /// In a handover, the table before and `m`, the number of samples since the last one that it shaped alone.
    pub(super) handover: Option<(&'a [Tap], u32)>,
    /// 2^F.
    pub(super) unity: i64,
}

impl Tables<'_> {
    /// Number of products of a pass over `channels`; each takes a clock.
    pub(super) fn products(&self, channels: usize) -> u32 {
        let active = self.active.len() * channels;
        let products = match self.handover {
            None => active,
            // The position channel has one product more, for −2^F · x[n0].
            Some((before, _)) => active + before.len() * channels + 1,
        };
        products as u32
    }

    /// The exact weighted sum of a channel, in units of 2^−F; `sample(d)` is the sample `d` samples back.
    pub(super) fn sum(&self, channel: usize, sample: impl Fn(u32) -> i64) -> i64 {
        let product = |tap: &Tap, delay: u32| i64::from(tap.coefficient) * sample(delay);
        let Some((before, since)) = self.handover else {
            return self.active.iter().map(|tap| product(tap, tap.delay_samples)).sum();
        };
        let below = |tap: &Tap| tap.delay_samples < since;
        if channel == 0 {
            let old = before.iter().map(|tap| product(tap, tap.delay_samples.max(since)));
            let new = self.active.iter().map(|tap| product(tap, tap.delay_samples.min(since)));
            old.sum::<i64>() + new.sum::<i64>() - self.unity * sample(since)
        } else {
            let old = before.iter().filter(|tap| !below(tap));
            let new = self.active.iter().filter(|tap| below(tap));
            old.chain(new).map(|tap| product(tap, tap.delay_samples)).sum()
        }
    }
}
