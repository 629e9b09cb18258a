//! The result of a comparison as text, at most 100 columns wide.

use std::collections::HashSet;
use std::fmt;

use super::human::{value, value_and_digits};
use super::{Comparison, Context, DiffVerdict, Difference, Leniency, UnknownPolicy};
use crate::wording::{counted, time, times};

/// Largest number of lines of one kind that the text shows before it counts the rest.
const SHOWN_LINES: usize = 20;
/// Width of the text in columns.
const COLUMNS: usize = 100;
/// Largest number of characters shown of a name and of a value.
const NAME: usize = 36;
const VALUE: usize = 35;
const CELL: usize = 26;

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let samples = counted(self.samples, "sample");
        match self.result {
            DiffVerdict::Different => write!(f, "different: {}, compared at {samples}", self.differing())?,
            DiffVerdict::Equal => write!(f, "{}: {} at {samples}", self.equal(), counted(self.signals, "signal"))?,
            DiffVerdict::Incomparable => write!(f, "incomparable: {} at {samples}", counted(self.signals, "signal"))?,
        }
        for note in &self.notes {
            write!(f, "\n  {note}")?;
        }
        match self.unknown {
            UnknownPolicy::Strict => {}
            UnknownPolicy::Wildcard => f.write_str("\n  x and z equal anything")?,
            UnknownPolicy::Zero => f.write_str("\n  x and z are taken as 0")?,
        }
        list(f, &self.lenient, leniency)?;
        if let Some(context) = &self.context {
            self.write_context(context, f)?;
        }
        if !self.differences.is_empty() {
            let width = column(
                self.differences
                    .iter()
                    .take(SHOWN_LINES)
                    .map(|d| short(&d.signal, NAME)),
            );
            f.write_str("\ndiffering signals, the earliest first")?;
            list(f, &self.differences, |d| self.difference(d, width))?;
        }
        if !self.state.is_empty() {
            f.write_str("\nall signals there: before, then first | second file")?;
            for state in &self.state {
                let [before, a, b] =
                    [&state.before, &state.a, &state.b].map(|shown| short(&value(shown, state.view), CELL));
                write!(f, "\n  {}  {before}, {a} | {b}", short(&state.signal, NAME))?;
            }
        }
        list(f, &self.only_in_a, |name| format!("only in the first file: {name}"))?;
        list(f, &self.only_in_b, |name| format!("only in the second file: {name}"))?;
        list(f, &self.not_compared, |name| format!("not compared: {name}"))?;
        match &self.matching {
            Some(matching) => write!(f, "\n{matching}"),
            None => Ok(()),
        }
    }
}

impl Comparison {
    /// Returns how many signals differ, in words: `1 of 39 signals differs`.
    pub fn differing(&self) -> String {
        let compared: HashSet<&str> = self.compared.iter().map(|(name, _)| name.as_str()).collect();
        let is_common = |d: &&Difference| compared.contains(d.signal.as_str());
        let common = self.differences.iter().filter(is_common).count() as u64;
        let alone = self.differences.len() as u64 - common;
        let differ = if common == 1 { "differs" } else { "differ" };
        let mut text = format!("{common} of {} {differ}", counted(self.signals, "signal"));
        match alone {
            0 => {}
            1 => text += ", 1 signal is in one file only",
            more => text += &format!(", {more} signals are in one file only"),
        }
        text
    }

    /// Formats a time of the result with the digits of the files' units of time: `40.68904 ms`.
    pub fn time(&self, seconds: f64) -> String {
        time(self.femtoseconds(seconds))
    }

    /// Converts seconds to femtoseconds, rounded to the files' unit of time: a number of seconds has fewer digits
    /// than a long file needs.
    pub(super) fn femtoseconds(&self, seconds: f64) -> u128 {
        let unit_fs = u128::from(self.unit_fs.max(1));
        (seconds * 1e15 / unit_fs as f64).round() as u128 * unit_fs
    }

