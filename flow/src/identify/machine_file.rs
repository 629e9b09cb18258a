//! Writes a machine file with the modes that were found.

use super::document::WrittenMachine;
use super::findings::Findings;
use crate::failure::Failure;
use crate::machine;
use crate::template::{MachineDraft, MachineKind, to_measure};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::trimmed;
use std::path::Path;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, value};

/// Digits of a frequency and of a damping ratio: more than any log determines.
const DIGITS: usize = 6;

/// A machine file with the modes of a log.
pub(super) struct Written {
    pub(super) text: String,
    /// Unit of the axis that has the modes.
    pub(super) unit: AxisUnit,
    /// The axis from which the other values were copied, if the axis was added.
    pub(super) copied_from: Option<String>,
}

impl Written {
    /// The same in the document, as the file at `path`.
    pub(super) fn at(self, path: &Path) -> WrittenMachine {
        WrittenMachine {
            path: path.to_owned(),
            text: self.text,
            copied_from: self.copied_from,
        }
    }
}

/// The template, with only the axis that was measured.
pub(super) fn from_template(
    kind: MachineKind,
    path: &Path,
    axis: Option<&str>,
    findings: &Findings,
) -> Result<Written, Failure> {
    let draft = MachineDraft::new(kind, path);
    let mut document = parsed(draft.text(), path)?;
    let axes = axes(&mut document, path)?;
    let wanted = axis.or(findings.axis.as_deref());
    let index = wanted.and_then(|name| position(axes, name)).unwrap_or(0);
    let mut measured = axes.iter().nth(index).cloned().unwrap_or_default();
    if let Some(name) = wanted {
        put(&mut measured, "name", name.into());
    }
    fill(&mut measured, findings);
    let mut only = ArrayOfTables::new();
    only.push(measured);
    document.insert("axis", Item::ArrayOfTables(only));
    checked(without_stale_step(document.to_string()), path, 0)
}

/// Replaces the first step in the head of a template if the log has answered all of it.
fn without_stale_step(text: String) -> String {
    const STEP: &str = "Measure what is marked MEASURE and write it in";
    if to_measure(&text).is_empty() {
        text.replace(
            STEP,
            "The modes are from the log, with their 95 % intervals; check the other values",
        )
    } else {
        text
    }
}

/// Puts the modes into one of the axes of an existing machine file. Adds the axis if the file has only the other axis of the pair, as
/// `identify` writes it.
pub(super) fn into_existing(path: &Path, axis: Option<&str>, findings: &Findings) -> Result<Written, Failure> {
    let text = machine::read(path)?.text;
    let mut document = parsed(&text, path)?;
    let axes = axes(&mut document, path)?;
    let names: Vec<String> = (0..axes.len()).filter_map(|n| name(axes, n)).collect();
    let wanted = axis.or(findings.axis.as_deref());
    let index = match wanted {
        Some(wanted) => position(axes, wanted),
        None if axes.len() == 1 => Some(0),
        None => None,
    };
    if let (None, Some(wanted), [only]) = (index, wanted, &names[..])
        && is_pair(only, wanted)
    {
        let index = add_beside(axes, wanted, wanted < only.as_str(), findings);
        let written = checked(document.to_string(), path, index)?;
        return Ok(Written {
            copied_from: Some(only.clone()),
            ..written
        });
    }
    let Some((index, target)) = index.and_then(|index| Some((index, axes.get_mut(index)?))) else {
        let what = wanted.map_or("the log does not name its axis".into(), |wanted| {
            format!("no axis \"{wanted}\"")
        });
        return Err(Failure::input(format!("{}: {what}", path.display())).with_help(format!(
            "--axis names the axis that the log is of: {}",
            names.join(", ")
        )));
    };
    fill(target, findings);
    checked(document.to_string(), path, index)
}

/// Whether two axes are those of a machine that `posicast new` writes.
fn is_pair(one: &str, other: &str) -> bool {
    matches!((one, other), ("x", "y") | ("y", "x"))
}

