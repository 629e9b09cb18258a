//! Shows a difference: both sides in one VCD with their difference, files that open it at that time, and a drawing.
//!
//! ```text
//!  first.vcd    a.…  b.…  difference.…   the signals that differ, the clock, over all of the time
//!  first.gtkw   opens it in GTKWave, marker on the first divergence        gtkwave first.gtkw
//!  first.sucl   opens it in Surfer, cursor there                           surfer -c first.sucl
//!  first.svg    a drawing of the neighbourhood
//! ```

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::svg::{self, Lane, Trace, Window};
use super::{Comparison, Shown};
use crate::WaveError;
use crate::files::{OutputSink, write_text};
use crate::merge::{DifferenceSignal, Focus, MergePart, merge_around};
use crate::reader::{Kind, Value, Values, Wave};

/// Largest number of signals that are shown, the earliest first.
const SIGNALS: usize = 8;
/// Number of samples shown before the divergence and after it.
const BEFORE: u128 = 5;
const BEHIND: u128 = 6;
/// Largest number of values of a signal in a drawing; more could not be distinguished.
const VALUES: usize = 200;

/// Returns the files that [`show`] writes.
pub fn shown_files(base: &Path) -> [PathBuf; 4] {
    ["vcd", "gtkw", "sucl", "svg"].map(|extension| base.with_extension(extension))
}

/// Writes `base.vcd`, `.gtkw`, `.sucl` and `.svg` for the earliest differences of `comparison`. `base` may have an
/// extension, which is replaced. Nothing is written if nothing differs in both files; says whether it was.
///
/// # Errors
/// [`WaveError::File`] and [`WaveError::Damaged`] as for reading the files; they must still be what was compared.
pub fn show(
    sink: &dyn OutputSink,
    base: &Path,
    a: &Path,
    b: &Path,
    comparison: &Comparison,
) -> Result<bool, WaveError> {
    let Some(first) = comparison.first_time else {
        return Ok(false);
    };
    let names = |signal: &str| comparison.compared.iter().find(|(name, _)| name == signal);
    let shown: Vec<&(String, String)> = comparison
        .differences
        .iter()
        .filter_map(|difference| names(&difference.signal))
        .take(SIGNALS)
        .collect();
    if shown.is_empty() {
        return Ok(false);
    }
    let window = window(comparison, first);
    let mut lanes: Vec<&(String, String)> = comparison.clock.iter().filter(|clock| !shown.contains(clock)).collect();
    lanes.extend(&shown);

    let of = |side: fn(&(String, String)) -> &String| lanes.iter().map(|pair| side(pair).clone()).collect();
    let signals: [Vec<String>; 2] = [of(|pair| &pair.0), of(|pair| &pair.1)];
    let [traces_a, traces_b] = [traces(a, &signals[0], window)?, traces(b, &signals[1], window)?];
    let lanes = lanes
        .iter()
        .zip(traces_a.into_iter().zip(traces_b))
        .map(|(names, (a, b))| Lane {
            signal: names.0.clone(),
            differs: shown.contains(names),
            a,
            b,
        });
    let lanes: Vec<Lane> = lanes.collect();
    // A signal with several names is drawn once.
    let mut drawn: Vec<Lane> = Vec::new();
    for lane in &lanes {
        let leaf = |lane: &Lane| lane.signal.rsplit('.').next().map(str::to_owned);
        if !drawn
            .iter()
            .any(|d| (&d.a, &d.b, leaf(d)) == (&lane.a, &lane.b, leaf(lane)))
        {
            drawn.push(lane.clone());
        }
    }
    let drawing = svg::draw(&drawn, window);
    write_text(sink, &base.with_extension("svg"), &drawing)?;

    let leaves: Vec<String> = shown.iter().map(|(name, _)| name.replace('.', "_")).collect();
    let numeric = |signal: &str| {
        let d = comparison.differences.iter().find(|d| d.signal == signal);
        // A vector that is assembled from parts has no trace of its own for the difference.
        let traced = |lane: &Lane| lane.signal == signal && !lane.a.values.is_empty() && !lane.b.values.is_empty();
        d.is_some_and(|d| matches!(d.a, Shown::Bits(_) | Shown::Real(_))) && lanes.iter().any(traced)
    };
    let differences: Vec<DifferenceSignal<'_>> = shown
        .iter()
        .zip(&leaves)
        .filter(|((name, _), _)| numeric(name))
        .map(|((a, b), leaf)| DifferenceSignal {
            name: leaf,
            minuend: (0, a),
            subtrahend: (1, b),
        })
        .collect();
    let focus = Focus {
        signals: signals
            .iter()
            .map(|names| names.iter().cloned().collect::<HashSet<_>>())
            .collect(),
        time_fs: window.at,
        span_fs: window.to - window.from,
    };
    let parts = [MergePart { scope: "a", path: a }, MergePart { scope: "b", path: b }];
    merge_around(sink, &base.with_extension("vcd"), &parts, &differences, Some(&focus))?;
    Ok(true)
}

