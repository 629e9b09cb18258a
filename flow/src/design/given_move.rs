//! `posicast design --move`: one known move behind each axis's shaper, compared with a move whose jerk time is a period of a mode.

use super::DesignReport;
use crate::failure::Failure;
use crate::moves::PerAxis;
use posicast_machine::machine_file::AxisSection;
use posicast_machine::motion::{AxisMove, BetterMove, MoveComparison, MoveFigures, compare_move};
use posicast_machine::unit::AxisUnit;
use posicast_shaper::analysis::tap_impulses;
use schemars::JsonSchema;
use serde::Serialize;

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
    pub(super) fn json(&self) -> ComparedMove {
        let better = self.found.better();
        ComparedMove {
            axis: self.axis.name.clone(),
            unit: self.axis.unit,
            distance: self.distance,
            shaped: MoveTimes::new(&self.found.shaped),
            by_period: self
                .found
                .by_period
                .iter()
                .map(|found| MoveByPeriod {
                    mode: found.mode + 1,
                    jerk_s: found.jerk_s,
                    velocity: found.peaks[0],
                    acceleration: found.peaks[1],
                    jerk: found.peaks[2],
                    times: MoveTimes::new(&found.figures),
                })
                .collect(),
            tolerated_residual: Some(self.found.tolerated).filter(|tolerated| tolerated.is_finite()),
            better: better.map(|way| match way {
                BetterMove::Shaped => "shaper",
                BetterMove::ByPeriod(_) => "period",
            }),
            better_period: match better {
                Some(BetterMove::ByPeriod(index)) => Some(index),
                _ => None,
            },
        }
    }
}

/// A move in `design --json`, in m or rad; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
pub struct ComparedMove {
    /// Name of the axis.
    pub axis: String,
    /// Unit of the axis.
    #[serde(skip)]
    pub unit: AxisUnit,
    /// Distance of the move.
    pub distance: f64,
    /// The fastest move and the shaper.
    pub shaped: MoveTimes,
    /// Moves whose jerk time is a period of a mode.
    pub by_period: Vec<MoveByPeriod>,
    /// Largest residual that is tolerated; null without a mode.
    pub tolerated_residual: Option<f64>,
    /// `shaper`, `period`, or null where both leave more than is tolerated.
    pub better: Option<&'static str>,
    /// Index of the better move in `by_period`, from 0.
    #[serde(skip)]
    pub better_period: Option<usize>,
}

/// A move whose jerk time is a period of a mode.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Period")]
pub struct MoveByPeriod {
    /// The mode.
    pub mode: usize,
    /// Its period.
    pub jerk_s: f64,
    /// Largest velocity.
    pub velocity: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk.
    pub jerk: f64,
    /// Its duration, and what it leaves.
    #[serde(flatten)]
    pub times: MoveTimes,
}

/// The duration of a move, and what it leaves.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Way")]
pub struct MoveTimes {
    /// Duration of the command.
    pub command_s: f64,
    /// Duration of the shaper.
    pub shaper_s: f64,
    /// Their sum.
    pub total_s: f64,
    /// Largest amplitude of a mode at the end of the move.
    pub residual: f64,
}

impl MoveTimes {
    fn new(figures: &MoveFigures) -> Self {
        Self {
            command_s: figures.command_s,
            shaper_s: figures.shaper_s,
            total_s: figures.total_s(),
            residual: figures.residual,
        }
    }
}