/// Adds an axis with the values of the only other one, except for modes and shaper; returns its index among the axes.
fn add_beside(axes: &mut ArrayOfTables, wanted: &str, is_first: bool, findings: &Findings) -> usize {
    let mut added = axes.iter().next().cloned().unwrap_or_default();
    put(&mut added, "name", wanted.into());
    fill(&mut added, findings);
    let mut both: Vec<Table> = axes.iter().cloned().collect();
    both.insert(if is_first { 0 } else { both.len() }, added);
    axes.clear();
    for mut axis in both {
        // Tables are written in the order of their places in the file that was read; here two axes would share a place.
        without_place(&mut axis);
        axes.push(axis);
    }
    if is_first { 0 } else { axes.len() - 1 }
}

fn without_place(table: &mut Table) {
    table.set_position(None);
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(inner) => without_place(inner),
            Item::ArrayOfTables(inner) => inner.iter_mut().for_each(without_place),
            Item::None | Item::Value(_) => {}
        }
    }
}

fn parsed(text: &str, path: &Path) -> Result<DocumentMut, Failure> {
    text.parse()
        .map_err(|error: toml_edit::TomlError| Failure::input(format!("{}: {error}", path.display())))
}

fn axes<'a>(document: &'a mut DocumentMut, path: &Path) -> Result<&'a mut ArrayOfTables, Failure> {
    let axes = document.get_mut("axis").and_then(Item::as_array_of_tables_mut);
    axes.ok_or_else(|| {
        Failure::input(format!("{}: the axes are not written as tables", path.display()))
            .with_help("write each axis as a table of its own: [[axis]]")
    })
}

fn name(axes: &ArrayOfTables, index: usize) -> Option<String> {
    axes.get(index)?.get("name")?.as_str().map(str::to_owned)
}

fn position(axes: &ArrayOfTables, wanted: &str) -> Option<usize> {
    (0..axes.len()).find(|&index| name(axes, index).as_deref() == Some(wanted))
}

/// Replaces a value and keeps the comment after it.
fn put(table: &mut Table, key: &str, new: toml_edit::Value) {
    let decor = table.get(key).and_then(Item::as_value).map(|old| old.decor().clone());
    let mut new = new;
    if let Some(decor) = decor {
        *new.decor_mut() = decor;
    }
    table.insert(key, Item::Value(new));
}

/// Writes modes and shaper into an axis.
fn fill(axis: &mut Table, findings: &Findings) {
    let mut modes = ArrayOfTables::new();
    for found in &findings.modes {
        let mut mode = Table::new();
        let (frequency, damping) = (found.frequency_interval_hz(), found.damping_interval());
        mode.insert(
            "frequency_hz",
            noted(found.mode.frequency_hz, frequency.low, frequency.high),
        );
        mode.insert("damping", noted(found.mode.damping, damping.low, damping.high));
        if findings.is_motor_held {
            mode.insert("measured", value("motor_held"));
        }
        if findings.modes.len() > 1 {
            mode.insert("participation", value(rounded(found.participation)));
        }
        modes.push(mode);
    }
    axis.insert("mode", Item::ArrayOfTables(modes));
    if let Some(best) = findings.recommended.first() {
        let mut shaper = Table::new();
        shaper.insert("kind", value(best.kind.name()));
        if best.kind.name().ends_with("ei") {
            shaper.insert("tolerance", value(rounded(best.tolerance)));
        }
        axis.insert("shaper", Item::Table(shaper));
    }
}

fn rounded(number: f64) -> f64 {
    trimmed(number, DIGITS).parse().unwrap_or(number)
}

/// A number with its interval in a comment.
fn noted(number: f64, low: f64, high: f64) -> Item {
    let mut item = toml_edit::Value::from(rounded(number));
    let comment = format!("  # measured: 95 % interval {} … {}", trimmed(low, 5), trimmed(high, 5));
    item.decor_mut().set_suffix(comment);
    Item::Value(item)
}

/// The text, if posicast accepts it as a machine file, with the unit of its axis `index`.
fn checked(text: String, path: &Path, index: usize) -> Result<Written, Failure> {
    let machine = machine::parse(path, &text)?;
    let unit = machine.axes.get(index).map(|axis| axis.unit).unwrap_or_default();
    Ok(Written {
        text,
        unit,
        copied_from: None,
    })
}
