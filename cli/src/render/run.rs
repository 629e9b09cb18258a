//! The results of a run: the verdict alone, a summary, or all tables, each with the verdict last.
//!
//! A failed check is always shown in full, with its likely cause. A check that compared nothing is also shown, except with the
//! verdict alone.

mod closed_loop;
mod tables;

use super::files::entries;
use super::synth::area;
use crate::style;
use crate::table::Table;
use posicast_flow::run::{Check, Document};
use posicast_flow::text::percent;
use posicast_synth::yosys::Estimate;
use std::fmt::Write;
use std::path::PathBuf;

/// The result in about ten lines: a line per axis, the area, the number of checks.
pub(crate) fn summary(document: &Document) -> String {
    let mut text = format!("{}{}", heading(document), axes(document));
    text += &document.synth.as_ref().map_or_else(String::new, needed);
    text += &document
        .stage
        .as_ref()
        .map_or_else(String::new, closed_loop::error_tables);
    text += &checks(document, |check| !check.passed || check.is_open());
    let count = |verdict: fn(&Check) -> bool| document.checks.iter().filter(|check| verdict(check)).count();
    let (failed, open) = (count(|check| !check.passed), count(Check::is_open));
    let _ = write!(text, "checks: {} ok", document.checks.len() - failed - open);
    for (number, word) in [(open, "open"), (failed, "failed")] {
        if number > 0 {
            let _ = write!(text, ", {number} {word}");
        }
    }
    text.push('\n');
    text + &files(document) + &sentence(document)
}

/// The verdict alone, and failed checks.
pub(crate) fn verdict(document: &Document) -> String {
    checks(document, |check| !check.passed) + &sentence(document)
}

/// All tables and checks.
pub(crate) fn everything(document: &Document) -> String {
    let mut parts = vec![
        heading(document),
        tables::shapers(document),
        tables::comparison(document),
    ];
    parts.extend(document.stage.as_ref().map(closed_loop::figures));
    parts.extend(document.synth.as_ref().map(area));
    parts.push(checks(document, |_| true));
    parts.push(files(document) + &sentence(document));
    parts.join("\n")
}

/// Name, clocks and simulator.
fn heading(document: &Document) -> String {
    let clocking = &document.design.clocking;
    format!(
        "{}: {} MHz clock, {} Hz samples, coefficients with {} fraction bits\nsimulator: {}; seed {}\n",
        document.name,
        clocking.clock_hz / 1e6,
        clocking.sample_hz,
        clocking.coefficient_fraction,
        document.tool,
        document.seed,
    )
}

/// A line per axis: its shaper and the vibration with it, in the closed loop if there is one.
fn axes(document: &Document) -> String {
    let mut headings = vec!["axis", "shaper", ">residual, %", ">ringing unshaped", ">shaped"];
    if document.stage.is_some() {
        headings.push(">tracking, peak");
    }
    let dash = || "-".to_owned();
    let mut table = Table::new(&headings);
    for (index, (axis, design)) in document.axes.iter().zip(&document.design.axes).enumerate() {
        let unit = axis.unit.of_axis();
        let residual = design.quantised.modes.iter().map(|mode| mode.residual).reduce(f64::max);
        let moved = document.stage.as_ref().map(|stage| stage.axes.get(index));
        let ringing = match moved {
            Some(moved) => moved.and_then(|moved| moved.ringing),
            None => Some([axis.residual_displacement_unshaped, axis.residual_displacement]),
        };
        let ringing = ringing.map_or_else(|| [dash(), dash()], |figures| unit.show_all(figures));
        let tracking = moved.map(|moved| {
            let tracking = moved.and_then(|moved| moved.tracking.as_ref());
            tracking.map_or_else(dash, |tracking| unit.show(tracking.peak, 3))
        });
        let cells = [
            axis.name.clone(),
            design.kind.clone(),
            residual.map_or_else(dash, percent),
        ];
        table.row(cells.into_iter().chain(ringing).chain(tracking));
    }
    table.text("  ")
}

/// Area of the shapers compared with the device.
fn needed(estimate: &Estimate) -> String {
    let (total, device) = (&estimate.total, &estimate.device);
    format!(
        "area of the shapers on {}, estimated: {} of {} cells, {} of {} registers, {} of {} memory bits, {} of {} multipliers\n",
        device.name,
        total.cells,
        device.cells,
        total.registers,
        device.registers,
        total.memory_bits,
        device.memory_bits,
        total.multipliers,
        device.multipliers
    )
}

/// Lines for the checks to show; each failed one comes with its likely cause.
fn checks(document: &Document, shown: impl Fn(&Check) -> bool) -> String {
    let mut text = String::new();
    for check in document.checks.iter().filter(|check| shown(check)) {
        let verdict = match (check.passed, check.is_open()) {
            (false, _) => style::bad(check.verdict()),
            (true, true) => style::doubtful(check.verdict()),
            (true, false) => style::good(check.verdict()),
        };
        let _ = writeln!(text, "{verdict}  {}: {}", check.name, check.detail);
        if let Some(advice) = check.advice() {
            let [first, second] = advice.remedies;
            let _ = writeln!(
                text,
                "        likely cause: {}\n        try: {first}\n        or:  {second}",
                advice.cause
            );
        }
    }
    text
}

/// Number of files and their folder.
fn files(document: &Document) -> String {
    format!(
        "{} files written to {}: {}\n",
        document.files.len(),
        document.folder.display(),
        entries(document.files.iter().map(PathBuf::as_path)).join(", ")
    )
}

/// The verdict as a sentence.
fn sentence(document: &Document) -> String {
    let sentence = document.sentence();
    let word = match sentence.word {
        "PASS" => style::passed(sentence.word),
        word => style::bad(word),
    };
    let remark = sentence.remark.map_or_else(String::new, |remark| format!("{remark}\n"));
    format!("{word}{}\n{remark}", sentence.rest)
}
