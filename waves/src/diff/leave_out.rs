//! Leaves out of FST what need not be read to compare them.

use std::collections::HashSet;

use super::Plan;
use super::options::DiffOptions;
use crate::reader::Wave;

impl Plan {
    /// Leaves out of FST what is not compared. Without a clock, it is read for the times at which it changes.
    pub(super) fn leave_out(&self, waves: &mut [Wave; 2], options: &DiffOptions) {
        if self.clocking.clock.is_none() {
            return;
        }
        for (side, wave) in waves.iter_mut().enumerate() {
            let pairs = self.matched.pairs.iter();
            let wanted = pairs.filter(|pair| options.require_all || pair.a.is_some() && pair.b.is_some());
            let derived = self.matched.derived[side].iter();
            let sources = derived.flat_map(|derived| derived.runs.iter().map(|run| run.source));
            let mut is_wanted = vec![false; wave.declarations.kinds.len()];
            for slot in wanted.filter_map(|pair| [pair.a, pair.b][side]).chain(sources) {
                is_wanted[slot as usize] = true;
            }
            wave.leave_out(|slot| is_wanted[slot as usize]);
        }
    }

    /// Leaves out what is written with the same bytes in two FST: it is equal by every rule, at every sample.
    pub(super) fn leave_out_same(&self, [wave_a, wave_b]: &mut [Wave; 2], options: &DiffOptions) {
        // These show values of equal signals, or compare values of other times.
        let by_value = options.first || options.glitch_fs > 0 || self.latencies.iter().any(Option::is_some);
        let units = [&*wave_a, &*wave_b].map(|wave| wave.declarations.unit_fs);
        if by_value || units[0] != units[1] {
            return;
        }
        // By slot: the only partner, if there is one.
        let slots = [&*wave_a, &*wave_b].map(|wave| wave.declarations.kinds.len());
        let mut partners = slots.map(|slots| vec![None; slots]);
        let mut is_seen = slots.map(|slots| vec![false; slots]);
        for pair in &self.matched.pairs {
            for (side, [slot, partner]) in [[pair.a, pair.b], [pair.b, pair.a]].into_iter().enumerate() {
                let Some(slot) = slot else { continue };
                let known = &mut partners[side][slot as usize];
                *known = if std::mem::replace(&mut is_seen[side][slot as usize], true) {
                    known.filter(|known| Some(*known) == partner)
                } else {
                    partner
                };
            }
        }
        let needed: Vec<[u32; 2]> = [self.clocking.clock, self.clocking.reset.map(|(reset, _)| reset)]
            .into_iter()
            .flatten()
            .collect();
        let sources = self.matched.derived.each_ref().map(|derived| {
            let slots = derived.iter().flat_map(|derived| {
                let sources = derived.runs.iter().map(|run| run.source);
                sources.chain([derived.slot])
            });
            slots.collect::<HashSet<u32>>()
        });
        let stands_alone = |pair: &[u32; 2]| {
            let partner = |side: usize| partners[side].get(pair[side] as usize).copied().flatten();
            partner(0) == Some(pair[1])
                && partner(1) == Some(pair[0])
                && !(0..2).any(|side| sources[side].contains(&pair[side]))
        };
        let pairs = (0..).zip(&partners[0]).filter_map(|(a, b)| {
            let pair = [a, (*b)?];
            let is_needed = needed.iter().any(|needed| needed[0] == pair[0] || needed[1] == pair[1]);
            let kinds = [&wave_a.declarations.kinds, &wave_b.declarations.kinds];
            let same_kind = kinds[0].get(pair[0] as usize) == kinds[1].get(pair[1] as usize);
            (stands_alone(&pair) && !is_needed && same_kind).then_some(pair)
        });
        let pairs: Vec<[u32; 2]> = pairs.collect();
        let every_time = self.clocking.clock.is_none();
        // The reset may be the clock, whose values are then needed.
        let is_reset = |clock: &[u32; 2]| self.clocking.reset.is_some_and(|(reset, _)| reset == *clock);
        let clock = self.clocking.clock.filter(|clock| !is_reset(clock));
        let only_edges = clock.is_some_and(|clock| stands_alone(&clock));
        Wave::leave_out_same([wave_a, wave_b], &pairs, &needed, every_time, only_edges);
    }
}
