//! The result of a comparison, as data (the contract's `diff --json`) and as text.

use std::fmt;

use serde::{Serialize, Serializer};

use super::matching::{Matched, Pair};

/// Equal, different, or nothing to compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every compared value was equal, and every signal had a partner or was left out on demand.
    Equal,
    /// At least one was not.
    Different,
    /// Nothing was compared: exit status 2.
    Incomparable,
}

/// A value in a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Shown {
    /// Binary digits, most significant first, `x` and `z` included.
    Bits(String),
    /// A real number; as JSON, which has no other word for it, `"NaN"` where it is none.
    Real(#[serde(serialize_with = "number_or_text")] f64),
    /// There is no value: the signal or the clock edge is missing, or nothing was written yet.
    Missing,
}

fn number_or_text<S: Serializer>(real: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if real.is_finite() {
        serializer.serialize_f64(*real)
    } else {
        serializer.serialize_str(&real.to_string())
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bits(digits) => f.write_str(digits),
            Self::Real(real) => write!(f, "{real}"),
            Self::Missing => f.write_str("(none)"),
        }
    }
}

/// A signal that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Full name in the first file; in the second, if the first does not have it.
    pub signal: String,
    /// Time of the first difference in seconds, by the first file's clock.
    pub time: f64,
    /// The first file's value then.
    pub a: Shown,
    /// The second file's.
    pub b: Shown,
    /// Samples at which they differ.
    pub count: u64,
}

/// The whole result. Serialises to `diff --json`; the rest is for the text.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// The verdict.
    pub result: Verdict,
    /// Signals compared: those that both files have.
    pub signals: u64,
    /// Clock edges, or times of change, at which they were compared.
    pub samples: u64,
    /// One entry per signal that differs, by time.
    pub differences: Vec<Difference>,
    /// Time of the first difference of all.
    pub first_time: Option<f64>,
    /// Signals that only the first file has.
    #[serde(skip)]
    pub only_in_a: Vec<String>,
    /// Signals that only the second file has.
    #[serde(skip)]
    pub only_in_b: Vec<String>,
    /// Text and events: not compared.
    #[serde(skip)]
    pub not_compared: Vec<String>,
    /// Tolerances in use: signal and LSB.
    #[serde(skip)]
    pub tolerances: Vec<(String, f64)>,
    /// What a reader should know: the clock, edges at different times, why nothing could be compared.
    #[serde(skip)]
    pub notes: Vec<String>,
}

impl Comparison {
    pub(super) fn new(matched: &Matched, clock_note: String, tolerances: &[Option<f64>]) -> Self {
        let alone = |lacks: fn(&Pair) -> bool| {
            let alone = matched.pairs.iter().filter(|pair| lacks(pair));
            alone.map(|pair| pair.name.clone()).collect::<Vec<_>>()
        };
        let used = matched.pairs.iter().zip(tolerances);
        let used = used.filter_map(|(pair, lsb)| Some((pair.name.clone(), (*lsb)?)));
        Self {
            result: Verdict::Incomparable,
            signals: 0,
            samples: 0,
            differences: Vec::new(),
            first_time: None,
            only_in_a: alone(|pair| pair.b.is_none()),
            only_in_b: alone(|pair| pair.a.is_none()),
            not_compared: matched.not_compared.clone(),
            tolerances: used.collect(),
            notes: vec![clock_note],
        }
    }

    pub(super) fn incomparable(&mut self, why: &str) {
        self.result = Verdict::Incomparable;
        self.notes.push(why.to_owned());
    }

    pub(super) fn conclude(&mut self, samples: u64, differences: Vec<Difference>) {
        self.samples = samples;
        if samples == 0 {
            self.incomparable("there is no sample at which both files have values");
            return;
        }
        self.result = if differences.is_empty() {
            Verdict::Equal
        } else {
            Verdict::Different
        };
        self.first_time = differences.iter().map(|d| d.time).reduce(f64::min);
        self.differences = differences;
    }
}

/// Lines of one kind that the text shows before it counts the rest.
const SHOWN_LINES: usize = 20;

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match self.result {
            Verdict::Equal => "equal",
            Verdict::Different => "different",
            Verdict::Incomparable => "incomparable",
        };
        write!(f, "{verdict}: {} signals at {} samples", self.signals, self.samples)?;
        for note in &self.notes {
            write!(f, "\n  {note}")?;
        }
        let width = self
            .differences
            .iter()
            .map(|d| d.signal.len())
            .max()
            .unwrap_or(0)
            .min(60);
        list(f, &self.differences, |d| {
            format!(
                "{:width$}  first at {:e} s: {} | {}  ({} samples)",
                d.signal, d.time, d.a, d.b, d.count
            )
        })?;
        list(f, &self.only_in_a, |name| format!("only in the first file: {name}"))?;
        list(f, &self.only_in_b, |name| format!("only in the second file: {name}"))?;
        list(f, &self.not_compared, |name| format!("text, not compared: {name}"))?;
        list(f, &self.tolerances, |(name, lsb)| {
            format!("tolerance {lsb} LSB: {name}")
        })
    }
}

fn list<T>(f: &mut fmt::Formatter<'_>, items: &[T], line: impl Fn(&T) -> String) -> fmt::Result {
    for item in items.iter().take(SHOWN_LINES) {
        write!(f, "\n  {}", line(item))?;
    }
    match items.len().saturating_sub(SHOWN_LINES) {
        0 => Ok(()),
        more => write!(f, "\n  … and {more} more"),
    }
}
