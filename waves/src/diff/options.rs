//! Options of a comparison as data, parsed from text: what to compare, when, and how strictly.

use super::names::is_low_active;
use super::pattern::Pattern;
use super::rule::{Tolerance, View};
use super::value::UnknownPolicy;
use crate::WaveError;
use crate::wording::counted;

/// Edge of the clock that samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SamplingEdge {
    /// The edge from 0 to 1.
    #[default]
    Rising,
    /// The edge from 1 to 0.
    Falling,
}

/// Sample from which on the files are compared.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Reset {
    /// The first sample.
    #[default]
    Ignored,
    /// The release of the only signal that is named like a reset, on each side; the first sample if there is none.
    Found,
    /// The release of this signal, on each side.
    Named {
        /// Name in the first file: the full name, or its end if that is unique.
        name: String,
        /// Active value of the reset.
        active: bool,
    },
}

/// Time by which a signal is later in the second file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Latency {
    /// Time in samples of the clock; negative if it is earlier.
    Samples(i64),
    /// Time in femtoseconds, without a clock; negative if it is earlier.
    Femtoseconds(i128),
}

/// Options of a comparison.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DiffOptions {
    /// Name of the clock in the first file: the full name, or its end if that is unique.
    pub clock: Option<String>,
    /// The edge of the clock at which both files are sampled.
    pub edge: SamplingEdge,
    /// Whether to compare at every change, even if there is a clock.
    pub raw: bool,
    /// Sample from which on to compare.
    pub reset: Reset,
    /// First time of the first file to compare, in femtoseconds.
    pub start_fs: Option<u128>,
    /// Last time of the first file to compare, in femtoseconds.
    pub end_fs: Option<u128>,
    /// Without a clock, differences that last no longer than this are ignored, in femtoseconds.
    pub time_tolerance_fs: u128,
    /// Without a clock, values that last shorter than this are removed from both files before the comparison, in
    /// femtoseconds.
    pub glitch_fs: u128,
    /// Scopes below which to compare; names are then relative to them. `None` means the whole file.
    pub roots: [Option<String>; 2],
    /// Maps `(A, B)`: scope or signal `A` of the first file is `B` of the second. Both have the same number of
    /// wildcards.
    pub maps: Vec<(String, String)>,
    /// Names, scopes or patterns; if there are any, only these are compared.
    pub only: Vec<String>,
    /// Names, scopes or patterns that are not compared.
    pub ignore: Vec<String>,
    /// Tolerances of one signal of the first file, of a pattern, or of all signals. A signal's own tolerance has
    /// priority; of several, the last one counts.
    pub tolerances: Vec<(Option<String>, Tolerance)>,
    /// How the bits of signals are read as numbers.
    pub views: Vec<(String, View)>,
    /// Signals that are later, or earlier, in the second file.
    pub latencies: Vec<(String, Latency)>,
    /// What unknown bits are equal to.
    pub unknown: UnknownPolicy,
    /// Whether a signal that only one file has is a difference, instead of being listed.
    pub require_all: bool,
    /// Whether to stop at the first difference, and note the state of all signals there.
    pub first: bool,
    /// Whether a VCD that ends in the middle of a line is compared up to its last complete time, instead of refused.
    pub allow_truncated: bool,
    /// Whether to note which signals were matched and how, and why the others were not.
    pub explain: bool,
}

impl DiffOptions {
    /// Adds a `--map`.
    ///
    /// # Errors
    /// [`WaveError::Option`] if it is not `A=B`, or if the numbers of wildcards of `A` and `B` differ.
    pub fn add_map(&mut self, text: &str) -> Result<(), WaveError> {
        let pair = text
            .split_once('=')
            .filter(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains('='));
        let Some((a, b)) = pair else {
            return Err(WaveError::Option(format!(
                "--map {text}: write A=B, where A is a scope or signal of the first file and B of the second"
            )));
        };
        let (of_a, of_b) = (Pattern::new(a)?.wildcards(), Pattern::new(b)?.wildcards());
        if of_a != of_b {
            return Err(WaveError::Option(format!(
                "--map {text}: {} on the left and {of_b} on the right; both sides need the same number, because each on the right takes \
                 the text of its partner on the left",
                counted(of_a as u64, "wildcard")
            )));
        }
        self.maps.push((a.to_owned(), b.to_owned()));
        Ok(())
    }

