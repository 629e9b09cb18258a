//! The closed loop of a run: the moves of the axes, the circle or the path, and the schedule.

use crate::table::Table;
use posicast_flow::run::{DrivenCircle, FollowedPath, PathError, StageFigures};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::show_seconds;
use posicast_testbench::wording::counted;
use std::fmt::Write;

/// All figures of the closed loop.
pub(super) fn figures(stage: &StageFigures) -> String {
    let mut table = Table::new(&[
        "axis",
        ">tracking, peak",
        ">rms",
        ">rest error",
        ">ringing unshaped",
        ">shaped",
        ">machine -10 %",
        ">machine +10 %",
    ]);
    for axis in &stage.axes {
        let (Some(tracking), Some(offset)) = (&axis.tracking, axis.offset) else {
            continue;
        };
        let ringing = [
            axis.residual_unshaped,
            axis.residual,
            axis.residual_minus_10_percent,
            axis.residual_plus_10_percent,
        ];
        let [unshaped, shaped, slower, faster] = ringing.map(|figure| figure.unwrap_or(f64::NAN));
        let numbers = [tracking.peak, tracking.rms, offset, unshaped, shaped, slower, faster];
        table.row(std::iter::once(axis.name.clone()).chain(axis.unit.of_axis().show_all(numbers)));
    }
    let mut text = format!(
        "Closed loop: all axes move at once on the simulated machine, {}\n{}",
        moves(stage),
        table.text("  ")
    );
    text += &error_tables(stage);
    match (&stage.contour, &stage.circle) {
        (Some(path), _) => text += &contour(path, stage),
        (None, Some(driven)) => text += &circle(driven, stage),
        (None, None) => {
            let reason = stage.no_circle.as_deref().unwrap_or_default();
            let _ = writeln!(text, "\nNo circle is driven: {reason}");
        }
    }
    let schedule = &stage.schedule;
    let _ = writeln!(
        text,
        "\nSchedule of a tick of {} clocks\n  {}",
        schedule.tick_clocks, schedule.steps
    );
    text
}

/// A line for each axis that has an error table.
pub(super) fn error_tables(stage: &StageFigures) -> String {
    let mut text = String::new();
    for axis in &stage.axes {
        if let Some(of) = &axis.error_table {
            let rests = [of.offset_with.abs(), of.offset_without.abs()];
            let [with, without] = axis.unit.of_axis().show_all(rests);
            let _ = writeln!(
                text,
                "  axis {}, homed: the load rests {with} from its target with its error table, {without} without",
                axis.name
            );
        }
    }
    text
}

/// Distance and speed of each axis's move.
fn moves(stage: &StageFigures) -> String {
    let texts = stage.axes.iter().filter_map(|axis| {
        let unit = axis.unit.of_axis();
        let [distance, speed] = axis.distance_and_speed?;
        let (distance, speed) = (unit.show_round(distance, ""), unit.show_round(speed, "/s"));
        Some(format!("{} by {distance} at up to {speed}", axis.name))
    });
    texts.collect::<Vec<_>>().join(", ")
}

/// The unit of circle and path: that of the first axis.
fn unit_of_plane(stage: &StageFigures) -> AxisUnit {
    let first = stage.axes.first();
    first.map_or(AxisUnit::default(), |axis| axis.unit.of_axis())
}

fn circle(circle: &DrivenCircle, stage: &StageFigures) -> String {
    let unit = unit_of_plane(stage);
    let mut table = Table::new(&["tap tables", ">distance from the circle, peak", ">rms"]);
    let mut row = |name: &str, error: &PathError| {
        let [peak, rms] = unit.show_all([error.peak, error.rms]);
        table.row([name.to_owned(), peak, rms]);
    };
    row("each with its own delay", &circle.own_delays);
    if let Some(equal) = &circle.equal_delays {
        row("delays made equal", equal);
    }
    format!(
        "\nCircle of axes {}, radius {} at {}\n{}{}",
        stage.plane,
        unit.show_round(circle.radius, ""),
        unit.show_round(circle.speed, "/s"),
        table.text("  "),
        unequal(circle.unequal.as_deref())
    )
}

fn contour(path: &FollowedPath, stage: &StageFigures) -> String {
    let unit = unit_of_plane(stage);
    let has_rapids = path.rapid_length > 0.0;
    let mut headings = vec!["tap tables", ">distance from the path, peak", ">rms"];
    if has_rapids {
        headings.push(">in rapids, peak");
    }
    let dash = || "–".to_owned();
    let mut table = Table::new(&headings);
    for row in &path.rows {
        let error = row.error.as_ref().map(|error| unit.show_all([error.peak, error.rms]));
        let [peak, rms] = error.unwrap_or_else(|| [dash(), dash()]);
        let rapid = has_rapids.then(|| row.rapid_peak.map_or_else(dash, |peak| unit.show(peak, 3)));
        table.row([row.tables.to_owned(), peak, rms].into_iter().chain(rapid));
    }
    format!(
        "\nContour {} of axes {}: {} in {}, {}\n{}{}",
        path.path,
        stage.plane,
        unit.show_round(path.length, ""),
        show_seconds(path.duration_s, 3),
        counted(path.stops as u64, "stop"),
        table.text("  "),
        unequal(path.unequal.as_deref())
    )
}

/// Why delays cannot be made equal.
fn unequal(reason: Option<&str>) -> String {
    reason.map_or_else(String::new, |reason| {
        format!("  delays cannot be made equal: {reason}\n")
    })
}
