//! `posicast design --move`: one known move behind each axis's shaper, compared with a move whose jerk time is a period of a mode.

use super::DesignReport;
use crate::failure::Failure;
use crate::moves::PerAxis;
use crate::text::Table;
use posicast_machine::machine_file::AxisSection;
use posicast_machine::motion::{AxisMove, BetterMove, MoveComparison, MoveFigures, compare_move};
use posicast_shaper::analysis::tap_impulses;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// One move of an axis.
pub(super) struct MoveReport<'a> {
    axis: &'a AxisSection,
    distance: f64,
    found: MoveComparison,
}

/// The moves of all axes that the option names.
pub(super) fn of_axes<'a>(report: &DesignReport<'a>, distance: &PerAxis) -> Result<Vec<MoveReport<'a>>, Failure> {
    distance.only_for(report.machine, "--move")?;
    let mut moves = Vec::new();
    for (axis, tables) in report.machine.axes.iter().zip(&report.design.axes) {
        let Some(figure) = distance.of(axis) else {
            continue;
        };
        let given = AxisMove::new(axis, &report.machine.fixed_point, Some(figure), None);
        let given = given.map_err(|error| Failure::input(format!("--move, axis `{}`: {error}", axis.name)))?;
        let taps = tap_impulses(&tables.table, report.design.sample_hz);
        let found = compare_move(axis, &taps, given.distance, given.velocity).ok_or_else(|| {
            Failure::input(format!("--move, axis `{}`: no move within the limits", axis.name))
                .with_help("check the axis's limits")
        })?;
        moves.push(MoveReport {
            axis,
            distance: given.distance,
            found,
        });
    }
    Ok(moves)
}

impl MoveReport<'_> {
    pub(super) fn text(&self) -> String {
        let unit = self.axis.unit;
        let mut table = Table::new(&["", ">command ms", ">shaper ms", ">total ms", ">residual", ""]);
        let better = self.found.better();
        let mut row = |name: String, figures: &MoveFigures, way: BetterMove| {
            let milliseconds = |time_s: f64| format!("{:.3}", 1e3 * time_s);
            table.row([
                name,
                milliseconds(figures.command_s),
                milliseconds(figures.shaper_s),
                milliseconds(figures.total_s()),
                unit.show(figures.residual, 3),
                if better == Some(way) { "better" } else { "" }.into(),
            ]);
        };
        row("fastest move and shaper".into(), &self.found.shaped, BetterMove::Shaped);
        for (index, found) in self.found.by_period.iter().enumerate() {
            let name = format!("jerk time of {:.3} ms, mode {}", 1e3 * found.jerk_s, found.mode + 1);
            row(name, &found.figures, BetterMove::ByPeriod(index));
        }
        let mut text = format!(
            "\naxis {}: a move of {} within its limits\n{}",
            self.axis.name,
            unit.as_in_file(self.distance, ""),
            table.text("  ")
        );
        if self.found.tolerated.is_finite() {
            let _ = writeln!(
                text,
                "  residual: the largest amplitude of a mode at the end of the move, at any frequency examined in its band; the tolerance is {}",
                unit.show(self.found.tolerated, 3)
            );
        }
        if better.is_none() {
            text += "  neither keeps the tolerance: choose another kind or a larger tolerance\n";
        }
        text
    }

    pub(super) fn json(&self) -> ComparedMove {
        let better = self.found.better();
        ComparedMove {
            axis: self.axis.name.clone(),
            distance: self.distance,
            shaped: Way::new(&self.found.shaped),
            by_period: self
                .found
                .by_period
                .iter()
                .map(|found| Period {
                    mode: found.mode + 1,
                    jerk_s: found.jerk_s,
                    velocity: found.peaks[0],
                    acceleration: found.peaks[1],
                    jerk: found.peaks[2],
                    way: Way::new(&found.figures),
                })
                .collect(),
            tolerated_residual: Some(self.found.tolerated).filter(|tolerated| tolerated.is_finite()),
            better: better.map(|way| match way {
                BetterMove::Shaped => "shaper",
                BetterMove::ByPeriod(_) => "period",
            }),
        }
    }
}

/// A move in `design --json`, in m or rad; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
pub(super) struct ComparedMove {
    axis: String,
    distance: f64,
    shaped: Way,
    by_period: Vec<Period>,
    tolerated_residual: Option<f64>,
    /// `shaper`, `period`, or null where both leave more than is tolerated.
    better: Option<&'static str>,
}

#[derive(Serialize, JsonSchema)]
struct Period {
    mode: usize,
    jerk_s: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    #[serde(flatten)]
    way: Way,
}

#[derive(Serialize, JsonSchema)]
struct Way {
    command_s: f64,
    shaper_s: f64,
    total_s: f64,
    residual: f64,
}

impl Way {
    fn new(figures: &MoveFigures) -> Self {
        Self {
            command_s: figures.command_s,
            shaper_s: figures.shaper_s,
            total_s: figures.total_s(),
            residual: figures.residual,
        }
    }
}
