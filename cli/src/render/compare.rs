//! The kinds of shaper on the axes of one machine.

use crate::table::Table;
use posicast_flow::compare::{ComparedKind, Document, KindsOfAxis};
use posicast_flow::text::percent;
use std::fmt::Write;

/// A table of kinds for each axis, and what its marks mean.
pub(crate) fn compare(document: &Document) -> String {
    let mut text = format!(
        "{}: shapers for modes off by up to ±{} %\n",
        document.name, document.band_percent
    );
    for axis in &document.axes {
        let _ = writeln!(text, "\naxis {}{}", axis.name, tolerance(axis));
        let mut table = Table::new(&[
            "",
            "kind",
            ">duration ms",
            ">worst residual %",
            ">least there %",
            ">taps",
            ">partial sums",
            ">delay ms",
            "",
        ]);
        for kind in &axis.kinds {
            table.row([
                if kind.pareto { "*" } else { "" }.into(),
                kind.kind.clone(),
                format!("{:.4}", 1e3 * kind.duration_s),
                percent(kind.worst_residual),
                kind.least_residual.map_or_else(String::new, percent),
                kind.taps.to_string(),
                format!("{:.3} … {:.3}", kind.partial_sum_min, kind.partial_sum_max),
                format!("{:.4}", 1e3 * kind.delay_s),
                remark(kind).into(),
            ]);
        }
        text += &table.text("  ");
        for missing in &axis.missing {
            let _ = writeln!(text, "  no {}: {}", missing.kind, missing.reason);
        }
    }
    text + "\n* no other kind is better in one of duration, worst residual and taps, and at least as good in the others\n\
            optimal: designed for this band and these tolerances, without negative amplitudes and with a step within −1 … 1\n\
            least there: residual of the best shaper without negative amplitudes in the duration of a smooth kind\n"
}

/// The tolerances of an axis's modes, by which its kinds are judged.
fn tolerance(axis: &KindsOfAxis) -> String {
    let texts: Vec<String> = axis.tolerances.iter().map(|tolerance| percent(*tolerance)).collect();
    match texts.split_first() {
        None => String::new(),
        Some((first, others)) if others.iter().all(|other| other == first) => format!(", tolerance {first} %"),
        Some(_) => format!(", tolerances {} %", texts.join(", ")),
    }
}

fn remark(kind: &ComparedKind) -> &'static str {
    match (kind.in_file, kind.shortest) {
        (true, true) => "as in the file; the shortest that keeps the tolerance",
        (true, false) => "as in the file",
        (false, true) => "the shortest that keeps the tolerance",
        (false, false) => "",
    }
}
