//! One known move of an axis, with its shaper and with a jerk time that is a period of a mode.

use crate::table::Table;
use posicast_flow::design::{ComparedMove, MoveTimes};
use std::fmt::Write;

/// The ways to make the move, and the better one.
pub(super) fn compared(of: &ComparedMove) -> String {
    let mut table = Table::new(&["", ">command ms", ">shaper ms", ">total ms", ">residual", ""]);
    let mut row = |name: String, times: &MoveTimes, is_better: bool| {
        let milliseconds = |time_s: f64| format!("{:.3}", 1e3 * time_s);
        table.row([
            name,
            milliseconds(times.command_s),
            milliseconds(times.shaper_s),
            milliseconds(times.total_s),
            of.unit.show(times.residual, 3),
            if is_better { "better" } else { "" }.into(),
        ]);
    };
    row(
        "fastest move and shaper".into(),
        &of.shaped,
        of.better == Some("shaper"),
    );
    for (index, period) in of.by_period.iter().enumerate() {
        let name = format!("jerk time of {:.3} ms, mode {}", 1e3 * period.jerk_s, period.mode);
        row(name, &period.times, of.better_period == Some(index));
    }
    let mut text = format!(
        "\naxis {}: a move of {} within its limits\n{}",
        of.axis,
        of.unit.as_in_file(of.distance, ""),
        table.text("  ")
    );
    if let Some(tolerated) = of.tolerated_residual {
        let _ = writeln!(
            text,
            "  residual: the largest amplitude of a mode at the end of the move, at any frequency examined in its band; the tolerance is {}",
            of.unit.show(tolerated, 3)
        );
    }
    if of.better.is_none() {
        text += "  neither keeps the tolerance: choose another kind or a larger tolerance\n";
    }
    text
}
