//! The report of the closed loop, for people and for programs.

use super::contours::{Contours, FollowedPath};
use super::{Circles, ClosedLoop};
use crate::machine::plane_name;
use crate::run::gain::{Gain, GainSource, Track};
use crate::run::pictures::slowest_period_s;
use crate::text::{Table, UnitDocument};
use posicast_closed_loop::stage_run::{Circled, Compared, Moved};
use posicast_machine::plant::axis::ErrorFigures;
use posicast_machine::unit::AxisUnit;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

impl ClosedLoop<'_> {
    /// The section for people.
    pub(crate) fn text(&self) -> String {
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
        for (index, axis) in self.machine.axes.iter().enumerate() {
            let Some(figures) = self.shaped.axes.get(index) else {
                continue;
            };
            let ringing = |moved: &Moved| moved.axes.get(index).map_or(f64::NAN, |axis| axis.residual.peak);
            let numbers = [
                figures.tracking.peak,
                figures.tracking.rms,
                figures.offset,
                ringing(&self.unshaped),
                ringing(&self.shaped),
                ringing(&self.slower),
                ringing(&self.faster),
            ];
            table.row(std::iter::once(axis.name.clone()).chain(axis.unit.show_all(numbers)));
        }
        let mut text = format!(
            "Closed loop: all axes move at once on the simulated machine, {}\n{}",
            self.moves_text(),
            table.text("  ")
        );
        text += &self.error_tables_text();
        match (&self.contours, &self.circles) {
            (Some(contours), _) => text += &contours.text(self.machine),
            (None, Ok(circles)) => text += &self.circles_text(circles),
            (None, Err(reason)) => {
                let _ = writeln!(text, "\nNo circle is driven: {reason}");
            }
        }
        let schedule = self.stage.of_machine.config.timing();
        let tick = self.stage.of_machine.config.tick.tick_clocks();
        let _ = writeln!(text, "\nSchedule of a tick of {tick} clocks\n  {schedule}");
        text
    }

    /// A line for each axis that has an error table.
    pub(crate) fn error_tables_text(&self) -> String {
        let lines = self.compensated().map(|(index, of)| {
            let axis = &self.machine.axes[index];
            let [with, without] = axis.unit.show_all([of.with.abs(), of.without.abs()]);
            format!(
                "  axis {}, homed: the load rests {with} from its target with its error table, {without} without\n",
                axis.name
            )
        });
        lines.collect()
    }

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

    /// Largest error of an axis during its move, in m or rad.
    pub(crate) fn tracking_peak(&self, axis: usize) -> Option<f64> {
        Some(self.shaped.axes.get(axis)?.tracking.peak)
    }

    /// Distance and speed of each axis's move.
    fn moves_text(&self) -> String {
        let axes = self.machine.axes.iter().zip(self.moves);
        let texts = axes.map(|(axis, of)| {
            let (distance, speed) = (
                axis.unit.show_round(of.distance, ""),
                axis.unit.show_round(of.velocity, "/s"),
            );
            format!("{} by {distance} at up to {speed}", axis.name)
        });
        texts.collect::<Vec<_>>().join(", ")
    }

    fn circles_text(&self, circles: &Circles) -> String {
        let unit = self.circle_unit();
        let mut table = Table::new(&["tap tables", ">distance from the circle, peak", ">rms"]);
        let mut row = |name: &str, circled: &Circled| {
            let [peak, rms] = unit.show_all([circled.error.peak, circled.error.rms]);
            table.row([name.to_owned(), peak, rms]);
        };
        row("each with its own delay", &circles.apart);
        if let Ok(matched) = &circles.matched {
            row("delays made equal", matched);
        }
        let mut text = format!(
            "\nCircle of axes {}, radius {} at {}\n{}",
            plane_name(self.machine),
            unit.show_round(circles.circle.radius, ""),
            unit.show_round(circles.circle.speed, "/s"),
            table.text("  ")
        );
        if let Err(reason) = &circles.matched {
            let _ = writeln!(text, "  delays cannot be made equal: {reason}");
        }
        text
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
                    StageAxis {
                        name: axis.name.clone(),
                        unit: UnitDocument::new(axis.unit),
                        tracking: figures.map(|figures| figures.tracking.into()),
                        offset: figures.map(|figures| figures.offset),
                        residual_unshaped: residual(&self.unshaped, index),
                        residual: residual(&self.shaped, index),
                        residual_minus_10_percent: residual(&self.slower, index),
                        residual_plus_10_percent: residual(&self.faster, index),
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
            circle: self.circles.as_ref().ok().map(|circles| Circle {
                axes: self.machine.axes.iter().take(2).map(|axis| axis.name.clone()).collect(),
                radius: circles.circle.radius,
                speed: circles.circle.speed,
                own_delays: circles.apart.error.into(),
                equal_delays: circles.matched.as_ref().ok().map(|circled| circled.error.into()),
            }),
            contour: self.contours.as_ref().map(Contours::json),
            schedule: Schedule {
                tick_clocks: config.tick.tick_clocks(),
                control_clocks: config.timing().control_clocks(),
                duty_clocks: config.timing().duty_clocks(),
            },
        }
    }
}

/// The closed loop: the stage on its simulated machine. Lengths are in m or rad.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "ClosedLoop")]
pub(crate) struct StageFigures {
    /// The Verilog beside its model; null without Verilator.
    side_by_side: Option<Compared>,
    axes: Vec<StageAxis>,
    circle: Option<Circle>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contour: Option<FollowedPath>,
    schedule: Schedule,
}

/// The move of an axis of the stage.
#[derive(Serialize, JsonSchema)]
struct StageAxis {
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    tracking: Option<PathError>,
    offset: Option<f64>,
    residual_unshaped: Option<f64>,
    residual: Option<f64>,
    residual_minus_10_percent: Option<f64>,
    residual_plus_10_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error_table: Option<Compensation>,
}

/// Distance of the load's rest position from its target, with the axis's error table and without it.
#[derive(Serialize, JsonSchema)]
struct Compensation {
    offset_without: f64,
    offset_with: f64,
    offset_allowed: f64,
}

#[derive(Serialize, JsonSchema)]
struct Circle {
    axes: Vec<String>,
    radius: f64,
    speed: f64,
    own_delays: PathError,
    equal_delays: Option<PathError>,
}

#[derive(Serialize, JsonSchema)]
struct PathError {
    peak: f64,
    rms: f64,
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
struct Schedule {
    tick_clocks: u32,
    control_clocks: u32,
    duty_clocks: u32,
}
