//! Compares two waveforms.
//!
//! ```text
//!  A ─► reader thread ─┐  signals paired by name        ┌─ with a clock: k-th edge of A after reset with the k-th of B,
//!   (VCD, FST)         ├─► (roots, filters, maps) ─► when ┤  values just before the edge
//!  B ─► reader thread ─┘                                └─ without: at every time at which something changes
//!                                                           └─► equal? by each signal's rule ─► result, text, JUnit, views
//! ```
//!
//! # Rules
//! - **Names.** Maps come first, then full names. If no full names match, the scopes that all signals of a file share
//!   are stripped, as few as give the most pairs. Signals still without a partner are matched by their canonical name
//!   (`a$b`, `a__b`, `A.B`), if there is one candidate. A vector that one file writes bit by bit is matched with the
//!   whole vector of the other.
//! - **Partners.** A signal without a partner is listed, never silently left out; with [`DiffOptions::require_all`] it
//!   is a difference.
//! - **Clock.** With a clock, values are those just before its edge, so that registers of both sides compare equal
//!   whether their file shows changes at the edge or after it. Edges are paired by their number after the release of
//!   the reset, not by their time; different times give a note, different numbers a difference of the clock.
//! - **Recording.** Times that one file does not record (`$dumpoff`) are not compared; after them, edges are paired
//!   by time again.
//! - **Unknown bits.** They are compared by [`UnknownPolicy`]. A signal without a value yet is `x`.
//! - **Widths.** The narrower value is extended with zeros, as in VCD; in a signed view, with its sign. The result
//!   names both widths, and is then not exact.
//! - **Tolerance.** See [`Tolerance`]; without a [`View`], bits are then signed numbers. A real and a vector are
//!   compared as numbers, exactly if there is no tolerance. A tolerance for all signals does not apply to single bits
//!   and text.
//! - **Nothing compared.** The result is `incomparable` if there is no common signal except the clock, or no sample.
//!
//! Both files are read once and at the same time; memory depends on the number of signals and their widths, not on
//! the length. Only [`show`] reads them again, on request.

mod alike;
#[cfg(test)]
mod alike_tests;
mod cells;
mod clocking;
mod delay;
mod edges;
mod engine;
mod explain;
mod finish;
mod gather;
mod github;
mod human;
mod junit;
mod leave_out;
mod matching;
mod names;
mod options;
mod page;
mod parts;
mod pattern;
mod picture;
mod reading;
mod result;
mod rule;
pub mod sample;
mod scopes;
mod side;
mod svg;
mod text;
mod touched;
mod value;

use std::collections::{BTreeSet, HashSet};
use std::path::Path;

/// The JSON Schema of a [`Comparison`], as `--json` prints it.
pub const JSON_SCHEMA: &str = include_str!("../../wavecmp.schema.json");

use self::clocking::Clocking;
pub use self::clocking::SAMPLE_CLOCK;
use self::engine::Engine;
pub use self::engine::Progress;
pub use self::explain::{MatchReport, MatchedSignal, UnmatchedSignal};
pub use self::github::{annotations, step_summary};
pub use self::human::{value, value_and_digits};
pub use self::junit::junit;
pub use self::matching::MatchedBy;
use self::matching::{Matched, Pair};
use self::names::{Filter, Names};
pub use self::options::{DiffOptions, Latency, Reset, SamplingEdge, parse_time_fs};
pub use self::page::html;
pub use self::picture::{merged, merged_files, show, shown_files};
pub(crate) use self::reading::{Reading, Reread};
pub use self::result::{Comparison, Context, ContextRow, CutFile, DiffVerdict, Difference, Leniency, SignalState};
use self::rule::Rule;
pub use self::rule::{Tolerance, View};
use self::side::{Delayed, Side, slot_of};
pub use self::value::{Shown, UnknownPolicy};
use crate::WaveError;
use crate::quiet::caught;
use crate::reader::{self, Declarations, FileEnd, Kind, Selection, Watch, Wave};
use crate::wording::{counted, time};

