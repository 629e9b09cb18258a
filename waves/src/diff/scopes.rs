//! The scopes that all signals of a file share, which may be named differently in each file.

use std::collections::HashSet;

use super::names::Entry;

/// Largest number of scopes that may be stripped from each file if full names do not match.
const STRIPPED_SCOPES: usize = 4;

/// Returns what follows `scope` in `path`: empty if it is the signal itself.
pub(super) fn below<'a>(path: &'a str, scope: &str) -> Option<&'a str> {
    let rest = path.strip_prefix(scope)?;
    (rest.is_empty() || rest.starts_with('.')).then_some(rest)
}

/// Returns the scopes that all signals share: "", "top.", "top.inner.", …
pub(super) fn tops(entries: &[Entry]) -> Vec<String> {
    let mut tops = vec![String::new()];
    let Some(first) = entries.first() else { return tops };
    for (at, _) in first.path.match_indices('.').take(STRIPPED_SCOPES) {
        let top = &first.path[..=at];
        if !entries.iter().all(|entry| entry.path.starts_with(top)) {
            break;
        }
        tops.push(top.to_owned());
    }
    tops
}

/// Returns the fewest scopes to strip that give the most pairs; none if any full names match.
pub(super) fn best_tops(a: &[Entry], b: &[Entry], free_a: &[usize], free_b: &[usize]) -> (String, String) {
    let (tops_a, tops_b) = (tops(a), tops(b));
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
