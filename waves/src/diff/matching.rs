//! Matches the signals of the first file with those of the second.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet, VecDeque};

use super::names::{Entry, Names, canonical};
use super::parts::{Bits, Common, Derived, Meeting, Shape, meeting};
use super::pattern::Pattern;
use super::scopes::{below, best_tops, tops};
use crate::WaveError;
use crate::reader::Range;

/// Why two signals were paired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum MatchedBy {
    /// A `--map` names both.
    Map,
    /// They have the same full name.
    Name,
    /// They have the same name below the scopes that all signals of their file share.
    Scopes,
    /// Their names differ only in how they are written.
    Writing,
}

/// Two signals that belong together, or one without a partner. They are never both `None`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pair {
    /// Full name in the first file, or else in the second.
    pub(super) name: String,
    /// Full name in the second file.
    pub(super) b_name: Option<String>,
    pub(super) a: Option<u32>,
    pub(super) b: Option<u32>,
    pub(super) by: Option<MatchedBy>,
}

impl Pair {
    /// Returns the names in both files, if both have the signal.
    pub(super) fn names(&self) -> Option<(String, String)> {
        self.a.and(self.b)?;
        Some((self.name.clone(), self.b_name.clone()?))
    }
}

pub(super) struct Matched {
    pub(super) pairs: Vec<Pair>,
    /// Names of signals that both files have and that cannot be compared.
    pub(super) not_compared: Vec<String>,
    /// Slots of each file that are made of bits of others, after those of the file.
    pub(super) derived: [Vec<Derived>; 2],
    /// Vectors whose bit order is assumed, because neither file declares it.
    pub(super) assumed: Vec<String>,
    /// Vectors that both files declare with other indices, or the other way round: first file, second file.
    pub(super) ranges: Vec<(String, [Range; 2])>,
}

struct Partners<'a> {
    a: &'a [Entry],
    b: &'a [Entry],
    of_a: Vec<Option<usize>>,
    by: Vec<Option<MatchedBy>>,
    claimed_a: Vec<bool>,
    claimed_b: Vec<bool>,
}

impl Matched {
    /// Matches the names of two files that have so many slots.
    pub(super) fn new(a: &Names, b: &Names, maps: &[(String, String)], slots: [usize; 2]) -> Result<Self, WaveError> {
        let mut partners = Partners {
            a: &a.entries,
            b: &b.entries,
            of_a: vec![None; a.entries.len()],
            by: vec![None; a.entries.len()],
            claimed_a: vec![false; a.entries.len()],
            claimed_b: vec![false; b.entries.len()],
        };
        partners.map(maps)?;
        partners.meet_by_name();
        partners.meet_by_canonical_name();
        Ok(partners.finish(slots.map(|count| count as u32)))
    }

    /// Removes pairs that cannot be compared.
    pub(super) fn leave_out(&mut self, is_left_out: impl Fn(&Pair) -> bool) {
        let pairs = std::mem::take(&mut self.pairs).into_iter();
        let (left_out, kept): (Vec<Pair>, Vec<Pair>) = pairs.partition(is_left_out);
        self.not_compared = left_out.into_iter().map(|pair| pair.name).collect();
        self.pairs = kept;
    }

    /// Returns the pairs that `name` means: those that the pattern fits, else the one with this full name, else all
    /// whose name ends with it.
    pub(super) fn meant(&self, name: &str) -> Result<Vec<usize>, WaveError> {
        let pattern = Pattern::new(name)?;
        let full = !pattern.has_wildcards() && self.pairs.iter().any(|pair| pair.name == name);
        let fits = |pair: &Pair| {
            if full {
                pair.name == name
            } else {
                pattern.fits(&pair.name)
            }
        };
        let meant = self.pairs.iter().enumerate().filter(|(_, pair)| fits(pair));
        Ok(meant.map(|(at, _)| at).collect())
    }
}

