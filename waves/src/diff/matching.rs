//! Matches the signals of the first file with those of the second.

use std::collections::{HashMap, HashSet, VecDeque};

use super::names::{Entry, Names, canonical};
use super::pattern::Pattern;
use super::scopes::{below, best_tops, tops};
use crate::WaveError;

/// Why two signals were paired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
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
    /// Names of events, which have no value to compare.
    pub(super) not_compared: Vec<String>,
    /// Vectors of each file that were assembled from parts and have a partner: indices in [`Names::groups`].
    pub(super) groups: [Vec<usize>; 2],
}

struct Partners<'a> {
    a: &'a [Entry],
    b: &'a [Entry],
    of_a: Vec<Option<usize>>,
    by: Vec<Option<MatchedBy>>,
    claimed_a: Vec<bool>,
    claimed_b: HashSet<usize>,
}

impl Matched {
    pub(super) fn new(a: &Names, b: &Names, maps: &[(String, String)]) -> Result<Self, WaveError> {
        let mut partners = Partners {
            a: &a.entries,
            b: &b.entries,
            of_a: vec![None; a.entries.len()],
            by: vec![None; a.entries.len()],
            claimed_a: vec![false; a.entries.len()],
            claimed_b: HashSet::new(),
        };
        partners.map(maps)?;
        partners.meet_by_name();
        partners.meet_by_canonical_name();
        Ok(partners.finish(a, b))
    }

    /// Removes the events, which have no comparable value, from the pairs.
    pub(super) fn leave_out(&mut self, other_a: impl Fn(u32) -> bool, other_b: impl Fn(u32) -> bool) {
        let other = |pair: &Pair| pair.a.is_some_and(&other_a) || pair.b.is_some_and(&other_b);
        self.not_compared = self.pairs.iter().filter(|p| other(p)).map(|p| p.name.clone()).collect();
        self.pairs.retain(|p| !other(p));
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
        self.claimed_b.insert(b);
    }

    fn map(&mut self, maps: &[(String, String)]) -> Result<(), WaveError> {
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
        let free_b = (0..self.b.len()).filter(|at| !self.claimed_b.contains(at));
        (free_a.collect(), free_b.collect())
    }

    fn meet_by_name(&mut self) {
        let (free_a, free_b) = self.free();
        let (top_a, top_b) = best_tops(self.a, self.b, &free_a, &free_b);
        let by = match top_a.is_empty() && top_b.is_empty() {
            true => MatchedBy::Name,
            false => MatchedBy::Scopes,
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

    fn finish(mut self, a: &Names, b: &Names) -> Matched {
        // Two vectors that are in parts in both files are compared part by part.
        for (at, partner) in self.of_a.iter_mut().enumerate() {
            if let Some(other) = *partner
                && self.a[at].group.is_some()
                && self.b[other].group.is_some()
            {
                *partner = None;
                self.claimed_b.remove(&other);
            }
        }
        let groups_a: HashSet<usize> = (0..self.a.len())
            .filter(|at| self.of_a[*at].is_some())
            .filter_map(|at| self.a[at].group)
            .collect();
        let groups_b: HashSet<usize> = self.claimed_b.iter().filter_map(|at| self.b[*at].group).collect();
        let (parts_a, parts_b) = (a.parts_of(&groups_a), b.parts_of(&groups_b));
        let listed = |entry: &Entry, parts: &HashSet<u32>, paired: bool| {
            paired || (entry.group.is_none() && !parts.contains(&entry.slot))
        };
        let of_a = self
            .a
            .iter()
            .zip(self.of_a.iter().zip(&self.by))
            .filter(|(entry, (partner, _))| listed(entry, &parts_a, partner.is_some()));
        let of_a = of_a.map(|(entry, (partner, by))| Pair {
            by: by.filter(|_| partner.is_some()),
            name: entry.full.clone(),
            a: Some(entry.slot),
            b_name: partner.map(|at| self.b[at].full.clone()),
            b: partner.map(|at| self.b[at].slot),
        });
        let alone = self
            .b
            .iter()
            .enumerate()
            .filter(|(at, entry)| !self.claimed_b.contains(at) && listed(entry, &parts_b, false));
        let of_b = alone.map(|(_, entry)| Pair {
            name: entry.full.clone(),
            b_name: Some(entry.full.clone()),
            by: None,
            a: None,
            b: Some(entry.slot),
        });
        let sorted = |groups: HashSet<usize>| {
            let mut groups: Vec<usize> = groups.into_iter().collect();
            groups.sort_unstable();
            groups
        };
        Matched {
            pairs: of_a.chain(of_b).collect(),
            not_compared: Vec::new(),
            groups: [sorted(groups_a), sorted(groups_b)],
        }
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
            group: None,
        };
        Names {
            entries: paths.iter().enumerate().map(entry).collect(),
            groups: Vec::new(),
            left_out: 0,
        }
    }

    fn partners(a: &[&str], b: &[&str], maps: &[(&str, &str)]) -> Vec<(Option<u32>, Option<u32>)> {
        let maps: Vec<_> = maps.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let matched = Matched::new(&names(a), &names(b), &maps).unwrap();
        matched.pairs.iter().map(|p| (p.a, p.b)).collect()
    }

    #[test]
    fn unit_full_names_come_first() {
        assert_eq!(
            partners(&["t.y", "t.x"], &["t.x", "t.z"], &[]),
            [(Some(0), None), (Some(1), Some(0)), (None, Some(1))]
        );
    }

    #[test]
    fn unit_tops_are_stripped_when_nothing_else_meets() {
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
    fn unit_other_writings_of_one_name_meet_where_there_is_one_candidate() {
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
    fn unit_maps_name_scopes_signals_and_patterns() {
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
    fn unit_maps_that_meet_nothing_are_errors() {
        for (from, to) in [("nothing", "t.x"), ("t.x", "nothing"), ("no_*", "t.*"), ("t.*", "no_*")] {
            let maps = [(from.to_owned(), to.to_owned())];
            assert!(Matched::new(&names(&["t.x"]), &names(&["t.x"]), &maps).is_err());
        }
    }
}
