//! The path of `--contour` in the closed loop.

use super::report::PathError;
use super::verdicts::equals_model;
use crate::contour::PathOptions;
use crate::failure::Failure;
use crate::moves::Motion;
use crate::observer::Observer;
use crate::plot::{Curve, Panel, label, time_axis};
use crate::run::checks::Check;
use posicast_closed_loop::stage_run::{Compared, Contoured, Trouble};
use posicast_machine::contour::{Contour, FollowedContour};
use posicast_machine::machine_file::Machine;
use schemars::JsonSchema;
use serde::Serialize;

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

/// Returns the path of a run, from the reset position of the axes.
pub(crate) fn contour(
    machine: &Machine,
    path: Option<&PathOptions>,
    motion: &Motion,
    has_stage: bool,
    observer: &dyn Observer,
) -> Result<Option<NamedContour>, Failure> {
    let Some(path) = path else {
        return Ok(None);
    };
    if !has_stage {
        let lacking = Failure::input("--contour: the machine has no stage, whose closed loop would drive it");
        return Err(lacking.with_help(
            "`posicast simulate --contour` drives the shapers alone; docs/machine-file.md explains the requirements of a stage",
        ));
    }
    let contour = path.planned(machine, motion.along_contour()?, observer)?;
    Ok(Some(NamedContour {
        name: path.contour.clone().unwrap_or_default(),
        contour,
    }))
}

/// `contour` of `stage` in `report.json`. Lengths are in m.
#[derive(Serialize, JsonSchema)]
pub struct FollowedPath {
    /// The path: `circle`, `square`, or a file.
    pub path: String,
    /// Length of the path.
    pub length: f64,
    /// Part of it that is rapids: at least the way to its beginning.
    pub rapid_length: f64,
    /// Time of the path.
    pub duration_s: f64,
    /// Number of stops on the way.
    pub stops: usize,
    /// Clocks in which Verilog and model were compared; null without Verilator.
    pub compared_clocks: Option<u64>,
    /// Distance from the path with each shaper's own delay.
    pub own_delays: Option<PathDistance>,
    /// Distance from the path with equal delays of all shapers.
    pub equal_delays: Option<PathDistance>,
    /// The same two for each that was driven, although it may have no feed.
    #[serde(skip)]
    pub rows: Vec<FollowedRow>,
    /// Why delays cannot be made equal.
    #[serde(skip)]
    pub unequal: Option<String>,
}

/// The distances of the load with a set of tap tables.
pub struct FollowedRow {
    /// Description of the tables.
    pub tables: &'static str,
    /// Distance on the feeds; `None` without a feed.
    pub error: Option<PathError>,
    /// Largest distance on the rapids.
    pub rapid_peak: Option<f64>,
}

/// Distance of the load from a path.
#[derive(Serialize, JsonSchema)]
pub struct PathDistance {
    /// The largest.
    pub peak: f64,
    /// Its root mean square.
    pub rms: f64,
    /// Largest distance on the rapids, which the other figures do not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rapid_peak: Option<f64>,
}

impl PathDistance {
    fn new(followed: &FollowedContour) -> Option<Self> {
        let error = followed.error?;
        Some(Self {
            peak: error.peak,
            rms: error.rms,
            rapid_peak: followed.rapid.map(|rapid| rapid.peak),
        })
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

    pub(super) fn json(&self) -> FollowedPath {
        let of = |contoured: &Contoured| PathDistance::new(contoured.followed.as_ref()?);
        let survey = self.path.contour.survey();
        FollowedPath {
            path: self.path.name.clone(),
            length: survey.length,
            rapid_length: survey.rapid_length,
            duration_s: survey.duration_s,
            stops: survey.stops,
            compared_clocks: self.compared.as_ref().map(|compared| compared.clocks),
            own_delays: of(&self.apart),
            equal_delays: self.matched.as_ref().ok().and_then(of),
            rows: self
                .rows()
                .map(|(tables, followed)| FollowedRow {
                    tables,
                    error: followed.error.map(PathError::from),
                    rapid_peak: followed.rapid.map(|rapid| rapid.peak),
                })
                .collect(),
            unequal: self.matched.as_ref().err().cloned(),
        }
    }

    /// The distance over time; `None` if the stage never moved.
    pub(super) fn panel(&self, machine: &Machine) -> Option<Panel> {
        let sample_s = machine.clock.sample_period_s();
        let rows = || {
            let rows = self.rows();
            rows.filter_map(|(name, followed)| Some((name, followed.distance.as_ref()?)))
        };
        let samples = rows().map(|(_, distance)| distance.samples()).max()?;
        let time = time_axis(samples as f64 * sample_s);
        let distances = rows().flat_map(|(_, distance)| distance.points().map(|(_, distance)| distance));
        let unit = machine.axes[0].unit.for_largest(distances);
        let curves = rows().map(|(name, distance)| {
            let points = distance.points();
            let points = points.map(|(tick, distance)| (time.of(tick as f64 * sample_s), unit.of(distance)));
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