    fn equal(&self) -> &'static str {
        let is_width = |l: &Leniency| l.widths.is_some() && l.tolerance.is_none() && l.latency.is_none();
        let only_widths = self.only_widths && self.lenient.iter().any(is_width);
        match (self.exact, only_widths) {
            _ if self.is_lenient_by_rule_only() => "equal by the rules below",
            (true, _) if !self.cut.is_empty() => "equal up to where a file was cut off",
            (true, _) => "equal",
            (false, true) => "equal, but for the widths below",
            (false, false) => "equal within the tolerances below",
        }
    }

    /// Whether the options tolerate nothing, and only what the files have made the comparison inexact.
    fn is_lenient_by_rule_only(&self) -> bool {
        !self.exact && self.unknown == UnknownPolicy::Strict && self.lenient.is_empty() && self.only_widths
    }

    fn write_context(&self, context: &Context, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = context.sample.min(1) as usize;
        write!(f, "\nfirst divergence at sample {}", context.sample)?;
        if let Some(time) = context.times.get(before) {
            write!(f, ", {}", self.time(*time))?;
        }
        let mut columns = vec![vec![String::new()]];
        for row in &context.rows {
            columns[0].push(format!("{} a", short(&row.signal, NAME)));
            columns[0].push("b".to_owned());
        }
        let all_fs: Vec<u128> = context.times.iter().map(|time| self.femtoseconds(*time)).collect();
        for (at, time) in times(&all_fs).iter().enumerate() {
            let mark = if at == before { ">" } else { "" };
            let mut cells = vec![format!("{mark}{time}")];
            for row in &context.rows {
                for values in [&row.a, &row.b] {
                    let value = values.get(at).map(|shown| value(shown, row.view));
                    cells.push(short(&value.unwrap_or_default(), CELL));
                }
            }
            columns.push(cells);
        }
        let mut widths: Vec<usize> = columns.iter().map(|cells| column(cells.iter().cloned())).collect();
        // Samples after the divergence that do not fit are left out.
        while 1 + widths.iter().map(|width| width + 1).sum::<usize>() > COLUMNS && widths.len() > before + 2 {
            widths.pop();
        }
        for line in 0..columns[0].len() {
            f.write_str("\n ")?;
            for (cells, width) in columns.iter().zip(&widths) {
                let cell = cells.get(line).map_or("", String::as_str);
                write!(f, " {cell:>width$}")?;
            }
        }
        match context.others {
            0 => Ok(()),
            1 => f.write_str("\n  … and 1 signal more diverges at this sample"),
            more => write!(f, "\n  … and {more} signals more diverge at this sample"),
        }
    }

    /// Returns two lines: since when and how often, and the two values.
    fn difference(&self, d: &Difference, width: usize) -> String {
        let cause = if Some(d.time) == self.first_time {
            ", probable cause"
        } else {
            ""
        };
        let [a, b] = [&d.a, &d.b].map(|shown| {
            let whole = value_and_digits(shown, d.view);
            if whole.chars().count() <= VALUE {
                whole
            } else {
                short(&value(shown, d.view), VALUE)
            }
        });
        let tolerance = d.largest.map_or_else(String::new, |largest| {
            let signal = short(&d.signal, NAME);
            let option = signal
                .strip_prefix('…')
                .map_or_else(|| signal.clone(), |end| format!("*{end}"));
            format!("\n      --tolerance '{option}={largest:e}abs' makes them equal")
        });
        format!(
            "{:width$}  first at {}, {}, {}\n      a {a} | b {b}{cause}{tolerance}",
            short(&d.signal, NAME),
            self.time(d.time),
            counted(d.count, "sample"),
            if d.persistent { "to the end" } else { "transient" },
        )
    }
}

fn leniency(lenient: &Leniency) -> String {
    let mut text = format!("{}: compared as {}", lenient.signal, lenient.view);
    if let Some([a, b]) = lenient.widths {
        let with = if lenient.extends_sign { "its sign" } else { "zeros" };
        text += &format!(
            ", {} in the first file and {b} in the second: the narrower extended with {with}",
            counted(a.into(), "bit")
        );
    }
    if let Some(tolerance) = &lenient.tolerance {
        text += &format!(", tolerance {tolerance}");
    }
    if let Some(latency) = &lenient.latency {
        text += &format!(", later in the second file by {latency}");
    }
    text
}

/// Returns the width of a column that holds these texts.
fn column(texts: impl Iterator<Item = String>) -> usize {
    texts.map(|text| text.chars().count()).max().unwrap_or(0)
}

/// Returns the end of a long text, which is the most specific part of a name or number.
fn short(text: &str, length: usize) -> String {
    let count = text.chars().count();
    if count <= length {
        return text.to_owned();
    }
    let end: String = text.chars().skip(count + 1 - length).collect();
    format!("…{end}")
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
