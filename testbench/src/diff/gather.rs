//! What stands around the first divergence, gathered as the comparison goes on.

use super::engine::{Engine, seconds};
use super::result::{Context, ContextRow};

/// Signals of which the first divergence shows the samples around it, and samples behind it.
const CONTEXT_SIGNALS: usize = 8;
const CONTEXT_SAMPLES: usize = 3;

/// The context of the first divergence, until it is complete.
pub(super) struct Gathering {
    pub(super) context: Context,
    pairs: Vec<usize>,
    missing: usize,
}

impl Engine<'_> {
    /// Notes what stands around the first divergence of all: the last equal sample, itself, and some behind it.
    pub(super) fn gather(&mut self, diverged: &[u32], time_fs: u128) {
        if self.context.is_none() && !diverged.is_empty() {
            let pairs: Vec<usize> = diverged.iter().map(|at| *at as usize).take(CONTEXT_SIGNALS).collect();
            let rows = pairs.iter().map(|at| ContextRow {
                signal: self.states[*at].name.clone(),
                a: Vec::new(),
                b: Vec::new(),
                view: self.states[*at].rule.reading(),
            });
            let mut context = Context {
                sample: self.samples,
                others: diverged.len() - pairs.len(),
                times: Vec::new(),
                rows: rows.collect(),
            };
            if let (Some((before, before_fs)), 1..) = (self.before.take(), self.samples) {
                context.times.push(seconds(before_fs));
                for (row, at) in context.rows.iter_mut().zip(&pairs) {
                    let value = self.hot[*at].a.and(self.hot[*at].b).map(|_| before.get(*at as u32));
                    let (a, b) = self.states[*at].rule.shown(value, value);
                    row.a.push(a);
                    row.b.push(b);
                }
            }
            let missing = 1 + CONTEXT_SAMPLES;
            self.context = Some(Gathering {
                context,
                pairs,
                missing,
            });
        }
        if let Some((_, before_fs)) = &mut self.before {
            *before_fs = time_fs;
        }
        let Some(mut gathering) = self.context.take() else {
            return;
        };
        if gathering.missing > 0 {
            gathering.missing -= 1;
            gathering.context.times.push(seconds(time_fs));
            for (row, at) in gathering.context.rows.iter_mut().zip(&gathering.pairs) {
                let (a, b) = self.values(*at);
                let (a, b) = self.states[*at].rule.shown(a, b);
                row.a.push(a);
                row.b.push(b);
            }
        }
        self.context = Some(gathering);
    }
}
