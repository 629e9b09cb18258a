//! Compares two VCDs: `posicast diff`.
//!
//! ```text
//!  A.vcd ─► steps ─┐   signals paired by name      ┌─ with a clock: k-th rising edge of A with the k-th of B,
//!                  ├─► (strip tops, --map) ─► where ┤  values just before the edge
//!  B.vcd ─► steps ─┘                                └─ without: at every time at which something changes
//!                                                        └─► equal? exactly, or within a tolerance ─► result
//! ```
//!
//! # Rules
//! - **Names.** Full names first. If nothing has the same full name, the scopes that all signals of a file share are
//!   stripped, as few as give the most pairs. [`Options::maps`] come before both.
//! - **Partners.** A signal without a partner is listed, never silently left out; with [`Options::require_all`] it is a
//!   difference.
//! - **Clock.** With a clock, values are those just before its rising edge (0 to 1), so that registers of both sides
//!   compare the same whether their file shows changes at the edge or after it. Edges are paired by their number, not by
//!   their time; that the times differ is a note, that the numbers differ is a difference of the clock.
//! - **Unknown bits.** `x` equals `x`, `z` equals `z`, nothing else. A signal without a value yet is `x`.
//! - **Widths.** Exactly: the narrower is extended with zeros, as VCD does. With a tolerance: both are signed numbers.
//! - **Tolerance.** In LSB, for vectors, and in the number's own unit for reals; a real against a vector is compared as
//!   number, exactly if there is no tolerance. A tolerance for all signals leaves single bits alone.
//! - **Nothing compared** is `incomparable`: no common signal beside the clock, or no sample.
//!
//! Both files are read in step; memory depends on the number of signals and their widths, not on the length.

mod engine;
mod equality;
mod matching;
mod result;

use std::path::Path;

use self::engine::Engine;
use self::matching::{Matched, Pair};
pub use self::result::{Comparison, Difference, Shown, Verdict};
use crate::Error;
use crate::reader::{Kind, Reader};

/// What to compare, and how strictly.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Name of the clock in the first file: full, or its end where that is unique.
    pub clock: Option<String>,
    /// `(A, B)`: scope or signal `A` of the first file is `B` of the second.
    pub maps: Vec<(String, String)>,
    /// Tolerances in LSB: of one signal of the first file, or of all. The signal's own comes first.
    pub tolerances: Vec<(Option<String>, f64)>,
    /// A signal that only one file has is a difference, instead of being listed.
    pub require_all: bool,
}

impl Options {
    /// Adds a `--map`.
    ///
    /// # Errors
    /// [`Error::Option`] if it is not `A=B`.
    pub fn add_map(&mut self, text: &str) -> Result<(), Error> {
        match text.split_once('=') {
            Some((a, b)) if !a.is_empty() && !b.is_empty() && !b.contains('=') => {
                self.maps.push((a.to_owned(), b.to_owned()));
                Ok(())
            }
            _ => Err(Error::Option(format!(
                "--map {text}: write A=B, where A is a scope or signal of the first file and B of the second"
            ))),
        }
    }

    /// Adds a `--tolerance`.
    ///
    /// # Errors
    /// [`Error::Option`] if it is not `LSB` or `SIGNAL=LSB` with a number ≥ 0.
    pub fn add_tolerance(&mut self, text: &str) -> Result<(), Error> {
        let (signal, number) = match text.rsplit_once('=') {
            Some((signal, number)) => (Some(signal.to_owned()), number),
            None => (None, text),
        };
        match number.parse::<f64>() {
            Ok(lsb) if lsb.is_finite() && lsb >= 0.0 && signal.as_deref() != Some("") => {
                self.tolerances.push((signal, lsb));
                Ok(())
            }
            _ => Err(Error::Option(format!(
                "--tolerance {text}: write LSB or SIGNAL=LSB with a number that is not negative, such as y=0.5"
            ))),
        }
    }
}

/// Compares file `a` with file `b`. `progress` is called with the samples compared, every 65,536 samples.
///
/// # Errors
/// [`Error::File`] and [`Error::Vcd`] for files that cannot be read to their end; [`Error::Option`] for options that do
/// not fit these files.
pub fn compare(a: &Path, b: &Path, options: &Options, progress: &mut dyn FnMut(u64)) -> Result<Comparison, Error> {
    let (a, b) = (Reader::open(a)?, Reader::open(b)?);
    let mut matched = Matched::new(a.names(), b.names(), &options.maps)?;
    matched.leave_out(|slot| a.kind(slot) == Kind::Other, |slot| b.kind(slot) == Kind::Other);
    let clock = matched.clock(options.clock.as_deref(), |pair| {
        let one_bit = |reader: &Reader, slot: Option<u32>| slot.is_some_and(|s| reader.kind(s) == Kind::Bits(1));
        one_bit(&a, pair.a) && one_bit(&b, pair.b)
    })?;
    let tolerances = matched.tolerances(&options.tolerances, |pair| {
        let bits = |reader: &Reader, slot: Option<u32>| match slot.map(|s| reader.kind(s)) {
            Some(Kind::Bits(width)) => Some(width),
            _ => None,
        };
        bits(&a, pair.a).max(bits(&b, pair.b))
    })?;

    let mut comparison = Comparison::new(&matched, clock.note, &tolerances);
    let common = matched.pairs.iter().filter(|p| p.a.is_some() && p.b.is_some());
    comparison.signals = common.clone().count() as u64;
    let compared = common.filter(|p| clock.pair.is_none_or(|c| (p.a, p.b) != (Some(c.0), Some(c.1))));
    if compared.count() == 0 {
        comparison.incomparable("the files have no signal in common; say with --map A=B which belong together");
        return Ok(comparison);
    }
    let wanted = |pair: &Pair| options.require_all || (pair.a.is_some() && pair.b.is_some());
    let pairs = matched.pairs.into_iter().zip(tolerances);
    let mut engine = Engine::new(a, b, pairs.filter(|(pair, _)| wanted(pair)));
    match clock.pair {
        Some(clock) => engine.at_edges(clock, progress)?,
        None => engine.at_changes(progress)?,
    }
    engine.finish(&mut comparison);
    Ok(comparison)
}
