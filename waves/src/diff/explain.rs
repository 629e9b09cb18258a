//! Explains which signals were matched and how, and why the others were not.

use std::collections::HashMap;
use std::fmt;

use serde::Serialize;

use super::matching::{Matched, MatchedBy, Pair};
use super::names::{canonical, last_part};
use crate::wording::counted;

/// Two signals that are compared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MatchedSignal {
    /// Full name in the first file.
    pub a: String,
    /// Full name in the second file.
    pub b: String,
    /// How they were matched.
    pub by: MatchedBy,
}

/// A signal without a partner.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnmatchedSignal {
    /// Full name.
    pub signal: String,
    /// `first` or `second`.
    pub file: &'static str,
    /// Why it was not matched, and what to do.
    pub why: String,
}

/// The result of the matching: `--explain`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MatchReport {
    /// Matched signals, in the order of the first file.
    pub matched: Vec<MatchedSignal>,
    /// Signals without a partner: those of the first file, then those of the second.
    pub unmatched: Vec<UnmatchedSignal>,
    /// Number of names in both files that `--root-a`, `--root-b`, `--only` and `--ignore` leave out.
    pub left_out: usize,
}

impl MatchReport {
    pub(super) fn new(matched: &Matched, left_out: usize) -> Self {
        let pairs = &matched.pairs;
        let met = pairs.iter().filter_map(|pair| {
            let (a, b) = pair.names()?;
            Some(MatchedSignal { a, b, by: pair.by? })
        });
        let of_a: Vec<&Pair> = pairs.iter().filter(|pair| pair.a.is_some()).collect();
        let of_b: Vec<&Pair> = pairs.iter().filter(|pair| pair.b.is_some()).collect();
        let name_in_b = |pair: &Pair| pair.b_name.clone().unwrap_or_default();
        let (in_a, in_b) = (
            by_last_part(&of_a, |pair| pair.name.clone()),
            by_last_part(&of_b, name_in_b),
        );
        let alone_in_a = of_a.iter().filter(|pair| pair.b.is_none());
        let alone_in_b = of_b.iter().filter(|pair| pair.a.is_none());
        let unmatched = alone_in_a
            .map(|pair| alone(&pair.name, "first", &in_b))
            .chain(alone_in_b.map(|pair| alone(&name_in_b(pair), "second", &in_a)));
        Self {
            matched: met.collect(),
            unmatched: unmatched.collect(),
            left_out,
        }
    }
}

/// Full names of the other file, and whether they have a partner, by the common form of their last part.
type Others = HashMap<String, Vec<(String, bool)>>;

fn by_last_part(pairs: &[&Pair], name: impl Fn(&Pair) -> String) -> Others {
    let mut others = Others::new();
    for pair in pairs {
        let name = name(pair);
        let key = canonical(last_part(&name));
        others.entry(key).or_default().push((name, pair.names().is_some()));
    }
    others
}

fn alone(signal: &str, file: &'static str, others: &Others) -> UnmatchedSignal {
    let other = if file == "first" { "second" } else { "first" };
    let found = others.get(&canonical(last_part(signal)));
    let free: Vec<&String> = found
        .into_iter()
        .flatten()
        .filter(|(_, matched)| !matched)
        .map(|(name, _)| name)
        .collect();
    let why = match (found, free.as_slice()) {
        (None, _) => format!("the {other} file has no signal of that name in any scope"),
        (Some(_), [one]) if file == "first" => {
            format!("the {other} file has `{one}`, in another scope: --map {signal}={one} if they belong together")
        }
        (Some(_), [one]) => {
            format!("the {other} file has `{one}`, in another scope: --map {one}={signal} if they belong together")
        }
        (Some(all), []) => format!(
            "the {other} file has {} of that name, in other scopes, which have partners of their own",
            counted(all.len() as u64, "signal")
        ),
        (Some(_), several) => format!(
            "the {other} file has {} of that name without a partner, such as `{}`: choose one with --map",
            counted(several.len() as u64, "signal"),
            several[0]
        ),
    };
    UnmatchedSignal {
        signal: signal.to_owned(),
        file,
        why,
    }
}

impl fmt::Display for MatchReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "matched: {}", counted(self.matched.len() as u64, "signal"))?;
        for signal in &self.matched {
            let by = match signal.by {
                MatchedBy::Map => "by --map",
                MatchedBy::Name => "by the full name",
                MatchedBy::Scopes => "by the name below the scopes that all signals share",
                MatchedBy::Writing => "by the name in another spelling",
            };
            write!(f, "\n  {} = {}, {by}", signal.a, signal.b)?;
        }
        write!(f, "\nnot matched: {}", counted(self.unmatched.len() as u64, "signal"))?;
        for signal in &self.unmatched {
            write!(f, "\n  {} of the {} file: {}", signal.signal, signal.file, signal.why)?;
        }
        match self.left_out {
            0 => Ok(()),
            more => write!(
                f,
                "\nleft out by --only, --ignore or a root: {}",
                counted(more as u64, "name")
            ),
        }
    }
}
