//! `posicast design --front`: the benefit of longer durations, for each axis with an `optimal` shaper.

use super::DesignReport;
use crate::failure::Failure;
use crate::observer::Observer;
use crate::plot::{Curve, Panel};
use posicast_shaper::design::Findings;
use posicast_shaper::design::front::{FrontFigures, design_front};
use schemars::JsonSchema;
use serde::Serialize;

/// Label of an axis that counts taps.
const TAPS: &str = "taps";

/// The front of an axis.
pub(super) struct FrontReport {
    axis: String,
    figures: Vec<FrontFigures>,
    tolerance: f64,
}

/// The fronts of all axes with an `optimal` shaper.
pub(super) fn of_axes(report: &DesignReport<'_>, observer: &dyn Observer) -> Result<Vec<FrontReport>, Failure> {
    let axes = report.machine.axes.iter().zip(&report.design.axes);
    let mut fronts = Vec::new();
    let progress = observer.begin("durations", Some(report.machine.axes.len() as u64));
    for (axis, tables) in axes {
        if let Findings::Optimal(found) = &tables.design.findings {
            let tolerances = found.request.bands.iter().map(|band| band.tolerance);
            fronts.push(FrontReport {
                axis: axis.name.clone(),
                figures: design_front(found).map_err(Failure::because)?,
                tolerance: tolerances.fold(0.0, f64::max),
            });
        }
        progress.advance(1);
    }
    drop(progress);
    if fronts.is_empty() {
        return Err(Failure::input(
            "--front: no axis of the machine has an optimal shaper, whose duration could be chosen",
        )
        .with_help("set kind = \"optimal\" in [axis.shaper]; --compare shows the other kinds side by side"));
    }
    Ok(fronts)
}

impl FrontReport {
    pub(super) fn panels(&self, machine: &str) -> Vec<Panel> {
        // A shaper is valid for every longer duration too, until a better one is found, so taps are drawn as steps. The residual only has
        // points.
        let panel = |what: &str, y_label: &str, in_steps: bool, value: &dyn Fn(&FrontFigures) -> f64| {
            let mut points: Vec<(f64, f64)> = Vec::new();
            for figures in &self.figures {
                let point = (1e3 * figures.duration_s, value(figures));
                if let Some(last) = points.last().copied().filter(|_| in_steps) {
                    points.push((point.0, last.1));
                }
                points.push(point);
            }
            Panel {
                title: format!("{machine}, axis {}: {what} against duration", self.axis),
                x_label: "duration, ms".into(),
                y_label: y_label.into(),
                y_is_whole: y_label == TAPS,
                curves: vec![Curve::new(what.to_owned(), points)],
                ..Panel::default()
            }
        };
        let mut panels = vec![
            panel("fewest taps found", TAPS, true, &|figures| figures.taps as f64),
            panel("mean delay of the fewest taps", "mean delay, ms", true, &|figures| {
                1e3 * figures.delay_s
            }),
            panel(
                "least residual",
                "residual vibration over the bands, %",
                false,
                &|figures| 100.0 * figures.least_ratio * self.tolerance,
            ),
        ];
        // Without negative amplitudes the command never exceeds the step.
        if self.figures.iter().any(|figures| figures.peak_command > 1.0 + 1e-6) {
            let peak = &|figures: &FrontFigures| figures.peak_command;
            panels.push(panel(
                "peak command of the fewest taps",
                "largest part of the step",
                true,
                peak,
            ));
        }
        panels
    }

    pub(super) fn json(&self) -> Front {
        Front {
            axis: self.axis.clone(),
            durations: self
                .figures
                .iter()
                .map(|figures| FrontDuration {
                    duration_s: figures.duration_s,
                    taps: figures.taps,
                    peak_command: figures.peak_command,
                    delay_s: figures.delay_s,
                    least_residual: figures.least_ratio * self.tolerance,
                })
                .collect(),
        }
    }
}

/// What the durations of an axis's shaper buy.
#[derive(Serialize, JsonSchema)]
pub struct Front {
    /// Name of the axis.
    pub axis: String,
    /// The durations, the shortest first.
    pub durations: Vec<FrontDuration>,
}

/// What a duration buys.
#[derive(Serialize, JsonSchema)]
pub struct FrontDuration {
    /// The duration.
    pub duration_s: f64,
    /// The fewest taps that were found within the tolerance.
    pub taps: usize,
    /// Largest magnitude of their shaped unit step.
    pub peak_command: f64,
    /// Their mean delay of a command.
    pub delay_s: f64,
    /// The least residual of any shaper of that duration.
    pub least_residual: f64,
}