/// Compares file `a` with file `b`. `progress` is called now and then.
///
/// # Errors
/// [`WaveError::File`] and [`WaveError::Damaged`] for files that cannot be read to their end; [`WaveError::Option`] for
/// options that do not fit these files.
pub fn compare(
    a: &Path,
    b: &Path,
    options: &DiffOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Comparison, WaveError> {
    compare_by(a, b, options, progress, false)
}

/// As [`compare`]; with `plainly`, every change of both files is read.
///
/// Where signals turn out to have values of another kind than declared, the files are read again with a kind for these
/// that holds any value.
fn compare_by(
    a: &Path,
    b: &Path,
    options: &DiffOptions,
    progress: &mut dyn FnMut(Progress),
    plainly: bool,
) -> Result<Comparison, WaveError> {
    let mut odd: [BTreeSet<u32>; 2] = Default::default();
    loop {
        let (mut comparison, found) = compare_once([a, b], options, progress, plainly, &odd)?;
        let more = odd.iter().zip(&found).any(|(odd, found)| !found.is_subset(odd));
        if !more {
            return Ok(comparison);
        }
        if ![a, b].into_iter().all(reader::can_be_read_again) {
            comparison
                .not_compared_because("a value of another kind than declared came through a pipe: save it in a file");
            return Ok(comparison);
        }
        for (odd, mut found) in odd.iter_mut().zip(found) {
            odd.append(&mut found);
        }
    }
}

/// Reads both files once; the signals in `odd` hold values of any kind. Also returns the signals that should have been among them.
fn compare_once(
    [a, b]: [&Path; 2],
    options: &DiffOptions,
    progress: &mut dyn FnMut(Progress),
    plainly: bool,
    odd: &[BTreeSet<u32>; 2],
) -> Result<(Comparison, [BTreeSet<u32>; 2]), WaveError> {
    let select = |side: usize| names::selection(options.roots[side].as_deref(), &options.only, &options.ignore);
    let mut waves = open_both([a, b], [select(0)?, select(1)?])?;
    for (wave, odd) in waves.iter_mut().zip(odd) {
        wave.hold_any(odd);
    }
    let slots = waves.each_ref().map(|wave| wave.declarations.kinds.len());
    let plan = Plan::new(&mut waves, options)?;
    let widths = widths(&plan.matched, &waves);
    let mut comparison = Comparison::new(&plan.matched, &plan.rules, &plan.latency_texts(), &widths);
    comparison.unknown = options.unknown;
    let strict = options.unknown == UnknownPolicy::Strict && options.time_tolerance_fs == 0 && options.glitch_fs == 0;
    comparison.exact &= strict;
    comparison.only_widths &= strict;
    comparison.unit_fs = waves.iter().map(|wave| wave.declarations.unit_fs).min().unwrap_or(1);
    comparison.notes.clone_from(&plan.clocking.notes);
    for (wave, file) in waves.iter().zip(["first", "second"]) {
        if wave.declarations.unit_is_assumed {
            let note = format!("the {file} file has no $timescale: its times are taken as nanoseconds");
            comparison.notes.push(note);
        }
        let notes = wave.declarations.notes.iter();
        comparison
            .notes
            .extend(notes.map(|note| format!("the {file} file: {note}")));
    }
    if options.explain {
        let left_out = plan.names.iter().map(|names| names.left_out).sum();
        comparison.matching = Some(MatchReport::new(&plan.matched, left_out));
    }
    if let [first, ..] = plan.matched.assumed.as_slice() {
        comparison.exact = false;
        comparison.notes.push(format!(
            "a vector is split into parts in one file and has no range in the other: the lowest index is taken for the last digit, in \
             {}, such as {first}",
            counted(plan.matched.assumed.len() as u64, "vector")
        ));
    }
    if let [(first, [a, b]), ..] = plan.matched.ranges.as_slice() {
        comparison.exact = false;
        comparison.notes.push(format!(
            "declared with other indices in each file and compared digit by digit: {}, such as {first}, [{}:{}] and [{}:{}]",
            counted(plan.matched.ranges.len() as u64, "vector"),
            a.left,
            a.right,
            b.left,
            b.right
        ));
    }
    comparison.signals = comparison.compared.len() as u64;
    let clock = plan.clocking.clock;
    let is_clock = |pair: &Pair| clock.is_some_and(|[a, b]| (pair.a, pair.b) == (Some(a), Some(b)));
    comparison.clock = plan
        .matched
        .pairs
        .iter()
        .find(|pair| is_clock(pair))
        .and_then(Pair::names);
    let common = plan.matched.pairs.iter().filter(|p| p.a.is_some() && p.b.is_some());
    if common.filter(|pair| !is_clock(pair)).count() == 0 {
        let is_filtered = !options.only.is_empty() || !options.ignore.is_empty();
        let is_empty = waves.iter().position(|wave| wave.declarations.names.is_empty());
        if let (Some(side), false) = (is_empty, is_filtered) {
            comparison.incomparable(&format!("the {} file declares no signal", ["first", "second"][side]));
            return Ok((comparison, Default::default()));
        }
        comparison.incomparable(if is_filtered && plan.names.iter().any(|names| names.left_out > 0) {
            "of the signals that --only and --ignore leave, only the clock is in both files"
        } else {
            "the files have no signal in common; match scopes or signals with --map A=B"
        });
        return Ok((comparison, Default::default()));
    }
    comparison.readings = readings(&plan.matched, &slots, odd, &waves);
    let plan_not_compared: Vec<String> = plan.matched.not_compared.clone();
    if !plainly {
        plan.leave_out(&mut waves, options);
        plan.leave_out_same(&mut waves, options);
    }
    let mut engine = plan.start(waves, options)?;
    if !plainly {
        engine.look_for_alike();
    }
    match clock {
        Some(clock) => engine.at_edges(clock, progress)?,
        None => engine.at_changes(progress)?,
    }
    let found = engine.odd();
    engine.finish(&mut comparison);
    if !plan_not_compared.is_empty() {
        comparison
            .not_compared_because("they are events in one file and values in the other: leave them out with --ignore");
    }
    Ok((comparison, found))
}

/// Opens both files at the same time.
fn open_both([a, b]: [&Path; 2], [of_a, of_b]: [Selection; 2]) -> Result<[Wave; 2], WaveError> {
    let (a, b) = std::thread::scope(|scope| {
        let b = scope.spawn(|| caught(|| Wave::open_selected(b, of_b)));
        (Wave::open_selected(a, of_a), b.join().ok().flatten())
    });
    let again = || WaveError::Option("the second file could not be opened".to_owned());
    Ok([a?, b.ok_or_else(again)??])
}

/// The pairs, and how they are compared.
struct Plan {
    names: [Names; 2],
    matched: Matched,
    clocking: Clocking,
    /// The rule of each pair.
    rules: Vec<Rule>,
    latencies: Vec<Option<Latency>>,
}

impl Plan {
    fn new([wave_a, wave_b]: &mut [Wave; 2], options: &DiffOptions) -> Result<Self, WaveError> {
        let filter = Filter::new(&options.only, &options.ignore)?;
        let [root_a, root_b] = &options.roots;
        let a = Names::new(&wave_a.declarations, root_a.as_deref(), &filter, "first")?;
        let b = Names::new(&wave_b.declarations, root_b.as_deref(), &filter, "second")?;
        let (a_kinds, b_kinds) = (&mut wave_a.declarations.kinds, &mut wave_b.declarations.kinds);
        let mut matched = Matched::new(&a, &b, &options.maps, [a_kinds.len(), b_kinds.len()])?;
        for (kinds, derived) in [&mut *a_kinds, &mut *b_kinds].into_iter().zip(&matched.derived) {
            kinds.extend(derived.iter().map(|derived| Kind::Bits(derived.width)));
        }
        let (a_kinds, b_kinds) = (&*a_kinds, &*b_kinds);
        // Filtering glitches keeps values, and an event has none.
        let events_fit = options.glitch_fs == 0;
        matched.leave_out(|pair| {
            let kind = |kinds: &[Kind], slot: Option<u32>| slot.map(|slot| kinds[slot as usize]);
            match [kind(a_kinds, pair.a), kind(b_kinds, pair.b)] {
                [Some(Kind::Event), Some(Kind::Event)] => !events_fit,
                [Some(Kind::Event), Some(_)] | [Some(_), Some(Kind::Event)] => true,
                _ => false,
            }
        });
        let clocking = Clocking::find(&matched, options, |pair| {
            let one_bit = |kinds: &[Kind], slot: Option<u32>| slot.is_some_and(|s| kinds[s as usize] == Kind::Bits(1));
            one_bit(a_kinds, pair.a) && one_bit(b_kinds, pair.b)
        })?;
        let sampled = clocking.clock.is_some();
        if sampled && (options.time_tolerance_fs > 0 || options.glitch_fs > 0) {
            return Err(WaveError::Option(
                "--time-tolerance and --glitch are for files that are compared at every change: add --raw".to_owned(),
            ));
        }
        let mut rules = rules(&matched, options, |pair| {
            let kind = |kinds: &[Kind], slot: Option<u32>| slot.map(|s| kinds[s as usize]);
            [kind(a_kinds, pair.a), kind(b_kinds, pair.b)]
        })?;
        let to_16_digits = wave_a.is_fst() != wave_b.is_fst();
        rules.iter_mut().for_each(|rule| rule.to_16_digits = to_16_digits);
        Ok(Self {
            latencies: latencies(&matched, options, sampled)?,
            names: [a, b],
            matched,
            clocking,
            rules,
        })
    }

    fn latency_texts(&self) -> Vec<Option<String>> {
        let text = |latency: &Latency| match latency {
            Latency::Samples(samples) if *samples < 0 => format!("-{}", counted(samples.unsigned_abs(), "sample")),
            Latency::Samples(samples) => counted(samples.unsigned_abs(), "sample"),
            Latency::Femtoseconds(fs) if *fs < 0 => format!("-{}", time(fs.unsigned_abs())),
            Latency::Femtoseconds(fs) => time(fs.unsigned_abs()),
        };
        self.latencies
            .iter()
            .map(|latency| latency.as_ref().map(text))
            .collect()
    }

    /// Starts to read both files.
    fn start(self, [wave_a, wave_b]: [Wave; 2], options: &DiffOptions) -> Result<Engine<'_>, WaveError> {
        let total_bytes = wave_a.bytes().zip(wave_b.bytes()).map(|(a, b)| a + b);
        let Self {
            names: _,
            matched,
            clocking,
            rules,
            latencies,
        } = self;
        let wanted = |pair: &Pair| options.require_all || (pair.a.is_some() && pair.b.is_some());
        let chosen = matched.pairs.into_iter().zip(rules).zip(latencies);
        let chosen: Vec<((Pair, Rule), Option<Latency>)> = chosen.filter(|((pair, _), _)| wanted(pair)).collect();
        let (mut pairs, latencies): (Vec<(Pair, Rule)>, Vec<Option<Latency>>) = chosen.into_iter().unzip();
        let mut delays: [Vec<Delayed>; 2] = Default::default();
        for (pair, latency) in (0..).zip(latencies) {
            let by = match latency {
                None => continue,
                Some(Latency::Samples(by)) => i128::from(by),
                Some(Latency::Femtoseconds(by)) => by,
            };
            // If the second file is late, the first is delayed, and vice versa.
            let by_abs = by.unsigned_abs();
            delays[usize::from(by < 0)].push(Delayed { by: by_abs, pair });
        }
        let mut sides = Vec::new();
        for (at, wave) in [wave_a, wave_b].into_iter().enumerate() {
            let of_b = at == 1;
            let watch = clocking.clock.map(|clock| Watch {
                slot: slot_of(clock, of_b),
                falling: options.edge == SamplingEdge::Falling,
            });
            let file_end = if options.allow_truncated {
                FileEnd::UpToLastTime
            } else {
                FileEnd::Refuse
            };
            let (declarations, feed) = wave.play(watch, file_end)?;
            let Declarations { kinds, unit_fs, .. } = declarations;
            let slot = |pair: &mut Pair| if of_b { pair.b } else { pair.a };
            let mut slots: Vec<Option<u32>> = pairs.iter_mut().map(|(pair, _)| slot(pair)).collect();
            let mut side = Side::new(at, feed, &kinds, unit_fs, &matched.derived[at], &mut slots, &delays[at]);
            for ((pair, _), slot) in pairs.iter_mut().zip(slots) {
                *(if of_b { &mut pair.b } else { &mut pair.a }) = slot;
            }
            if let Some(clock) = clocking.clock {
                side.hidden.set_clock(slot_of(clock, of_b));
            }
            if let Some((reset, active)) = clocking.reset {
                side.wait_for_release(slot_of(reset, of_b), active);
            }
            if options.glitch_fs > 0 {
                side.without_glitches(options.glitch_fs, &kinds);
            }
            sides.push(side);
        }
        let [side_a, side_b] =
            <[Side; 2]>::try_from(sides).map_err(|_| WaveError::Option("two files are compared".to_owned()))?;
        let mut engine = Engine::new(side_a, side_b, pairs, options, total_bytes);
        engine.wait_for(delays.iter().flatten().map(|delay| delay.pair));
        Ok(engine)
    }
}

