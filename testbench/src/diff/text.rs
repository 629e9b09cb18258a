//! The result of a comparison as text for people.

use std::fmt;

use super::{Comparison, Context, Difference, Leniency, Shown, UnknownPolicy, Verdict};

/// Lines of one kind that the text shows before it counts the rest.
const SHOWN_LINES: usize = 20;
/// Digits of a value in a column.
const SHOWN_DIGITS: usize = 40;

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bits(digits) => f.write_str(digits),
            Self::Real(real) => write!(f, "{real}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::Missing => f.write_str("(none)"),
        }
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match self.result {
            Verdict::Equal if self.exact => "equal",
            Verdict::Equal => "equal within the tolerances below",
            Verdict::Different => "different",
            Verdict::Incomparable => "incomparable",
        };
        write!(f, "{verdict}: {} signals at {} samples", self.signals, self.samples)?;
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
            write!(f, "\n{context}")?;
        }
        if !self.differences.is_empty() {
            let width = column(self.differences.iter().take(SHOWN_LINES).map(|d| d.signal.as_str()));
            f.write_str("\ndiffering signals, the earliest first")?;
            let earliest = self.first_time;
            list(f, &self.differences, |d| difference(d, width, earliest))?;
        }
        list(f, &self.only_in_a, |name| format!("only in the first file: {name}"))?;
        list(f, &self.only_in_b, |name| format!("only in the second file: {name}"))?;
        list(f, &self.not_compared, |name| format!("event, not compared: {name}"))
    }
}

impl fmt::Display for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = self.sample.min(1) as usize;
        write!(f, "first divergence at sample {}", self.sample)?;
        if let Some(time) = self.times.get(before) {
            write!(f, ", {time:e} s")?;
        }
        let mut columns = vec![vec![String::new()]];
        for row in &self.rows {
            columns[0].push(format!("{} a", short(&row.signal, 60)));
            columns[0].push("b".to_owned());
        }
        for (at, time) in self.times.iter().enumerate() {
            let mark = if at == before { ">" } else { "" };
            let mut cells = vec![format!("{mark}{time:e} s")];
            for row in &self.rows {
                for values in [&row.a, &row.b] {
                    let value = values.get(at).map(Shown::to_string).unwrap_or_default();
                    cells.push(short(&value, SHOWN_DIGITS));
                }
            }
            columns.push(cells);
        }
        let widths: Vec<usize> = columns
            .iter()
            .map(|cells| column(cells.iter().map(String::as_str)))
            .collect();
        for line in 0..columns[0].len() {
            f.write_str("\n ")?;
            for (cells, width) in columns.iter().zip(&widths) {
                let cell = cells.get(line).map_or("", String::as_str);
                write!(f, " {cell:>width$}")?;
            }
        }
        if self.others > 0 {
            write!(f, "\n  … and {} signals more diverge at this sample", self.others)?;
        }
        Ok(())
    }
}

fn leniency(lenient: &Leniency) -> String {
    let mut text = format!("{}: compared as {}", lenient.signal, lenient.view);
    if let Some(tolerance) = &lenient.tolerance {
        text += &format!(", tolerance {tolerance}");
    }
    if let Some(latency) = &lenient.latency {
        text += &format!(", later in the second file by {latency}");
    }
    text
}

fn difference(d: &Difference, width: usize, earliest: Option<f64>) -> String {
    let number = |number: Option<f64>| number.map_or_else(String::new, |number| format!(" ({number})"));
    let cause = if Some(d.time) == earliest {
        ", probable cause"
    } else {
        ""
    };
    format!(
        "{:width$}  first at {:e} s: {}{} | {}{}  ({} samples, {}{cause})",
        d.signal,
        d.time,
        d.a,
        number(d.a_number),
        d.b,
        number(d.b_number),
        d.count,
        if d.persistent { "to the end" } else { "transient" },
    )
}

/// Width of a column that holds these texts, at most 60.
fn column<'a>(texts: impl Iterator<Item = &'a str>) -> usize {
    texts.map(|text| text.chars().count()).max().unwrap_or(0).min(62)
}

/// The end of a long text: of names and of numbers, the end tells more.
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
