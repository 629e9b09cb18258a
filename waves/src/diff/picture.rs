//! Shows a difference: both sides in one VCD with their difference, files that open it at that time, and a drawing.
//!
//! ```text
//!  first.vcd    a.…  b.…  difference.…   the signals that differ, the clock, over all of the time
//!  first.gtkw   opens it in GTKWave, marker on the first divergence        gtkwave first.gtkw
//!  first.sucl   opens it in Surfer, cursor there                           surfer -c first.sucl
//!  first.svg    a drawing of the neighbourhood
//! ```

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::svg::{self, Lane, Trace, Window};
use super::{Comparison, Shown};
use crate::WaveError;
use crate::files::{OutputSink, write_text};
use crate::merge::{DifferenceSignal, Focus, MergePart, merge_reread};
use crate::reader::{Kind, Value, Values};

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
/// extension, which is replaced. Nothing is written if no signal of both files differs; returns whether files were
/// written.
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
    let all = |file: usize, path: &Path| -> Result<Vec<Trace>, WaveError> {
        let request = Request {
            signals: signals[file].clone(),
            window,
        };
        Ok(traces(comparison, file, path, &[request])?.pop().unwrap_or_default())
    };
    let [traces_a, traces_b] = [all(0, a)?, all(1, b)?];
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
        let is_number = |shown: &Shown| matches!(shown, Shown::Bits(_) | Shown::Real(_));
        d.is_some_and(|d| is_number(&d.a) && is_number(&d.b))
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
    let sources = [comparison.read_again(0, a)?, comparison.read_again(1, b)?];
    merge_reread(
        sink,
        &base.with_extension("vcd"),
        &parts,
        sources.into(),
        &differences,
        Some(&focus),
    )?;
    Ok(true)
}

/// Returns some samples around the first divergence, with their spacing there.
pub(super) fn window(comparison: &Comparison, first: f64) -> Window {
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

/// Full names of signals, and the window of time in which they are drawn.
pub(super) struct Request {
    pub(super) signals: Vec<String>,
    pub(super) window: Window,
}

/// Returns for each request the traces of its signals in its window, read in one pass; an empty trace for a signal that
/// the file does not have under that name.
pub(super) fn traces(
    comparison: &Comparison,
    file: usize,
    path: &Path,
    requests: &[Request],
) -> Result<Vec<Vec<Trace>>, WaveError> {
    let mut read = comparison.read_again(file, path)?;
    let names = read.declarations.names.iter();
    let by_name: HashMap<&str, u32> = names.map(|n| (n.path.as_str(), n.slot)).collect();
    let mut drawings: Vec<Drawing> = requests
        .iter()
        .map(|request| Drawing::new(request, &by_name, &read.values))
        .collect();
    while let Some(time) = read.next_time()? {
        let time = u128::from(time) * u128::from(read.declarations.unit_fs);
        for drawing in drawings.iter_mut().filter(|d| !d.entered && time > d.window.from) {
            drawing.note(drawing.window.from, &read.values);
            drawing.entered = true;
        }
        if drawings.iter().all(|drawing| time >= drawing.window.to) {
            break;
        }
        read.take_in();
        for drawing in drawings.iter_mut().filter(|d| d.entered && time < d.window.to) {
            drawing.note(time, &read.values);
        }
    }
    for drawing in drawings.iter_mut().filter(|drawing| !drawing.entered) {
        drawing.note(drawing.window.from, &read.values);
    }
    Ok(drawings.into_iter().map(|drawing| drawing.traces).collect())
}

/// The traces of a request, as far as they have been read.
struct Drawing {
    window: Window,
    slots: Vec<Option<u32>>,
    traces: Vec<Trace>,
    entered: bool,
}

impl Drawing {
    fn new(request: &Request, by_name: &HashMap<&str, u32>, values: &Values) -> Self {
        let slots: Vec<Option<u32>> = request
            .signals
            .iter()
            .map(|s| by_name.get(s.as_str()).copied())
            .collect();
        let empty = slots.iter().map(|slot| Trace {
            is_bit: slot.is_some_and(|slot| values.kind(slot) == Kind::Bits(1)),
            values: Vec::new(),
        });
        Self {
            window: request.window,
            traces: empty.collect(),
            slots,
            entered: false,
        }
    }

    fn note(&mut self, time: u128, values: &Values) {
        for (trace, slot) in self.traces.iter_mut().zip(&self.slots) {
            let Some(slot) = slot else { continue };
            let text = text(values.get(*slot));
            if trace.values.last().is_none_or(|(_, last)| *last != text) && trace.values.len() < VALUES {
                trace.values.push((time, text));
            }
        }
    }
}

/// Returns the files that [`merged`] writes.
pub fn merged_files(path: &Path) -> [PathBuf; 3] {
    [
        path.to_owned(),
        path.with_extension("gtkw"),
        path.with_extension("sucl"),
    ]
}

/// Writes one VCD with all signals of both files, in the scopes `a` and `b`, and in the scope `difference` the
/// differences of the numbers that differ; and beside it the files that open it in GTKWave and Surfer.
///
/// # Errors
/// As [`show`].
pub fn merged(
    sink: &dyn OutputSink,
    path: &Path,
    a: &Path,
    b: &Path,
    comparison: &Comparison,
) -> Result<(), WaveError> {
    let is_number = |shown: &Shown| matches!(shown, Shown::Bits(_) | Shown::Real(_));
    let compared: HashMap<&str, &(String, String)> = comparison
        .compared
        .iter()
        .map(|names| (names.0.as_str(), names))
        .collect();
    let differing: Vec<(&(String, String), String)> = comparison
        .differences
        .iter()
        .filter(|d| is_number(&d.a) && is_number(&d.b))
        .filter_map(|d| compared.get(d.signal.as_str()).copied())
        .map(|names| (names, names.0.replace('.', "_")))
        .collect();
    let differences: Vec<DifferenceSignal<'_>> = differing
        .iter()
        .map(|((of_a, of_b), name)| DifferenceSignal {
            name,
            minuend: (0, of_a),
            subtrahend: (1, of_b),
        })
        .collect();
    let parts = [MergePart { scope: "a", path: a }, MergePart { scope: "b", path: b }];
    let sources = [comparison.read_again(0, a)?, comparison.read_again(1, b)?];
    merge_reread(sink, path, &parts, sources.into(), &differences, None)
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
        Value::Event(count) => count.to_string(),
    }
}
