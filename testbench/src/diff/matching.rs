//! Which signal of the first file belongs to which of the second.

use std::collections::{BTreeMap, HashMap, HashSet};

use crate::Error;
use crate::reader::Named;

/// Scopes that may be stripped from each file when full names do not meet.
const STRIPPED_SCOPES: usize = 4;

/// Two signals that belong together, or one without a partner. Never both `None`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pair {
    /// Full name in the first file, else in the second.
    pub(super) name: String,
    pub(super) a: Option<u32>,
    pub(super) b: Option<u32>,
}

pub(super) struct Matched {
    pub(super) pairs: Vec<Pair>,
    /// Names of text and events, which have no value to compare.
    pub(super) not_compared: Vec<String>,
}

pub(super) struct FoundClock {
    /// Slots of the clock.
    pub(super) pair: Option<(u32, u32)>,
    /// How it was found, or why not.
    pub(super) note: String,
}

impl Matched {
    pub(super) fn new(a: &[Named], b: &[Named], maps: &[(String, String)]) -> Result<Self, Error> {
        let (tops_a, tops_b) = (tops(a), tops(b));
        let by_name: HashMap<&str, usize> = b.iter().enumerate().map(|(at, n)| (n.path.as_str(), at)).collect();
        let mut partners: Vec<Option<usize>> = vec![None; a.len()];
        let mut claimed_a = vec![false; a.len()];
        let mut claimed_b = HashSet::new();

        let mut maps: Vec<&(String, String)> = maps.iter().collect();
        // The longer name is the more special one: a signal's own map comes before that of its scope.
        maps.sort_by_key(|(from, _)| std::cmp::Reverse(from.len()));
        for (from, to) in maps {
            let (mut known, mut meets) = (false, false);
            for (at, named) in a.iter().enumerate() {
                let rest = tops_a
                    .iter()
                    .find_map(|top| below(named.path.strip_prefix(top.as_str())?, from));
                let Some(rest) = rest else { continue };
                known = true;
                if std::mem::replace(&mut claimed_a[at], true) {
                    continue;
                }
                let target = tops_b
                    .iter()
                    .find_map(|top| by_name.get(format!("{top}{to}{rest}").as_str()));
                if let Some(target) = target {
                    meets = true;
                    partners[at] = Some(*target);
                    claimed_b.insert(*target);
                }
            }
            if !known || !meets {
                let (name, file) = if known { (to, "second") } else { (from, "first") };
                return Err(Error::Option(format!(
                    "--map {from}={to}: the {file} file has no scope or signal `{name}` that fits"
                )));
            }
        }

        let free_a: Vec<usize> = (0..a.len()).filter(|at| !claimed_a[*at]).collect();
        let free_b: Vec<usize> = (0..b.len()).filter(|at| !claimed_b.contains(at)).collect();
        let (top_a, top_b) = best_tops(a, b, &free_a, &free_b, &tops_a, &tops_b);
        let stripped = |named: &'_ Named, top: &str| named.path.strip_prefix(top).map(str::to_owned);
        let targets: HashMap<String, usize> = free_b
            .iter()
            .filter_map(|at| Some((stripped(&b[*at], &top_b)?, *at)))
            .collect();
        for at in free_a {
            if let Some(target) = stripped(&a[at], &top_a).and_then(|name| targets.get(&name)) {
                partners[at] = Some(*target);
                claimed_b.insert(*target);
            }
        }

        let of_a = a.iter().zip(&partners).map(|(named, partner)| Pair {
            name: named.path.clone(),
            a: Some(named.slot),
            b: partner.map(|at| b[at].slot),
        });
        let alone = b.iter().enumerate().filter(|(at, _)| !claimed_b.contains(at));
        let of_b = alone.map(|(_, named)| Pair {
            name: named.path.clone(),
            a: None,
            b: Some(named.slot),
        });
        Ok(Self {
            pairs: of_a.chain(of_b).collect(),
            not_compared: Vec::new(),
        })
    }

    /// Moves the signals that have no comparable value out of the pairs.
    pub(super) fn leave_out(&mut self, other_a: impl Fn(u32) -> bool, other_b: impl Fn(u32) -> bool) {
        let other = |pair: &Pair| pair.a.is_some_and(&other_a) || pair.b.is_some_and(&other_b);
        self.not_compared = self.pairs.iter().filter(|p| other(p)).map(|p| p.name.clone()).collect();
        self.pairs.retain(|p| !other(p));
    }

    /// The pairs that `name` means: that of this full name, else all whose name ends with it.
    fn meant<'a>(&'a self, name: &'a str) -> impl Fn(&Pair) -> bool + 'a {
        let full = self.pairs.iter().any(|pair| pair.name == name);
        move |pair| match pair.name.strip_suffix(name) {
            Some("") => true,
            Some(scopes) => !full && scopes.ends_with('.'),
            None => false,
        }
    }