/// Returns some samples around the first divergence, with their spacing there.
fn window(comparison: &Comparison, first: f64) -> Window {
    let fs = |seconds: f64| comparison.femtoseconds(seconds);
    let at = fs(first);
    let times = comparison.context.as_ref().map_or(&[][..], |context| &context.times);
    let steps = times.windows(2).map(|pair| fs(pair[1]).saturating_sub(fs(pair[0])));
    let step = steps.filter(|step| *step > 0).min().unwrap_or(at / 10 + 1);
    Window {
        from: at.saturating_sub(BEFORE * step),
        at,
        to: at + BEHIND * step,
    }
}

/// Returns the traces of the signals in the window; an empty trace for one that the file does not have under that
/// name.
fn traces(path: &Path, signals: &[String], window: Window) -> Result<Vec<Trace>, WaveError> {
    let (declarations, mut feed) = Wave::open(path)?.play(None)?;
    let slot = |signal: &String| declarations.names.iter().find(|named| named.path == *signal);
    let slots: Vec<Option<u32>> = signals.iter().map(|signal| Some(slot(signal)?.slot)).collect();
    let mut values = Values::new(&declarations.kinds);
    let is_bit = |slot: &Option<u32>| slot.is_some_and(|slot| values.kind(slot) == Kind::Bits(1));
    let empty = slots.iter().map(|slot| Trace {
        is_bit: is_bit(slot),
        values: Vec::new(),
    });
    let mut traces: Vec<Trace> = empty.collect();
    let note = |time: u128, values: &Values, traces: &mut Vec<Trace>| {
        for (trace, slot) in traces.iter_mut().zip(&slots) {
            let Some(slot) = slot else { continue };
            let text = text(values.get(*slot));
            if trace.values.last().is_none_or(|(_, last)| *last != text) && trace.values.len() < VALUES {
                trace.values.push((time, text));
            }
        }
    };
    let mut entered = false;
    while let Some(step) = feed.next_step()? {
        let time = u128::from(step.time) * u128::from(declarations.unit_fs);
        if time >= window.to {
            break;
        }
        if time > window.from && !std::mem::replace(&mut entered, true) {
            note(window.from, &values, &mut traces);
        }
        for (slot, words) in feed.changes() {
            values.set(slot, words);
        }
        if entered {
            note(time, &values, &mut traces);
        }
    }
    if !entered {
        note(window.from, &values, &mut traces);
    }
    Ok(traces)
}

/// Formats a value for a drawing: a bit, hexadecimal digits, a number, text.
fn text(value: Value<'_>) -> String {
    match value {
        Value::Bits { width: 1, .. } => value.digits(1, false),
        Value::Bits { width, bits, unknown } if unknown.iter().all(|word| *word == 0) => {
            let words: String = bits.iter().rev().map(|word| format!("{word:016x}")).collect();
            let digits = width.div_ceil(4) as usize;
            words[words.len() - digits..].to_owned()
        }
        Value::Bits { width, .. } => value.digits(width, false),
        Value::Real(real) => real.map_or_else(|| "x".to_owned(), |real| format!("{real}")),
        Value::Text(_) => value.text().unwrap_or_else(|| "x".to_owned()),
        Value::Event => String::new(),
    }
}
