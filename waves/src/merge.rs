//! Merges several waveforms side by side into one file, with their differences, and writes the files that open it in
//! a viewer.
//!
//! ```text
//!  model.vcd ─┐            merged.vcd:  model.…  rtl.…  float.…  difference.…
//!  rtl.vcd   ─┼─► merge ─► merged.gtkw: opens it in GTKWave   (gtkwave merged.gtkw)
//!  float.vcd ─┘            merged.sucl: opens it in Surfer    (surfer -c merged.sucl)
//! ```
//!
//! Each part keeps its signals under a scope with its name, below the scopes that they do not all share. All use one
//! time axis, in the finest of their units of time (ten or a hundred of a unit count as that unit). The times in the
//! viewers' files use that unit, too.

mod views;

use std::collections::HashSet;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use vcd::{IdCode, VarType, Writer};

use self::views::write_views;
use crate::WaveError;
use crate::diff::{Reading, Reread};
use crate::files::{OutputSink, write_error};
use crate::reader::{Kind, Named, Value};
use crate::unit::unit_for;

/// One of the waveforms.
#[derive(Debug, Clone, Copy)]
pub struct MergePart<'a> {
    /// Scope in the merged file: `model`, `rtl`, `float`.
    pub scope: &'a str,
    /// Path of the VCD.
    pub path: &'a Path,
}

/// A signal `difference.<name>` = value of one signal minus that of another, as a real number; words are signed, bits
/// are not.
#[derive(Debug, Clone, Copy)]
pub struct DifferenceSignal<'a> {
    /// Name of the new signal.
    pub name: &'a str,
    /// Part (its index in the list) and signal, with its full name or without the scopes that all signals of its file
    /// share.
    pub minuend: (usize, &'a str),
    /// The same for the subtrahend.
    pub subtrahend: (usize, &'a str),
}

/// Subject of a merged file: some signals, and a time at which the viewers open it.
#[derive(Debug, Clone)]
pub struct Focus {
    /// Full names, for each part; other signals are left out.
    pub signals: Vec<HashSet<String>>,
    /// Time at which the viewers open the file, in femtoseconds.
    pub time_fs: u128,
    /// Length of the visible time around it, in femtoseconds.
    pub span_fs: u128,
}

type Vcd<'a> = Writer<BufWriter<&'a mut dyn Write>>;

/// The writer, with the name of its file for messages.
struct Output<'a> {
    path: &'a Path,
    vcd: Vcd<'a>,
}

impl<'a> Output<'a> {
    fn new(path: &'a Path, out: &'a mut dyn Write) -> Self {
        let vcd = Writer::new(BufWriter::with_capacity(1 << 16, out));
        Self { path, vcd }
    }

    fn write<T>(&mut self, action: impl FnOnce(&mut Vcd<'a>) -> io::Result<T>) -> Result<T, WaveError> {
        action(&mut self.vcd).map_err(write_error(self.path))
    }
}

/// Writes a real with an exponent, because large ones written out are longer than readers accept.
fn write_real(vcd: &mut Vcd<'_>, id: IdCode, value: f64) -> io::Result<()> {
    writeln!(vcd.writer(), "r{value:e} {id}")
}

/// Scope of the differences.
const DIFFERENCE: &str = "difference";

struct Open {
    scope: String,
    names: Vec<Named>,
    read: Reread,
    unit_fs: u64,
    /// Time of the current step.
    time: Option<u64>,
    /// Name below the shared scopes, and slot.
    signals: Vec<(String, u32)>,
    /// Id in the merged file, by slot.
    ids: Vec<Option<IdCode>>,
    /// Number of values that each slot was given.
    values: Vec<u64>,
}

impl Open {
    fn new(part: &MergePart<'_>, mut read: Reread, only: Option<&HashSet<String>>) -> Self {
        let mut names = std::mem::take(&mut read.declarations.names);
        if let Some(only) = only {
            names.retain(|named| only.contains(&named.path));
        }
        let now = &read.values;
        let slots = now.count();
        let shared = names.first().map_or(0, |first| {
            let shares = |top: &str| names.iter().all(|named| named.path.starts_with(top));
            let ends = first.path.match_indices('.').map(|(at, _)| at + 1);
            ends.take_while(|end| shares(&first.path[..*end])).last().unwrap_or(0)
        });
        let mut signals: Vec<(String, u32)> = names
            .iter()
            // A VCD has no place for a signal without bits.
            .filter(|named| now.kind(named.slot) != Kind::Bits(0))
            .map(|named| (named.path[shared..].to_owned(), named.slot))
            .collect();
        // The signals are sorted by scope, so that each scope is opened once; within a scope they stay in the order
        // of the file.
        signals.sort_by(|(a, _), (b, _)| scope_of(a).cmp(scope_of(b)));
        Self {
            scope: part.scope.to_owned(),
            ids: vec![None; slots],
            values: vec![0; slots],
            signals,
            names,
            unit_fs: read.declarations.unit_fs,
            read,
            time: None,
        }
    }

