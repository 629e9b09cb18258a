//! The result of a comparison as data (the document of `diff --json`).

use std::path::Path;

use serde::Serialize;

use super::explain::MatchReport;
use super::matching::{Matched, Pair};
use super::reading::{Reading, Reread};
use super::rule::{Rule, View};
use super::value::{Shown, UnknownPolicy};
use crate::WaveError;
use crate::wording::counted;

/// Verdict of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum DiffVerdict {
    /// Every compared value of every signal that both files have was equal.
    Equal,
    /// At least one value was not equal.
    Different,
    /// Nothing was compared, or not all that both files have: exit status 2.
    Incomparable,
}

/// A signal that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Difference {
    /// Full name in the first file, or in the second if the first does not have it.
    pub signal: String,
    /// Time of the first difference in seconds, by the first file's clock.
    pub time: f64,
    /// The first file's value at that time.
    pub a: Shown,
    /// The second file's value at that time.
    pub b: Shown,
    /// Number of samples at which they differ.
    pub count: u64,
    /// Whether they still differ at the end; otherwise the difference is transient.
    pub persistent: bool,
    /// `a` as a number, if it is read as one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a_number: Option<f64>,
    /// `b` as a number, if it is read as one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub b_number: Option<f64>,
    /// The largest distance of the two numbers, of which at least one is real: a tolerance of as much makes them equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<f64>,
    /// How the text reads the bits.
    #[serde(skip)]
    pub view: View,
}

/// Values around the first divergence of all.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Context {
    /// Number of the diverging sample, counted from 0.
    pub sample: u64,
    /// Number of signals that diverge there too and are not shown.
    pub others: usize,
    /// Times of the samples in seconds: the last equal one if there is any, the diverging one, and some more.
    pub times: Vec<f64>,
    /// The signals that diverge first.
    pub rows: Vec<ContextRow>,
}

/// A signal's values at the times of a [`Context`].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContextRow {
    /// Full name.
    pub signal: String,
    /// Values in the first file.
    pub a: Vec<Shown>,
    /// Values in the second.
    pub b: Vec<Shown>,
    /// How the text reads the bits.
    #[serde(skip)]
    pub view: View,
}

/// Values of a signal at the first difference and at the previous sample.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalState {
    /// Full name.
    pub signal: String,
    /// Value in both files at the previous sample; missing at the first sample.
    pub before: Shown,
    /// Value in the first file at the difference.
    pub a: Shown,
    /// Value in the second file at the difference.
    pub b: Shown,
    /// Notation of the bits in the text.
    #[serde(skip)]
    pub view: View,
}

/// A file that is compared only up to where it was cut off.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CutFile {
    /// `first` or `second`.
    pub file: &'static str,
    /// The place at which it was cut off.
    pub place: String,
}

/// Changes of value that no sample saw; a value that is written again is none.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unsampled {
    /// Number of changes, in both files together, that others replaced before the next edge, or at the same time.
    pub changes: u64,
    /// Their signals.
    pub signals: Vec<String>,
    /// Whether they lie between edges of the clock; otherwise, each at the time of another.
    pub between_edges: bool,
    /// Number of changes, in both files together, at and after the last edge.
    pub changes_after: u64,
    /// Their signals, and those of them that differ at the end of the files, but did not at the last sample.
    pub signals_after: Vec<String>,
    /// See `signals_after`.
    pub differ_after: Vec<String>,
}

impl Unsampled {
    /// Returns the notes for the reader of the result.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let named = |changes: u64, signals: &[String]| {
            let first = signals.first().map_or("", String::as_str);
            let such = if signals.len() > 1 {
                format!(", such as {first}")
            } else {
                format!(", {first}")
            };
            let signals = counted(signals.len() as u64, "signal");
            let were = if changes == 1 { "was" } else { "were" };
            (format!("{} of {signals}", counted(changes, "change")), were, such)
        };
        if self.changes > 0 {
            let (what, were, such) = named(self.changes, &self.signals);
            notes.push(if self.between_edges {
                format!("{what} between the edges {were} not compared{such}: --raw")
            } else {
                format!("{what} {were} not compared, since others follow at the same time{such}")
            });
        }
        if self.changes_after > 0 {
            let (what, were, such) = named(self.changes_after, &self.signals_after);
            let differ = match self.differ_after.as_slice() {
                [] => String::new(),
                [only] => format!("; 1 signal differs there, {only}"),
                [first, ..] => format!("; {} signals differ there, such as {first}", self.differ_after.len()),
            };
            notes.push(format!(
                "{what} after the last edge {were} not compared{such}{differ}: --raw"
            ));
        }
        notes
    }
}

/// How a signal is compared, if it is not compared bit by bit in equal widths.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Leniency {
    /// Full name.
    pub signal: String,
    /// How its bits are read: `signed`, `uq16` …
    pub view: String,
    /// Its tolerance, such as `0.5 LSB`; `None` for no tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<String>,
    /// Time by which it is later in the second file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency: Option<String>,
    /// Its widths in the first and the second file, if they differ: the narrower value is extended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub widths: Option<[u32; 2]>,
    /// Whether it is extended with its sign, otherwise with zeros.
    #[serde(skip)]
    pub extends_sign: bool,
}