    pub(super) fn clock(&self, name: Option<&str>, fits: impl Fn(&Pair) -> bool) -> Result<FoundClock, Error> {
        let meant = name.map(|name| self.meant(name));
        let candidates = self.pairs.iter().filter(|pair| match &meant {
            Some(meant) => meant(pair),
            None => fits(pair) && ["clk", "clock"].contains(&last_part(&pair.name).to_ascii_lowercase().as_str()),
        });
        let candidates: Vec<&Pair> = candidates.collect();
        // Several names of one signal are one candidate.
        let slots: BTreeMap<(u32, u32), &Pair> = candidates
            .iter()
            .filter(|pair| fits(pair))
            .filter_map(|pair| Some(((pair.a?, pair.b?), *pair)))
            .collect();
        if let (1, Some((slots, pair))) = (slots.len(), slots.first_key_value()) {
            return Ok(FoundClock {
                pair: Some(*slots),
                note: format!("sampled at the rising edges of `{}`", pair.name),
            });
        }
        let Some(name) = name else {
            let found = slots.len();
            return Ok(FoundClock {
                pair: None,
                note: format!("no clock ({found} candidates named clk or clock): compared at every change"),
            });
        };
        let names: Vec<&str> = slots.values().map(|pair| pair.name.as_str()).collect();
        Err(Error::Option(if candidates.is_empty() {
            format!("--clock {name}: the first file has no such signal")
        } else if names.is_empty() {
            format!("--clock {name}: it must be one bit wide in both files, and have a partner in the second")
        } else {
            format!("--clock {name}: that may be {}; give the full name", names.join(" or "))
        }))
    }

    /// The tolerance of each pair. `width` gives the wider of the two vectors, `None` if neither is one.
    pub(super) fn tolerances(
        &self,
        wanted: &[(Option<String>, f64)],
        width: impl Fn(&Pair) -> Option<u32>,
    ) -> Result<Vec<Option<f64>>, Error> {
        let for_all = wanted
            .iter()
            .rev()
            .find(|(signal, _)| signal.is_none())
            .map(|(_, lsb)| *lsb);
        let for_all = |pair| for_all.filter(|_| width(pair).is_none_or(|bits| (2..=128).contains(&bits)));
        let mut tolerances: Vec<Option<f64>> = self.pairs.iter().map(for_all).collect();
        for (signal, lsb) in wanted {
            let Some(signal) = signal else { continue };
            let meant = self.meant(signal);
            let mut found = false;
            for (tolerance, pair) in tolerances.iter_mut().zip(&self.pairs) {
                if !meant(pair) {
                    continue;
                }
                found = true;
                *tolerance = Some(*lsb);
                if let Some(bits @ 129..) = width(pair) {
                    return Err(Error::Option(format!(
                        "--tolerance {signal}={lsb}: {bits} bits are too many for a number; a tolerance needs at most 128"
                    )));
                }
            }
            if !found {
                return Err(Error::Option(format!(
                    "--tolerance {signal}={lsb}: the first file has no signal `{signal}`"
                )));
            }
        }
        Ok(tolerances)
    }
}

/// What follows `scope` in `path`: empty if it is the signal itself.
fn below<'a>(path: &'a str, scope: &str) -> Option<&'a str> {
    let rest = path.strip_prefix(scope)?;
    (rest.is_empty() || rest.starts_with('.')).then_some(rest)
}

fn last_part(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// The scopes that all signals share: "", "top.", "top.inner.", …
fn tops(names: &[Named]) -> Vec<String> {
    let mut tops = vec![String::new()];
    let Some(first) = names.first() else { return tops };
    for (at, _) in first.path.match_indices('.').take(STRIPPED_SCOPES) {
        let top = &first.path[..=at];
        if !names.iter().all(|named| named.path.starts_with(top)) {
            break;
        }
        tops.push(top.to_owned());
    }
    tops
}

/// The fewest scopes to strip that give the most pairs; none if full names meet at all.
fn best_tops(
    a: &[Named],
    b: &[Named],
    free_a: &[usize],
    free_b: &[usize],
    tops_a: &[String],
    tops_b: &[String],
) -> (String, String) {
    let mut choices: Vec<(usize, usize)> = (0..tops_a.len())
        .flat_map(|i| (0..tops_b.len()).map(move |j| (i, j)))
        .collect();
    choices.sort_by_key(|(i, j)| i + j);
    let mut best = (0, 0, 0);
    for (i, j) in choices {
        let names: HashSet<&str> = free_b
            .iter()
            .filter_map(|at| b[*at].path.strip_prefix(tops_b[j].as_str()))
            .collect();
        let ours = free_a
            .iter()
            .filter_map(|at| a[*at].path.strip_prefix(tops_a[i].as_str()));
        let met = ours.filter(|name| names.contains(name)).count();
        if met > best.0 {
            best = (met, i, j);
        }
        if (i, j) == (0, 0) && met > 0 {
            break;
        }
    }
    (tops_a[best.1].clone(), tops_b[best.2].clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(paths: &[&str]) -> Vec<Named> {
        let named = |(slot, path): (usize, &&str)| Named {
            path: (*path).to_owned(),
            slot: slot as u32,
        };
        paths.iter().enumerate().map(named).collect()
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
    fn unit_maps_name_scopes_and_signals() {
        assert_eq!(
            partners(
                &["t.a.y", "t.b.y"],
                &["t.b.y", "t.a.z"],
                &[("t.a", "t.b"), ("t.b.y", "t.a.z")]
            ),
            [(Some(0), Some(0)), (Some(1), Some(1))]
        );
        assert_eq!(partners(&["t.y"], &["u.v.z"], &[("y", "z")]), [(Some(0), Some(0))]);
    }

    #[test]
    fn unit_maps_that_meet_nothing_are_errors() {
        for (from, to) in [("nothing", "t.x"), ("t.x", "nothing")] {
            let maps = [(from.to_owned(), to.to_owned())];
            assert!(Matched::new(&names(&["t.x"]), &names(&["t.x"]), &maps).is_err());
        }
    }
}
