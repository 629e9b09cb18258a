//! The figures of the closed loop.

use super::ClosedLoop;
use super::contours::{Contours, FollowedPath};
use crate::machine::plane_name;
use crate::run::gain::{Gain, GainSource, Track};
use crate::run::pictures::slowest_period_s;
use crate::text::UnitDocument;
use posicast_blocks::stage::StageSchedule;
use posicast_closed_loop::stage_run::{Compared, Moved};
use posicast_machine::plant::axis::ErrorFigures;
use posicast_machine::unit::AxisUnit;
use schemars::JsonSchema;
use serde::Serialize;

impl ClosedLoop<'_> {
    /// Clocks of the Verilog beside its model in the move, and values that differed; `None` without Verilator.
    pub(crate) fn side_by_side(&self) -> Option<[u64; 2]> {
        let compared = self.compared.as_ref()?;
        Some([compared.clocks, compared.mismatches])
    }

    /// Vibration of an axis's load without its shaper and with it, in m or rad; `None` if a move was not made to its end.
    pub(crate) fn ringing(&self, axis: usize) -> Option<[f64; 2]> {
        let of = |moved: &Moved| match moved.trouble {
            Some(_) => None,
            None => Some(moved.axes.get(axis)?.residual.peak),
        };
        Some([of(&self.unshaped)?, of(&self.shaped)?])
    }

    /// What an axis's shaper costs and gains in the move; `None` if a move was not made to its end.
    pub(crate) fn gain(&self, index: usize) -> Option<Gain> {
        let axis = self.machine.axes.get(index)?;
        let count = 1.0 / axis.loop_counts_per_unit();
        let of = |moved: &Moved| {
            if moved.trouble.is_some() {
                return None;
            }
            let samples = moved.samples.get(index)?;
            // The ringing is relative to the rest position of the load.
            let rest = samples.last()?.load - moved.ringing(index).last()?;
            let command: Vec<f64> = samples.iter().map(|sample| sample.command).collect();
            let shaped: Vec<f64> = samples.iter().map(|sample| sample.shaped).collect();
            let off: Vec<f64> = samples.iter().map(|sample| sample.load - rest).collect();
            Some((command, shaped, off))
        };
        let (unshaped, shaped) = (of(&self.unshaped)?, of(&self.shaped)?);
        let [unshaped, shaped] = [&unshaped, &shaped].map(|(command, shaped, off)| Track { command, shaped, off });
        Some(Gain::new(
            GainSource::ClosedLoop,
            count,
            self.machine.clock.sample_hz,
            slowest_period_s(axis),
            &unshaped,
            &shaped,
        ))
    }

    /// The unit of the circle: that of its first axis.
    pub(super) fn circle_unit(&self) -> AxisUnit {
        self.machine.axes.first().map_or(AxisUnit::default(), |axis| axis.unit)
    }

    /// `stage` in `run --json` and `report.json`.
    pub(crate) fn json(&self) -> StageFigures {
        let axes = self.machine.axes.iter().enumerate();
        let residual = |moved: &Moved, index: usize| moved.axes.get(index).map(|axis| axis.residual.peak);
        let config = &self.stage.of_machine.config;
        StageFigures {
            side_by_side: self.compared.clone(),
            axes: axes
                .map(|(index, axis)| {
                    let figures = self.shaped.axes.get(index);
                    MovedAxis {
                        name: axis.name.clone(),
                        unit: UnitDocument::new(axis.unit),
                        distance_and_speed: self.moves.get(index).map(|of| [of.distance, of.velocity]),
                        tracking: figures.map(|figures| figures.tracking.into()),
                        offset: figures.map(|figures| figures.offset),
                        residual_unshaped: residual(&self.unshaped, index),
                        residual: residual(&self.shaped, index),
                        residual_minus_10_percent: residual(&self.slower, index),
                        residual_plus_10_percent: residual(&self.faster, index),
                        lost_steps: axis.steps.and(self.shaped.lost_steps.get(index).copied()),
                        ringing: self.ringing(index),
                        error_table: self.compensated().find(|(place, _)| *place == index).map(|(_, of)| {
                            Compensation {
                                offset_without: of.without,
                                offset_with: of.with,
                                offset_allowed: of.allowed,
                            }
                        }),
                    }
                })
                .collect(),
            plane: plane_name(self.machine),
            circle: self.circles.as_ref().ok().map(|circles| DrivenCircle {
                axes: self.machine.axes.iter().take(2).map(|axis| axis.name.clone()).collect(),
                radius: circles.circle.radius,
                speed: circles.circle.speed,
                own_delays: circles.apart.error.into(),
                equal_delays: circles.matched.as_ref().ok().map(|circled| circled.error.into()),
                unequal: circles.matched.as_ref().err().cloned(),
            }),
            no_circle: self.circles.as_ref().err().cloned(),
            contour: self.contours.as_ref().map(Contours::json),
            schedule: TickSchedule {
                tick_clocks: config.tick.tick_clocks(),
                control_clocks: config.timing().control_clocks(),
                duty_clocks: config.timing().duty_clocks(),
                steps: config.timing(),
            },
        }
    }
}