    /// Adds the maps of a file: one `A=B` per line; empty lines and lines that begin with `#` are ignored.
    ///
    /// # Errors
    /// As [`DiffOptions::add_map`], with the line.
    pub fn add_map_file(&mut self, text: &str) -> Result<(), WaveError> {
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.trim();
            if !line.is_empty() && !line.starts_with('#') {
                self.add_map(line)
                    .map_err(|error| WaveError::Option(format!("line {number}: {error}")))?;
            }
        }
        Ok(())
    }

    /// Adds a `--tolerance`.
    ///
    /// # Errors
    /// [`WaveError::Option`] if it is not `AMOUNT` or `SIGNAL=AMOUNT` with a number ≥ 0.
    pub fn add_tolerance(&mut self, text: &str) -> Result<(), WaveError> {
        let (signal, amount) = match text.rsplit_once('=') {
            Some((signal, amount)) => (Some(signal.to_owned()), amount),
            None => (None, text),
        };
        match Tolerance::parse(amount).filter(|_| signal.as_deref() != Some("")) {
            Some(tolerance) => {
                self.tolerances.push((signal, tolerance));
                Ok(())
            }
            None => Err(WaveError::Option(format!(
                "--tolerance {text}: write AMOUNT or SIGNAL=AMOUNT, where the amount is a number that is not negative: \
                 y=0.5 or y=0.5lsb, y=0.01abs in the signal's unit, y=0.1% of the larger value"
            ))),
        }
    }

    /// Adds a `--view`.
    ///
    /// # Errors
    /// [`WaveError::Option`] if it is not `SIGNAL=VIEW`.
    pub fn add_view(&mut self, text: &str) -> Result<(), WaveError> {
        let parsed = text.rsplit_once('=').filter(|(signal, _)| !signal.is_empty());
        match parsed.and_then(|(signal, view)| Some((signal.to_owned(), View::parse(view)?))) {
            Some(view) => {
                self.views.push(view);
                Ok(())
            }
            None => Err(WaveError::Option(format!(
                "--view {text}: write SIGNAL=VIEW with signed, unsigned, or a format with fraction bits: q16 or q15.16 \
                 signed, uq16 or uq16.16 unsigned"
            ))),
        }
    }

    /// Adds a `--latency`.
    ///
    /// # Errors
    /// [`WaveError::Option`] if it is not `SIGNAL=SAMPLES` or `SIGNAL=TIME`.
    pub fn add_latency(&mut self, text: &str) -> Result<(), WaveError> {
        let parsed = text.rsplit_once('=').filter(|(signal, _)| !signal.is_empty());
        let latency = parsed.and_then(|(signal, amount)| {
            let latency = match amount.parse::<i64>() {
                Ok(samples) => Latency::Samples(samples),
                Err(_) => {
                    let (negative, time) = match amount.strip_prefix('-') {
                        Some(time) => (true, time),
                        None => (false, amount),
                    };
                    let time = i128::try_from(time_fs(time)?).ok()?;
                    Latency::Femtoseconds(if negative { -time } else { time })
                }
            };
            Some((signal.to_owned(), latency))
        });
        match latency {
            Some(latency) => {
                self.latencies.push(latency);
                Ok(())
            }
            None => Err(WaveError::Option(format!(
                "--latency {text}: write SIGNAL=SAMPLES, such as y=3, or without clock SIGNAL=TIME, such as y=20ns; \
                 positive where the second file is later"
            ))),
        }
    }

    /// Sets the reset from its text: `none`, `NAME`, `NAME=0` or `NAME=1`, where the number is its value while it is
    /// on.
    ///
    /// # Errors
    /// [`WaveError::Option`] for anything else.
    pub fn set_reset(&mut self, text: &str) -> Result<(), WaveError> {
        self.reset = match text.rsplit_once('=') {
            None if text == "none" => Reset::Ignored,
            None if !text.is_empty() => Reset::Named {
                name: text.to_owned(),
                active: !is_low_active(text),
            },
            Some((name, value @ ("0" | "1"))) if !name.is_empty() => Reset::Named {
                name: name.to_owned(),
                active: value == "1",
            },
            _ => {
                return Err(WaveError::Option(format!(
                    "--reset {text}: write NAME, NAME=0 if it is active low, or none"
                )));
            }
        };
        Ok(())
    }
}