impl Partners<'_> {
    fn claim(&mut self, a: usize, b: usize, by: MatchedBy) {
        self.of_a[a] = Some(b);
        self.by[a] = Some(by);
        self.claimed_b[b] = true;
    }

    fn map(&mut self, maps: &[(String, String)]) -> Result<(), WaveError> {
        if maps.is_empty() {
            return Ok(());
        }
        let (tops_a, tops_b) = (tops(self.a), tops(self.b));
        let by_name: HashMap<&str, usize> = (0..).zip(self.b).map(|(at, entry)| (entry.path.as_str(), at)).collect();
        let mut maps: Vec<&(String, String)> = maps.iter().collect();
        // The longer name is more specific: a signal's own map comes before that of its scope, and both before those
        // with wildcards.
        maps.sort_by_key(|(from, _)| (from.contains(['*', '?']), std::cmp::Reverse(from.len())));
        for (from, to) in maps {
            let (from_pattern, to_pattern) = (Pattern::new(from)?, Pattern::new(to)?);
            let target_of = |name: &str| {
                if from_pattern.has_wildcards() {
                    Some(to_pattern.filled(&from_pattern.whole(name)?))
                } else {
                    Some(format!("{to}{}", below(name, from)?))
                }
            };
            let (mut known, mut meets) = (false, false);
            for (at, entry) in self.a.iter().enumerate() {
                let stripped = tops_a.iter().filter_map(|top| entry.path.strip_prefix(top.as_str()));
                let Some(target) = stripped.into_iter().find_map(target_of) else {
                    continue;
                };
                known = true;
                if std::mem::replace(&mut self.claimed_a[at], true) {
                    continue;
                }
                let target = tops_b
                    .iter()
                    .find_map(|top| by_name.get(format!("{top}{target}").as_str()));
                if let Some(target) = target {
                    meets = true;
                    self.claim(at, *target, MatchedBy::Map);
                }
            }
            if !known || !meets {
                let (name, file) = if known { (to, "second") } else { (from, "first") };
                return Err(WaveError::Option(format!(
                    "--map {from}={to}: the {file} file has no scope or signal `{name}` that fits"
                )));
            }
        }
        Ok(())
    }

    fn free(&self) -> (Vec<usize>, Vec<usize>) {
        let free_a = (0..self.a.len()).filter(|at| !self.claimed_a[*at] && self.of_a[*at].is_none());
        let free_b = (0..self.b.len()).filter(|at| !self.claimed_b[*at]);
        (free_a.collect(), free_b.collect())
    }

    fn meet_by_name(&mut self) {
        let (free_a, free_b) = self.free();
        // Two runs of one design: each name meets its equal, in the order of the files.
        let mut both = free_a.iter().zip(&free_b);
        if free_a.len() == free_b.len() && both.all(|(a, b)| self.a[*a].path == self.b[*b].path) {
            for (a, b) in free_a.into_iter().zip(free_b) {
                self.claim(a, b, MatchedBy::Name);
            }
            return;
        }
        let (top_a, top_b) = best_tops(self.a, self.b, &free_a, &free_b);
        let by = if top_a.is_empty() && top_b.is_empty() {
            MatchedBy::Name
        } else {
            MatchedBy::Scopes
        };
        let mut targets: HashMap<&str, VecDeque<usize>> = HashMap::new();
        for at in free_b {
            if let Some(name) = self.b[at].path.strip_prefix(top_b.as_str()) {
                targets.entry(name).or_default().push_back(at);
            }
        }
        for at in free_a {
            let name = self.a[at].path.strip_prefix(top_a.as_str());
            let Some(targets) = name.and_then(|name| targets.get_mut(name)) else {
                continue;
            };
            // A name that is declared several times meets its partners in the order of the files.
            let target = match targets.len() {
                1 => targets.front().copied(),
                _ => targets.pop_front(),
            };
            if let Some(target) = target {
                self.claim(at, target, by);
            }
        }
    }

    /// Matches names that are written differently on each side if each has one candidate. Of the scopes that all
    /// signals share, as many are stripped as give the most pairs.
    fn meet_by_canonical_name(&mut self) {
        let (free_a, free_b) = self.free();
        if free_a.is_empty() || free_b.is_empty() {
            return;
        }
        let (tops_a, tops_b) = (tops(self.a), tops(self.b));
        let unique = |entries: &[Entry], free: &[usize], top: &str| {
            let mut found: HashMap<String, Option<usize>> = HashMap::new();
            for at in free {
                let Some(name) = entries[*at].path.strip_prefix(top) else {
                    continue;
                };
                let place = found.entry(canonical(name));
                place.and_modify(|place| *place = None).or_insert(Some(*at));
            }
            found
        };
        let of_b: Vec<_> = tops_b.iter().map(|top| unique(self.b, &free_b, top)).collect();
        let mut best: Vec<(usize, usize)> = Vec::new();
        for top in &tops_a {
            let of_a = unique(self.a, &free_a, top);
            for of_b in &of_b {
                let mut met: Vec<(usize, usize)> = of_a
                    .iter()
                    .filter_map(|(name, at)| Some(((*at)?, (*of_b.get(name)?)?)))
                    .collect();
                met.sort_unstable();
                if met.len() > best.len() {
                    best = met;
                }
            }
        }
        for (a, b) in best {
            self.claim(a, b, MatchedBy::Writing);
        }
    }

    fn finish(self, slots: [u32; 2]) -> Matched {
        let mut matched = Matched {
            pairs: Vec::new(),
            not_compared: Vec::new(),
            derived: Default::default(),
            assumed: Vec::new(),
            ranges: Vec::new(),
        };
        let mut next = slots;
        let widths: [OnceCell<HashMap<u32, u32>>; 2] = Default::default();
        let width = |side: usize, slot: u32, entries: &[Entry]| {
            let widths = widths[side].get_or_init(|| {
                let wholes = entries.iter().filter_map(|entry| match entry.shape {
                    Some(Shape::Whole { slot, width, .. }) => Some((slot, width)),
                    _ => None,
                });
                wholes.collect()
            });
            widths.get(&slot).copied().unwrap_or(0)
        };
        // Parts that are compared as bits of their vector, and bits that only one file has.
        let mut parts: [HashSet<u32>; 2] = Default::default();
        let mut alone: [Vec<(String, u32)>; 2] = Default::default();
        let mut unpaired: HashSet<usize> = HashSet::new();
        let mut by_bits: Vec<Pair> = Vec::new();
        let mut vectors_by_bits: HashSet<[&str; 2]> = HashSet::new();
        let entries = [self.a, self.b];
        for (at, partner) in self.of_a.iter().enumerate() {
            let Some(other) = *partner else { continue };
            let met = [&self.a[at], &self.b[other]];
            let [Some(shape_a), Some(shape_b)] = met.map(|entry| entry.shape.as_ref()) else {
                if met.iter().any(|entry| entry.is_in_parts()) {
                    unpaired.insert(at);
                }
                continue;
            };
            match meeting(shape_a, shape_b) {
                Meeting::AsDeclared => {
                    if let [Some(a), Some(b)] = [shape_a, shape_b].map(Shape::range)
                        && a != b
                        && a.left.abs_diff(a.right) == b.left.abs_diff(b.right)
                    {
                        matched.ranges.push((met[0].full.clone(), [a, b]));
                    }
                }
                Meeting::PartByPart => {
                    unpaired.insert(at);
                }
                Meeting::Apart => {
                    unpaired.insert(at);
                }
                Meeting::ByIndex {
                    whole,
                    common,
                    only,
                    assumed,
                } => {
                    unpaired.insert(at);
                    vectors_by_bits.insert(met.map(|entry| entry.full.as_str()));
                    if assumed {
                        matched.assumed.push(met[0].full.clone());
                    }
                    for (side, shape) in [shape_a, shape_b].into_iter().enumerate() {
                        match shape {
                            Shape::Parts(of) => parts[side].extend(of.iter().map(|(slot, _)| *slot)),
                            Shape::Whole { slot, .. } => {
                                parts[side].insert(*slot);
                            }
                        }
                    }
                    let mut slot_of = |side: usize, bits: &Bits| {
                        bits.slot(|slot| width(side, slot, entries[side])).unwrap_or_else(|| {
                            matched.derived[side].push(Derived {
                                slot: next[side],
                                width: bits.width(),
                                runs: bits.runs(),
                            });
                            next[side] += 1;
                            next[side] - 1
                        })
                    };
                    for Common { of } in &common {
                        let suffix = if whole { String::new() } else { of[0].suffix() };
                        by_bits.push(Pair {
                            by: self.by[at],
                            name: format!("{}{suffix}", met[0].full),
                            a: Some(slot_of(0, &of[0])),
                            b_name: Some(format!("{}{suffix}", met[1].full)),
                            b: Some(slot_of(1, &of[1])),
                        });
                    }
                    for (side, only) in only.iter().enumerate() {
                        for bits in only {
                            let name = format!("{}{}", met[side].full, bits.suffix());
                            alone[side].push((name, slot_of(side, bits)));
                        }
                    }
                }
            }
        }
        // A part that both files have alike is compared once: with its vector, unless it is all that is compared there.
        let slots_by_bits: HashSet<[Option<u32>; 2]> = by_bits.iter().map(|pair| [pair.a, pair.b]).collect();
        let is_in_vector = |met: [&Entry; 2]| {
            let [Some(of_a), Some(of_b)] = met.map(|entry| entry.part_of.as_deref()) else {
                return false;
            };
            let [a, b] = met.map(|entry| entry.shape.as_ref().and_then(Shape::range));
            a == b
                && vectors_by_bits.contains(&[of_a, of_b])
                && !slots_by_bits.contains(&met.map(|entry| Some(entry.slot)))
        };
        let in_vector = self.of_a.iter().enumerate().filter_map(|(at, other)| {
            let met = [&self.a[at], &self.b[(*other)?]];
            is_in_vector(met).then_some(at)
        });
        unpaired.extend(in_vector);
        let mut met_b: HashSet<usize> = HashSet::new();
        for (at, entry) in self.a.iter().enumerate() {
            let partner = self.of_a[at].filter(|_| !unpaired.contains(&at));
            if let Some(other) = partner {
                met_b.insert(other);
                matched.pairs.push(Pair {
                    by: self.by[at],
                    name: entry.full.clone(),
                    a: Some(entry.slot),
                    b_name: Some(self.b[other].full.clone()),
                    b: Some(self.b[other].slot),
                });
            } else if !entry.is_in_parts() && !parts[0].contains(&entry.slot) {
                matched.pairs.push(Pair {
                    by: None,
                    name: entry.full.clone(),
                    a: Some(entry.slot),
                    b_name: None,
                    b: None,
                });
            }
        }
        let known: HashSet<[Option<u32>; 2]> = matched.pairs.iter().map(|pair| [pair.a, pair.b]).collect();
        by_bits.retain(|pair| !known.contains(&[pair.a, pair.b]));
        matched.pairs.append(&mut by_bits);
        let [alone_a, alone_b] = alone;
        matched.pairs.extend(alone_a.into_iter().map(|(name, slot)| Pair {
            by: None,
            name,
            a: Some(slot),
            b_name: None,
            b: None,
        }));
        let of_b = self
            .b
            .iter()
            .enumerate()
            .filter(|(at, entry)| !met_b.contains(at) && !entry.is_in_parts() && !parts[1].contains(&entry.slot));
        let of_b = of_b.map(|(_, entry)| (entry.full.clone(), entry.slot));
        matched.pairs.extend(of_b.chain(alone_b).map(|(name, slot)| Pair {
            b_name: Some(name.clone()),
            name,
            by: None,
            a: None,
            b: Some(slot),
        }));
        matched
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(paths: &[&str]) -> Names {
        let entry = |(slot, path): (usize, &&str)| Entry {
            path: (*path).to_owned(),
            full: (*path).to_owned(),
            slot: slot as u32,
            shape: None,
            part_of: None,
        };
        Names {
            entries: paths.iter().enumerate().map(entry).collect(),
            left_out: 0,
        }
    }

    fn partners(a: &[&str], b: &[&str], maps: &[(&str, &str)]) -> Vec<(Option<u32>, Option<u32>)> {
        let maps: Vec<_> = maps.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let matched = Matched::new(&names(a), &names(b), &maps, [a.len(), b.len()]).unwrap();
        matched.pairs.iter().map(|p| (p.a, p.b)).collect()
    }

    #[test]
    fn full_names_come_first() {
        assert_eq!(
            partners(&["t.y", "t.x"], &["t.x", "t.z"], &[]),
            [(Some(0), None), (Some(1), Some(0)), (None, Some(1))]
        );
    }

    #[test]
    fn top_scopes_are_stripped_when_no_full_name_matches() {
        assert_eq!(
            partners(&["model.x.y", "model.clk"], &["TOP.rtl.x.y", "TOP.rtl.clk"], &[]),
            [(Some(0), Some(0)), (Some(1), Some(1))]
        );
        assert_eq!(
            partners(&["tb.clk", "tb.dut.y"], &["dut.y", "dut.q"], &[]),
            [(Some(0), None), (Some(1), Some(0)), (None, Some(1))]
        );
    }

    #[test]
    fn canonical_names_match_a_single_candidate() {
        assert_eq!(
            partners(&["t.a$step", "t.clk"], &["TOP.t.a__step", "TOP.t.clk"], &[]),
            [(Some(0), Some(0)), (Some(1), Some(1))]
        );
        assert_eq!(
            partners(&["t.Y", "t.x"], &["t.y", "t.x", "t.\\Y "], &[]),
            [(Some(0), None), (Some(1), Some(1)), (None, Some(0)), (None, Some(2))]
        );
    }

    #[test]
    fn maps_name_scopes_signals_and_patterns() {
        assert_eq!(
            partners(
                &["t.a.y", "t.b.y"],
                &["t.b.y", "t.a.z"],
                &[("t.a", "t.b"), ("t.b.y", "t.a.z")]
            ),
            [(Some(0), Some(0)), (Some(1), Some(1))]
        );
        assert_eq!(partners(&["t.y"], &["u.v.z"], &[("y", "z")]), [(Some(0), Some(0))]);
        assert_eq!(
            partners(
                &["t.x_reg", "t.y_reg", "t.z"],
                &["u.q_y", "u.q_x", "u.z"],
                &[("*_reg", "q_*")]
            ),
            [(Some(0), Some(1)), (Some(1), Some(0)), (Some(2), Some(2))]
        );
    }

    #[test]
    fn maps_that_match_nothing_are_errors() {
        for (from, to) in [("nothing", "t.x"), ("t.x", "nothing"), ("no_*", "t.*"), ("t.*", "no_*")] {
            let maps = [(from.to_owned(), to.to_owned())];
            assert!(Matched::new(&names(&["t.x"]), &names(&["t.x"]), &maps, [1; 2]).is_err());
        }
    }
}
