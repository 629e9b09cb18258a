//! The path of `--contour` in the closed loop.

use super::verdicts::equals_model;
use crate::contour::ContourArgs;
use crate::failure::Failure;
use crate::moves::MotionArgs;
use crate::output::Table;
use crate::plot::{Curve, Panel, label, time_axis};
use crate::run::checks::Check;
use posicast_model::contour::{Contour, FollowedContour};
use posicast_model::machine_file::Machine;
use posicast_model::unit::show_seconds;
use posicast_testbench::stage_run::{Compared, Contoured, Trouble};
use posicast_testbench::wording::counted;
use serde::Serialize;
use std::fmt::Write;

/// A path, and its name on the command line.
pub(crate) struct NamedContour {
    pub(crate) name: String,
    pub(crate) contour: Contour,
}

/// Results of a path.
pub(super) struct Contours<'a> {
    pub(super) path: &'a NamedContour,
    /// Comparison with the Verilog; `None` without Verilator.
    pub(super) compared: Option<Compared>,
    /// Result with each shaper's own delay.
    pub(super) apart: Contoured,
    /// Result with equal delays of all shapers; the error says why there are no such tables.
    pub(super) matched: Result<Contoured, String>,
}

/// The path of a run, from where the axes stand at reset.
pub(crate) fn contour(
    machine: &Machine,
    path: Option<&ContourArgs>,
    motion: &MotionArgs,
    has_stage: bool,
) -> Result<Option<NamedContour>, Failure> {
    let Some(path) = path else {
        return Ok(None);
    };
    if !has_stage {
        return Err(Failure::from(miette::miette!(
            help = "`posicast simulate --contour` drives the shapers alone; docs/machine-file.md explains the requirements of a stage",
            "--contour: the machine has no stage, whose closed loop would drive it"
        )));
    }
    let contour = path.planned(machine, motion.along_contour()?, true)?;
    Ok(Some(NamedContour {
        name: path.contour.clone().unwrap_or_default(),
        contour,
    }))
}

/// `contour` of `stage` in `report.json`. Lengths are in m.
#[derive(Serialize)]
pub(super) struct ContourDocument {
    path: String,
    length: f64,
    duration_s: f64,
    stops: usize,
    compared_clocks: Option<u64>,
    own_delays: Option<DistanceDocument>,
    equal_delays: Option<DistanceDocument>,
}

#[derive(Serialize)]
struct DistanceDocument {
    peak: f64,
    rms: f64,
}

impl DistanceDocument {
    fn new(followed: &FollowedContour) -> Self {
        Self {
            peak: followed.error.peak,
            rms: followed.error.rms,
        }
    }
}

impl Contours<'_> {
    /// The troubles of the stage on the path.
    pub(super) fn troubles(&self) -> impl Iterator<Item = Option<&Trouble>> + Clone {
        let matched = self.matched.as_ref().ok();
        std::iter::once(&self.apart)
            .chain(matched)
            .map(|contoured| contoured.trouble.as_ref())
    }

    pub(super) fn check(&self) -> Option<Check> {
        self.compared.as_ref().map(|compared| Check {
            name: "the stage's RTL equals the bit-exact model in every clock of the contour",
            ..equals_model(compared, "the end of the path")
        })
    }

    fn rows(&self) -> impl Iterator<Item = (&'static str, &FollowedContour)> {
        let matched = self
            .matched
            .as_ref()
            .ok()
            .and_then(|contoured| contoured.followed.as_ref());
        let apart = self
            .apart
            .followed
            .as_ref()
            .map(|followed| ("each with its own delay", followed));
        apart
            .into_iter()
            .chain(matched.map(|followed| ("delays made equal", followed)))
    }

    pub(super) fn text(&self, machine: &Machine) -> String {
        let unit = machine.axes[0].unit;
        let mut table = Table::new(&["tap tables", ">distance from the path, peak", ">rms"]);
        for (name, followed) in self.rows() {
            let [peak, rms] = unit.show_all([followed.error.peak, followed.error.rms]);
            table.row([name.to_owned(), peak, rms]);
        }
        let contour = &self.path.contour;
        let mut text = format!(
            "\nContour {} of axes {} and {}: {} in {}, {}\n{}",
            self.path.name,
            machine.axes[0].name,
            machine.axes[1].name,
            unit.show_round(contour.length(), ""),
            show_seconds(contour.duration_s(), 3),
            counted(contour.stops() as u64, "stop"),
            table.text("  ")
        );
        if let Err(reason) = &self.matched {
            let _ = writeln!(text, "  delays cannot be made equal: {reason}");
        }
        text
    }

    pub(super) fn json(&self) -> ContourDocument {
        let of = |contoured: &Contoured| contoured.followed.as_ref().map(DistanceDocument::new);
        ContourDocument {
            path: self.path.name.clone(),
            length: self.path.contour.length(),
            duration_s: self.path.contour.duration_s(),
            stops: self.path.contour.stops(),
            compared_clocks: self.compared.as_ref().map(|compared| compared.clocks),
            own_delays: of(&self.apart),
            equal_delays: self.matched.as_ref().ok().and_then(of),
        }
    }

    /// The distance over time; `None` where the stage never moved.
    pub(super) fn panel(&self, machine: &Machine) -> Option<Panel> {
        let sample_s = machine.clock.sample_period_s();
        let samples = self.rows().map(|(_, followed)| followed.distance.len()).max()?;
        let time = time_axis(samples as f64 * sample_s);
        let unit = machine.axes[0]
            .unit
            .for_largest(self.rows().map(|(_, followed)| followed.error.peak));
        let curves = self.rows().map(|(name, followed)| {
            let points = followed.distance.iter().enumerate();
            let points = points.map(|(tick, distance)| (time.of(tick as f64 * sample_s), unit.of(*distance)));
            Curve::new(name, points.collect())
        });
        Some(Panel {
            title: format!(
                "{}, {}: distance of the load from the path",
                machine.name, self.path.name
            ),
            x_label: label("time", time),
            y_label: label("to the left of the path", unit),
            curves: curves.collect(),
            ..Panel::default()
        })
    }
}
