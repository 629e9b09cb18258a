//! The table family of an axis whose modes move.

use crate::table::Table;
use posicast_flow::design::DesignFamily;
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::{short, trimmed};
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// Digits of a value in a table.
const DIGITS: usize = 5;

/// The tables, and how fast the variable may change.
pub(super) fn tables(family: &DesignFamily, unit: AxisUnit) -> String {
    let [low, high] = family.range.map(|value| {
        if family.is_position {
            unit.as_in_file(value, "")
        } else {
            short(value)
        }
    });
    let show = |value: f64| {
        if family.is_position {
            trimmed(unit.from_si(value), DIGITS)
        } else {
            trimmed(value, DIGITS)
        }
    };
    let count = family.tables.len();
    let mut text = format!(
        "\n  the modes move with {}: {} from {low} to {high}",
        family.variable,
        counted(count as u64, "table"),
    );
    if family.needed < count {
        let _ = write!(text, "; {} would cover that", family.needed);
    }
    text.push('\n');
    let variable = if family.is_position {
        format!(">{} {}", family.variable, unit.symbol())
    } else {
        format!(">{}", family.variable)
    };
    let headings = [
        "table",
        &variable,
        ">mode Hz",
        "within tolerance",
        ">down below",
        ">up above",
        ">taps",
        ">delay ms",
    ];
    let mut table = Table::new(&headings);
    for (index, member) in family.tables.iter().enumerate() {
        let threshold = |value: Option<f64>| value.map_or_else(String::new, show);
        let modes = member.modes.iter().map(|mode| trimmed(mode.frequency_hz, DIGITS));
        let nominal = if index == family.nominal { " ROM" } else { "" };
        table.row([
            format!("{index}{nominal}"),
            show(member.value),
            modes.collect::<Vec<_>>().join(", "),
            format!("{} … {}", show(member.covers[0]), show(member.covers[1])),
            threshold(member.down),
            threshold(member.up),
            member.taps.len().to_string(),
            format!("{:.4}", member.delay_s * 1e3),
        ]);
    }
    text += &table.text("  ");
    if let Some(fastest) = family.fastest_per_s {
        let per_s = if family.is_position {
            unit.show_round(fastest, "/s")
        } else {
            format!("{} per s", trimmed(fastest, DIGITS))
        };
        let _ = writeln!(
            text,
            "  while {} changes by at most {per_s}, the table in use is within tolerance",
            family.variable
        );
    }
    text
}