/// Returns how each file is read again. `slots` are the numbers of slots of the files.
fn readings(matched: &Matched, slots: &[usize; 2], odd: &[BTreeSet<u32>; 2], waves: &[Wave; 2]) -> [Reading; 2] {
    [0, 1].map(|side| {
        let derived = matched.derived[side].iter();
        let sources = derived.flat_map(|derived| derived.runs.iter().map(|run| run.source));
        let needed: HashSet<u32> = sources.chain(odd[side].iter().copied()).collect();
        let declared = waves[side].declarations.names.iter();
        let declared = declared.filter(|named| needed.contains(&named.slot));
        let names = matched.pairs.iter().filter_map(|pair| {
            let (name, slot) = match side {
                0 => (Some(&pair.name), pair.a?),
                _ => (pair.b_name.as_ref(), pair.b?),
            };
            (slot as usize >= slots[side]).then_some((name?.clone(), slot))
        });
        Reading {
            any: odd[side].clone(),
            names: names.collect(),
            derived: matched.derived[side].clone(),
            slots: slots[side] as u32,
            declared: declared.map(|named| (named.path.clone(), named.slot)).collect(),
        }
    })
}

/// Returns the widths of each pair of vectors, if they differ.
fn widths(matched: &Matched, [a, b]: &[Wave; 2]) -> Vec<Option<[u32; 2]>> {
    let width = |wave: &Wave, slot: Option<u32>| match wave.declarations.kinds[slot? as usize] {
        Kind::Bits(width) => Some(width),
        Kind::Real | Kind::Text | Kind::Event | Kind::Any(_) => None,
    };
    let widths = |pair: &Pair| Some([width(a, pair.a)?, width(b, pair.b)?]).filter(|[a, b]| a != b);
    matched.pairs.iter().map(widths).collect()
}