    fn next_fs(&self) -> Option<u128> {
        Some(u128::from(self.time?) * u128::from(self.unit_fs))
    }

    fn find(&self, name: &str) -> Option<u32> {
        let full = self.names.iter().find(|named| named.path == name);
        let short = self.signals.iter().find(|(short, _)| short == name);
        full.map(|named| named.slot).or(short.map(|(_, slot)| *slot))
    }
}

fn scope_of(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(scope, _)| scope)
}

struct Subtraction {
    id: IdCode,
    minuend: (usize, u32),
    subtrahend: (usize, u32),
    last: Option<u64>,
}

/// Writes `path` (a `.vcd`) and beside it the `.gtkw` and `.sucl` of the same name.
///
/// # Errors
/// [`WaveError::File`] and [`WaveError::Damaged`] as for reading each part; [`WaveError::Option`] where a difference
/// names an unknown signal.
pub fn merge(
    sink: &dyn OutputSink,
    path: &Path,
    parts: &[MergePart<'_>],
    differences: &[DifferenceSignal<'_>],
) -> Result<(), WaveError> {
    merge_around(sink, path, parts, differences, None)
}

/// Like [`merge`], restricted to `focus`.
///
/// # Errors
/// As [`merge`].
pub fn merge_around(
    sink: &dyn OutputSink,
    path: &Path,
    parts: &[MergePart<'_>],
    differences: &[DifferenceSignal<'_>],
    focus: Option<&Focus>,
) -> Result<(), WaveError> {
    let sources = parts.iter().map(|part| Reading::default().open(part.path, false));
    let sources = sources.collect::<Result<Vec<_>, WaveError>>()?;
    merge_reread(sink, path, parts, sources, differences, focus)
}

/// Like [`merge_around`], with files that are open.
pub(crate) fn merge_reread(
    sink: &dyn OutputSink,
    path: &Path,
    parts: &[MergePart<'_>],
    sources: Vec<Reread>,
    differences: &[DifferenceSignal<'_>],
    focus: Option<&Focus>,
) -> Result<(), WaveError> {
    let only = |at: usize| focus.and_then(|focus| focus.signals.get(at));
    let opened = parts.iter().zip(sources).enumerate();
    let mut parts: Vec<Open> = opened
        .map(|(at, (part, read))| Open::new(part, read, only(at)))
        .collect();
    let (unit, unit_fs) = unit_for(parts.iter().map(|p| p.unit_fs).min().unwrap_or(1_000_000));
    let mark = sink.mark();
    let mut end = 0;
    let spot = focus.map(|focus| [focus.time_fs, focus.span_fs].map(|fs| (fs / u128::from(unit_fs)) as u64));
    sink.write(path, &mut |out| {
        let mut output = Output::new(path, out);
        output.write(|vcd| {
            vcd.version(concat!("wavecmp ", env!("CARGO_PKG_VERSION")))?;
            vcd.comment(&mark)?;
            vcd.timescale(1, unit)
        })?;
        for part in &mut parts {
            declare(&mut output, part)?;
        }
        let mut subtractions = subtractions(&mut output, &parts, differences)?;
        output.write(|vcd| vcd.enddefinitions())?;
        end = changes(&mut output, &mut parts, &mut subtractions, unit_fs)?;
        // Viewers show no time after the last one of the file: GTKWave then opens at the beginning instead.
        let room = spot.map(|[time, span]| time.saturating_add(span));
        if let Some(room) = room.filter(|room| *room > end) {
            output.write(|vcd| vcd.timestamp(room))?;
            end = room;
        }
        output.write(|vcd| vcd.flush())
    })?;
    write_views(sink, path, &parts, differences, end, spot)
}

/// Writes all changes of the parts, in the order of time; returns the last time.
fn changes(
    output: &mut Output<'_>,
    parts: &mut [Open],
    subtractions: &mut [Subtraction],
    unit_fs: u64,
) -> Result<u64, WaveError> {
    for part in &mut *parts {
        part.time = part.read.next_time()?;
    }
    let mut end = 0;
    while let Some(time_fs) = parts.iter().filter_map(Open::next_fs).min() {
        let time = u64::try_from(time_fs / u128::from(unit_fs));
        let time =
            time.map_err(|_| WaveError::Option(format!("{time_fs} fs do not fit the merged file's timescale")))?;
        output.write(|vcd| vcd.timestamp(time))?;
        end = time;
        for part in &mut *parts {
            if part.next_fs() != Some(time_fs) {
                continue;
            }
            let Open { read, values, ids, .. } = &mut *part;
            read.take_in();
            for slot in &read.changed {
                values[*slot as usize] += 1;
                let now = &read.values;
                write_value(output, ids[*slot as usize], now.kind(*slot), now.get(*slot))?;
            }
            part.time = part.read.next_time()?;
        }
        for subtraction in &mut *subtractions {
            let value = |(part, slot): (usize, u32)| number(parts[part].read.values.get(slot));
            let (Some(a), Some(b)) = (value(subtraction.minuend), value(subtraction.subtrahend)) else {
                continue;
            };
            let difference = a - b;
            if subtraction.last.replace(difference.to_bits()) != Some(difference.to_bits()) {
                output.write(|vcd| write_real(vcd, subtraction.id, difference))?;
            }
        }
    }
    Ok(end)
}

fn number(value: Value<'_>) -> Option<f64> {
    match value {
        Value::Real(real) => real,
        Value::Bits { width: 1, .. } => value.integer(false).map(|n| n as f64),
        bits => bits.integer(true).map(|n| n as f64),
    }
}

/// Declares the part's scopes and signals.
fn declare(output: &mut Output<'_>, part: &mut Open) -> Result<(), WaveError> {
    let (now, ids) = (&part.read.values, &mut part.ids);
    output.write(|vcd| {
        vcd.add_module(&part.scope)?;
        let mut open: Vec<&str> = Vec::new();
        for (name, slot) in &part.signals {
            let scope: Vec<&str> = scope_of(name).split('.').filter(|s| !s.is_empty()).collect();
            let common = open.iter().zip(&scope).take_while(|(a, b)| a == b).count();
            for _ in common..open.len() {
                vcd.upscope()?;
            }
            open.truncate(common);
            for inner in &scope[common..] {
                vcd.add_module(inner)?;
                open.push(inner);
            }
            let (var_type, width) = match now.kind(*slot) {
                Kind::Bits(width) => (VarType::Wire, width),
                Kind::Real => (VarType::Real, 64),
                Kind::Text | Kind::Any(_) => (VarType::String, 1),
                Kind::Event => (VarType::Event, 1),
            };
            let reference = name.rsplit('.').next().unwrap_or(name);
            let id = &mut ids[*slot as usize];
            match *id {
                Some(id) => vcd.var_def(var_type, width, id, reference, None)?,
                None => *id = Some(vcd.add_var(var_type, width, reference, None)?),
            }
        }
        for _ in 0..=open.len() {
            vcd.upscope()?;
        }
        Ok(())
    })
}

fn subtractions(
    output: &mut Output<'_>,
    parts: &[Open],
    differences: &[DifferenceSignal<'_>],
) -> Result<Vec<Subtraction>, WaveError> {
    if differences.is_empty() {
        return Ok(Vec::new());
    }
    output.write(|vcd| vcd.add_module(DIFFERENCE))?;
    let find = |(part, name): (usize, &str)| {
        let slot = parts.get(part).and_then(|open| open.find(name));
        slot.map(|slot| (part, slot))
            .ok_or_else(|| WaveError::Option(format!("difference: part {part} has no signal `{name}`")))
    };
    let made = differences.iter().map(|difference| {
        Ok(Subtraction {
            minuend: find(difference.minuend)?,
            subtrahend: find(difference.subtrahend)?,
            id: output.write(|vcd| vcd.add_var(VarType::Real, 64, difference.name, None))?,
            last: None,
        })
    });
    let made = made.collect::<Result<Vec<_>, WaveError>>()?;
    output.write(|vcd| vcd.upscope())?;
    Ok(made)
}

fn write_value(output: &mut Output<'_>, id: Option<IdCode>, kind: Kind, value: Value<'_>) -> Result<(), WaveError> {
    let Some(id) = id else { return Ok(()) };
    let is_text = matches!(kind, Kind::Text | Kind::Any(_));
    output.write(|vcd| match value {
        Value::Bits { width, .. } if is_text => write_text(vcd, id, &format!("b{}", value.digits(width, false))),
        Value::Real(Some(real)) if is_text => write_text(vcd, id, &real.to_string()),
        Value::Text(_) => value.text().map_or(Ok(()), |text| write_text(vcd, id, &text)),
        Value::Bits { width: 0, .. } | Value::Real(None) => Ok(()),
        Value::Bits { width: 1, .. } => writeln!(vcd.writer(), "{}{id}", value.digits(1, false)),
        Value::Bits { width, .. } => writeln!(vcd.writer(), "b{} {id}", value.digits(width, false)),
        Value::Real(Some(real)) => write_real(vcd, id, real),
        Value::Event(_) => writeln!(vcd.writer(), "1{id}"),
    })
}

/// Writes a text, with the escapes of C for what a VCD cannot have in it.
fn write_text(vcd: &mut Vcd<'_>, id: IdCode, text: &str) -> io::Result<()> {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '\\' => escaped.push_str("\\\\"),
            ..=' ' | '\x7f' => escaped.push_str(&format!("\\{:03o}", u32::from(character))),
            other => escaped.push(other),
        }
    }
    writeln!(vcd.writer(), "s{escaped} {id}")
}