/// The whole result. It serialises to the document of `diff --json`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The verdict.
    pub result: DiffVerdict,
    /// Number of compared signals, which both files have.
    pub signals: u64,
    /// Number of clock edges, or times of change, at which they were compared.
    pub samples: u64,
    /// One entry per signal that differs, by time.
    pub differences: Vec<Difference>,
    /// Time of the first difference of all in seconds.
    pub first_time: Option<f64>,
    /// Whether nothing was tolerated: no tolerance, no latency, equal widths, unknown bits and further states equal only to
    /// themselves, everything recorded in both files.
    pub exact: bool,
    /// Signals that are not compared bit by bit at the same time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lenient: Vec<Leniency>,
    /// What unknown bits are equal to.
    pub unknown: UnknownPolicy,
    /// Values around the first divergence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub context: Option<Context>,
    /// Signals that only the first file has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub only_in_a: Vec<String>,
    /// Signals that only the second file has.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub only_in_b: Vec<String>,
    /// Signals of both files that cannot be compared, such as an event with a value. If there are any, the result is not
    /// `equal`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<String>,
    /// Real numbers that are equal to the 16 digits that a VCD has, but not to the last bit of the FST.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rounded: Vec<String>,
    /// Signals that are equal only as 0, 1, `x` and `z`, while the files have further states (VHDL, EVCD).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub collapsed: Vec<String>,
    /// Changes that no sample saw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unsampled: Option<Unsampled>,
    /// With [`DiffOptions::first`](super::DiffOptions::first): all signals at the first difference.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub state: Vec<SignalState>,
    /// Files that were compared only up to where they were cut off.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cut: Vec<CutFile>,
    /// With [`DiffOptions::explain`](super::DiffOptions::explain): how the signals were matched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matching: Option<MatchReport>,
    /// Names of all signals that were compared, in the first file and in the second.
    #[serde(skip)]
    pub compared: Vec<(String, String)>,
    /// Whether different widths are all that was tolerated.
    #[serde(skip)]
    pub only_widths: bool,
    /// Number of femtoseconds per unit of time of the files, the finer of the two.
    #[serde(skip)]
    pub unit_fs: u64,
    /// How both files are read again.
    #[serde(skip)]
    pub(crate) readings: [Reading; 2],
    /// The clock's names, if there is one.
    #[serde(skip)]
    pub clock: Option<(String, String)>,
    /// Notes for the reader: the clock, edges at different times, why nothing could be compared.
    pub notes: Vec<String>,
}

impl Comparison {
    pub(super) fn new(
        matched: &Matched,
        rules: &[Rule],
        latencies: &[Option<String>],
        widths: &[Option<[u32; 2]>],
    ) -> Self {
        let names = |wanted: fn(&Pair) -> bool| {
            let pairs = matched.pairs.iter().filter(|pair| wanted(pair));
            pairs.map(|pair| pair.name.clone()).collect::<Vec<_>>()
        };
        let rules = matched.pairs.iter().zip(rules).zip(latencies.iter().zip(widths));
        let lenient: Vec<Leniency> = rules
            .filter(|((pair, _), _)| pair.a.is_some() && pair.b.is_some())
            .map(|((pair, rule), (latency, widths))| Leniency {
                signal: pair.name.clone(),
                view: rule.view.to_string(),
                tolerance: rule.tolerance.map(|tolerance| tolerance.to_string()),
                latency: latency.clone(),
                widths: *widths,
                extends_sign: matches!(rule.reading(), View::Signed { .. }),
            })
            .filter(|l| {
                l.view != View::Bits.to_string() || l.tolerance.is_some() || l.latency.is_some() || l.widths.is_some()
            })
            .collect();
        let only_widths = !lenient.iter().any(|l| l.tolerance.is_some() || l.latency.is_some());
        Self {
            result: DiffVerdict::Incomparable,
            signals: 0,
            samples: 0,
            differences: Vec::new(),
            first_time: None,
            exact: only_widths && !lenient.iter().any(|l| l.widths.is_some()),
            only_widths,
            unit_fs: 1,
            lenient,
            unknown: UnknownPolicy::Strict,
            context: None,
            only_in_a: names(|pair| pair.b.is_none()),
            only_in_b: names(|pair| pair.a.is_none()),
            not_compared: matched.not_compared.clone(),
            collapsed: Vec::new(),
            rounded: Vec::new(),
            unsampled: None,
            state: Vec::new(),
            cut: Vec::new(),
            matching: None,
            compared: matched.pairs.iter().filter_map(Pair::names).collect(),
            readings: Default::default(),
            clock: None,
            notes: Vec::new(),
        }
    }

    /// Opens the first file (0) or the second (1) again, to be read as it was compared.
    pub(crate) fn read_again(&self, file: usize, path: &Path) -> Result<Reread, WaveError> {
        let name = ["first", "second"][file];
        let is_cut = self.cut.iter().any(|cut| cut.file == name);
        self.readings[file].open(path, is_cut)
    }

    pub(super) fn incomparable(&mut self, why: &str) {
        self.result = DiffVerdict::Incomparable;
        self.notes.push(why.to_owned());
    }

    /// Says that some signals were not compared, and why; the result is then not `equal`.
    pub(super) fn not_compared_because(&mut self, why: &str) {
        self.exact = false;
        self.notes.push(format!("some signals were not compared: {why}"));
        if self.result == DiffVerdict::Equal {
            self.result = DiffVerdict::Incomparable;
        }
    }

    pub(super) fn conclude(&mut self, samples: u64, differences: Vec<Difference>) {
        self.samples = samples;
        if samples == 0 {
            self.incomparable("there is no sample at which both files have values");
            return;
        }
        self.result = if differences.is_empty() {
            DiffVerdict::Equal
        } else {
            DiffVerdict::Different
        };
        self.first_time = differences.iter().map(|d| d.time).reduce(f64::min);
        self.differences = differences;
    }
}

/// Converts femtoseconds to seconds, correctly rounded.
pub(super) fn seconds(time_fs: u128) -> f64 {
    time_fs as f64 / 1e15
}