/// Returns the rule of each pair. `kinds` returns those of its two signals.
fn rules(
    matched: &Matched,
    options: &DiffOptions,
    kinds: impl Fn(&Pair) -> [Option<Kind>; 2],
) -> Result<Vec<Rule>, WaveError> {
    let width = |pair: &Pair| {
        let bits = |kind: &Option<Kind>| match kind {
            Some(Kind::Bits(width)) => Some(*width),
            _ => None,
        };
        kinds(pair).iter().filter_map(bits).max()
    };
    let is_text = |pair: &Pair| kinds(pair).contains(&Some(Kind::Text));
    let for_all = options.tolerances.iter().rev().find(|(signal, _)| signal.is_none());
    let mut rules: Vec<Rule> = matched
        .pairs
        .iter()
        .map(|pair| {
            let fits = !is_text(pair) && width(pair).is_none_or(|bits| (2..=127).contains(&bits));
            Rule {
                tolerance: for_all.filter(|_| fits).map(|(_, tolerance)| *tolerance),
                unknown: options.unknown,
                ..Rule::default()
            }
        })
        .collect();
    for (signal, view) in &options.views {
        for at in meant(matched, "--view", signal)? {
            rules[at].view = *view;
        }
    }
    for (signal, tolerance) in &options.tolerances {
        let Some(signal) = signal else { continue };
        for at in meant(matched, "--tolerance", signal)? {
            rules[at].tolerance = Some(*tolerance);
            let widest = rules[at].view.widest();
            if let Some(bits) = width(&matched.pairs[at]).filter(|bits| *bits > widest) {
                return Err(WaveError::Option(format!(
                    "--tolerance {signal}={tolerance}: {bits} bits are too many for a number; a tolerance needs at most \
                     {widest}"
                )));
            }
        }
    }
    Ok(rules)
}

fn latencies(matched: &Matched, options: &DiffOptions, sampled: bool) -> Result<Vec<Option<Latency>>, WaveError> {
    let mut latencies = vec![None; matched.pairs.len()];
    for (signal, latency) in &options.latencies {
        match (latency, sampled) {
            (Latency::Samples(_), true) | (Latency::Femtoseconds(_), false) => {}
            (Latency::Samples(samples), false) => {
                return Err(WaveError::Option(format!(
                    "--latency {signal}={samples}: samples need a clock; give a time, such as 20ns, or name the clock"
                )));
            }
            (Latency::Femtoseconds(_), true) => {
                return Err(WaveError::Option(format!(
                    "--latency {signal}: with a clock, give the number of samples, or add --raw"
                )));
            }
        }
        for at in meant(matched, "--latency", signal)? {
            latencies[at] = Some(*latency);
        }
    }
    Ok(latencies)
}

fn meant(matched: &Matched, option: &str, signal: &str) -> Result<Vec<usize>, WaveError> {
    let meant = matched.meant(signal)?;
    if meant.is_empty() {
        return Err(WaveError::Option(format!(
            "{option} {signal}: the first file has no signal that fits"
        )));
    }
    Ok(meant)
}