/// Parses a time such as `20ns`, `1.5us` or `3e-6s`, in femtoseconds.
///
/// # Errors
/// What is wrong with it, for people.
pub fn parse_time_fs(text: &str) -> Result<u128, String> {
    time_fs(text)
        .ok_or_else(|| format!("`{text}` is not a time: write a number with fs, ps, ns, us, ms or s, such as 20ns"))
}

fn time_fs(text: &str) -> Option<u128> {
    let units = [("fs", 0), ("ps", 3), ("ns", 6), ("us", 9), ("ms", 12), ("s", 15)];
    let (number, zeros) = units
        .iter()
        .find_map(|(unit, zeros)| Some((text.strip_suffix(unit)?, *zeros)))?;
    let number = number.trim_end();
    if let Ok(whole) = number.parse::<u64>() {
        return Some(u128::from(whole) * 10u128.pow(zeros));
    }
    let number: f64 = number.parse().ok()?;
    let time = (number * 10f64.powi(zeros as i32)).round();
    // 2^64 s is far beyond any file.
    (0.0..=1.9e34).contains(&time).then_some(time as u128)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, expected) in [
            ("20ns", 20_000_000),
            ("1.5 us", 1_500_000_000),
            ("0fs", 0),
            ("2e-6s", 2_000_000_000),
        ] {
            assert_eq!(parse_time_fs(text), Ok(expected), "{text}");
        }
        for text in ["", "20", "ns", "-1ns", "nanns", "infs", "1e300s", "1h"] {
            assert!(parse_time_fs(text).is_err(), "{text}");
        }
    }

    #[test]
    fn wrong_texts_are_errors_and_change_nothing() {
        let mut options = DiffOptions::default();
        for map in ["", "a", "=b", "a=", "a=b=c", "a*=b", "*a*b*c*d*e*f*g*h*i=b"] {
            assert!(options.add_map(map).is_err(), "{map}");
        }
        for amount in ["", "x", "-1", "nan", "inf", "y=", "=1", "y=-2", "y=1mm", "%"] {
            assert!(options.add_tolerance(amount).is_err(), "{amount}");
        }
        for view in ["", "y", "y=", "=q3", "y=q", "y=q200", "y=float", "y=q1.2.3"] {
            assert!(options.add_view(view).is_err(), "{view}");
        }
        for latency in ["", "3", "=3", "y=", "y=1.5", "y=ns"] {
            assert!(options.add_latency(latency).is_err(), "{latency}");
        }
        for reset in ["", "rst=2", "=1", "rst="] {
            assert!(options.set_reset(reset).is_err(), "{reset}");
        }
        assert!(
            options
                .add_map_file("# fine\n\na=b\nwrong\n")
                .unwrap_err()
                .to_string()
                .starts_with("line 4")
        );
        assert_eq!(options.maps.len(), 1);
        options.maps.clear();
        assert_eq!(options, DiffOptions::default());
    }

    #[test]
    fn a_low_active_reset_is_known_by_its_name() {
        let mut options = DiffOptions::default();
        for (text, active) in [
            ("rst", true),
            ("top.rst_n", false),
            ("aresetn", false),
            ("rst_n=1", true),
            ("rst=0", false),
        ] {
            options.set_reset(text).unwrap();
            assert!(
                matches!(options.reset, Reset::Named { active: found, .. } if found == active),
                "{text}"
            );
        }
    }
}
