//! Collects the values around the first divergence while the comparison continues.

use super::result::{Context, ContextRow, seconds};
use super::rule::View;
use super::value::Shown;

/// Number of signals shown around the first divergence, and of samples after it.
const CONTEXT_SIGNALS: usize = 8;
const CONTEXT_SAMPLES: usize = 3;

/// The context of the first divergence, until it is complete.
pub(super) struct Gathering {
    pub(super) context: Context,
    pairs: Vec<usize>,
    missing: usize,
}

impl Gathering {
    /// Starts the collection for these pairs at a sample; `of` returns the name and the view of a pair.
    pub(super) fn new(sample: u64, diverged: &[u32], of: impl Fn(usize) -> (String, View)) -> Self {
        let pairs: Vec<usize> = diverged.iter().map(|at| *at as usize).take(CONTEXT_SIGNALS).collect();
        let rows = pairs.iter().map(|at| {
            let (signal, view) = of(*at);
            ContextRow {
                signal,
                a: Vec::new(),
                b: Vec::new(),
                view,
            }
        });
        let context = Context {
            sample,
            others: diverged.len() - pairs.len(),
            times: Vec::new(),
            rows: rows.collect(),
        };
        Self {
            context,
            pairs,
            missing: 1 + CONTEXT_SAMPLES,
        }
    }

    /// Whether samples after the divergence are still missing.
    pub(super) fn is_missing_some(&self) -> bool {
        self.missing > 0
    }

    /// Adds a sample; `shown` returns the values of a pair.
    pub(super) fn add(&mut self, time_fs: u128, shown: impl Fn(usize) -> (Shown, Shown)) {
        self.context.times.push(seconds(time_fs));
        for (row, at) in self.context.rows.iter_mut().zip(&self.pairs) {
            let (a, b) = shown(*at);
            row.a.push(a);
            row.b.push(b);
        }
    }

    /// Adds the diverging sample, or one after it, as long as some are missing.
    pub(super) fn add_behind(&mut self, time_fs: u128, shown: impl Fn(usize) -> (Shown, Shown)) {
        if self.missing > 0 {
            self.missing -= 1;
            self.add(time_fs, shown);
        }
    }
}
