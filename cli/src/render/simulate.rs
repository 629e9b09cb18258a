//! A command, or a path of two axes, on the simulated machine.

use crate::table::Table;
use posicast_flow::contour;
use posicast_flow::simulate::{Document, Simulated};
use posicast_shaper::unit::show_seconds;
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// The ringing of each axis, or the distances of each kind of shaper from the path.
pub(crate) fn simulate(document: &Simulated) -> String {
    match document {
        Simulated::Command(document) => command(document),
        Simulated::Contour(document) => path(document),
    }
}

fn command(document: &Document) -> String {
    let headings = [
        "axis",
        ">ringing unshaped",
        ">ringing shaped",
        ">largest difference from float",
        ">bound",
    ];
    let mut table = Table::new(&headings);
    for axis in &document.axes {
        let ringing = [axis.residual_displacement_unshaped, axis.residual_displacement];
        let [unshaped, shaped] = axis.unit.of_axis().show_all(ringing);
        table.row([
            axis.name.clone(),
            unshaped,
            shaped,
            format!("{:.3} LSB", axis.largest_difference_lsb),
            format!("{:.3} LSB", axis.bound_lsb),
        ]);
    }
    format!(
        "{}: {}; ringing after the command's end\n{}{}\n",
        document.name,
        counted(document.samples as u64, "sample"),
        table.text(""),
        document.wave
    )
}

fn path(document: &contour::Document) -> String {
    let unit = document.unit.of_axis();
    let rapids = if document.rapid_length > 0.0 {
        format!(" ({} of it rapids)", unit.show_round(document.rapid_length, ""))
    } else {
        String::new()
    };
    let text = format!(
        "{}: {} of axes {}, {}{rapids} in {}, {}\nlargest distance of the load from the path{}, its modes at\n",
        document.name,
        document.contour,
        document.plane,
        unit.show_round(document.length, ""),
        show_seconds(document.duration_s, 3),
        counted(document.stops as u64, "stop"),
        if rapids.is_empty() { "" } else { " while feeding" },
    );
    let factors = document
        .frequency_factors
        .map(|factor| format!(">{:.0} %", 100.0 * factor));
    let mut headings = vec!["shaper", "delays"];
    headings.extend(factors.iter().map(String::as_str));
    headings.push(">at speed");
    if !rapids.is_empty() {
        headings.push(">in rapids");
    }
    let mut table = Table::new(&headings);
    let mut reasons = String::new();
    // A smaller distance is due to rounding and the end of the settling.
    let show = |error: Option<f64>| match error {
        None => "–".to_owned(),
        Some(error) if error < 1e-10 => "0".to_owned(),
        Some(error) => unit.show(error, 3),
    };
    for shaper in &document.shapers {
        let kind = if shaper.in_file {
            format!("{}, of the file", shaper.kind)
        } else {
            shaper.kind.clone()
        };
        let delays = if shaper.equal_delays { "equal" } else { "own" };
        if let Some(reason) = &shaper.reason {
            let _ = writeln!(reasons, "  {kind}, {delays} delays: {reason}");
        }
        let mut cells = vec![kind, delays.to_owned()];
        let errors = (0..factors.len()).map(|factor| shaper.error_peak.map(|errors| errors[factor]));
        cells.extend(errors.map(show));
        cells.push(show(shaper.error_steady));
        if !rapids.is_empty() {
            cells.push(show(shaper.nominal_rapid));
        }
        table.row(cells);
    }
    text + &table.text("  ") + &reasons
}