/// The closed loop: the stage on its simulated machine. Lengths are in m or rad.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "ClosedLoop")]
pub struct StageFigures {
    /// The Verilog beside its model; null without Verilator.
    pub side_by_side: Option<Compared>,
    /// The moves of the axes, in the order of the file.
    pub axes: Vec<MovedAxis>,
    /// Names of the axes of circle and path, such as `x and y`.
    #[serde(skip)]
    pub plane: String,
    /// The circle, if one was driven.
    pub circle: Option<DrivenCircle>,
    /// Why none was.
    #[serde(skip)]
    pub no_circle: Option<String>,
    /// The path of `--contour`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<FollowedPath>,
    /// When in a tick the stage does what.
    pub schedule: TickSchedule,
}

/// The move of an axis of the stage.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "StageAxis")]
pub struct MovedAxis {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// Distance and largest speed of the move.
    #[serde(skip)]
    pub distance_and_speed: Option<[f64; 2]>,
    /// Distance from the command during the move.
    pub tracking: Option<PathError>,
    /// Distance of the rest position from the target.
    pub offset: Option<f64>,
    /// Ringing after the move without the shaper.
    pub residual_unshaped: Option<f64>,
    /// Ringing after the move with it.
    pub residual: Option<f64>,
    /// With the shaper, and the modes' frequencies 10 % lower.
    pub residual_minus_10_percent: Option<f64>,
    /// With the shaper, and the modes' frequencies 10 % higher.
    pub residual_plus_10_percent: Option<f64>,
    /// Steps that the motor lost in the move; absent on an axis without steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_steps: Option<u64>,
    /// Ringing without the shaper and with it; `None` if one of the moves was not made to its end.
    #[serde(skip)]
    pub ringing: Option<[f64; 2]>,
    /// The effect of the axis's error table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_table: Option<Compensation>,
}

/// Distance of the load's rest position from its target, with the axis's error table and without it.
#[derive(Serialize, JsonSchema)]
pub struct Compensation {
    /// Without the table.
    pub offset_without: f64,
    /// With it.
    pub offset_with: f64,
    /// The largest that is allowed with it.
    pub offset_allowed: f64,
}

/// The circle of the first two axes.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Circle")]
pub struct DrivenCircle {
    /// Names of the axes.
    pub axes: Vec<String>,
    /// Radius of the circle.
    pub radius: f64,
    /// Speed along it.
    pub speed: f64,
    /// Distance from the circle with each shaper's own delay.
    pub own_delays: PathError,
    /// Distance from the circle with equal delays of all shapers.
    pub equal_delays: Option<PathError>,
    /// Why delays cannot be made equal.
    #[serde(skip)]
    pub unequal: Option<String>,
}

/// Distance of the load from where it should be.
#[derive(Serialize, JsonSchema)]
pub struct PathError {
    /// The largest.
    pub peak: f64,
    /// Its root mean square.
    pub rms: f64,
}

impl From<ErrorFigures> for PathError {
    fn from(figures: ErrorFigures) -> Self {
        Self {
            peak: figures.peak,
            rms: figures.rms,
        }
    }
}

/// When in a tick the stage does what.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Schedule")]
pub struct TickSchedule {
    /// Length of a tick.
    pub tick_clocks: u32,
    /// When the controllers start.
    pub control_clocks: u32,
    /// When the duties change.
    pub duty_clocks: u32,
    /// All steps of the tick.
    #[serde(skip)]
    pub steps: StageSchedule,
}
