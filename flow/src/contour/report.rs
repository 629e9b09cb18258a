//! The distances of a path by kind of shaper: document and picture.

use crate::machine::plane_name;
use crate::plot::{Curve, Panel, label, time_axis};
use crate::text::UnitDocument;
use posicast_machine::contour::{ContourRow, CornerRules, FREQUENCY_FACTORS, FollowedContour, Survey};
use posicast_machine::machine_file::Machine;
use posicast_machine::unit::AxisUnit;
use schemars::JsonSchema;
use serde::Serialize;

/// The distances of each kind of shaper.
pub(super) struct Report<'a> {
    pub(super) machine: &'a Machine,
    pub(super) name: &'a str,
    pub(super) survey: &'a Survey,
    pub(super) rules: &'a CornerRules,
    pub(super) rows: &'a [ContourRow],
}

/// `simulate --contour --json`. Lengths are in m.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// Unit of the first axis.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// Names of the axes of the path's plane, such as `x and y`.
    #[serde(skip)]
    pub plane: String,
    /// The path: `circle`, `square`, or a file.
    pub contour: String,
    /// Length of the path.
    pub length: f64,
    /// Part of it that is rapids, or travels of a print.
    pub rapid_length: f64,
    /// Time of the path.
    pub duration_s: f64,
    /// Number of stops on the way.
    pub stops: usize,
    /// Junction deviation at bends.
    pub corner_tolerance: f64,
    /// Angle of a bend above which the path stops.
    pub stop_angle_deg: f64,
    /// Frequencies of the modes, relative to those of the file, for which there are distances.
    pub frequency_factors: [f64; 5],
    /// The kinds of shaper.
    pub shapers: Vec<ShaperOnPath>,
}

/// A kind of shaper that drives the path.
#[derive(Serialize, JsonSchema)]
pub struct ShaperOnPath {
    /// Name of the kind.
    pub kind: String,
    /// Whether the machine file has this kind.
    pub in_file: bool,
    /// Whether the delays of the axes are made equal.
    pub equal_delays: bool,
    /// Largest distance from the path for each of `frequency_factors`, on the feeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_peak: Option<[f64; 5]>,
    /// Root mean square of the distance for each of `frequency_factors`, on the feeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_rms: Option<[f64; 5]>,
    /// Largest distance on the rapids for each of `frequency_factors`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_rapid: Option<[f64; 5]>,
    /// Largest distance while a feed is driven at full speed, with the modes as in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_steady: Option<f64>,
    /// Why there are no figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Largest distance on the rapids, with the modes as in the file.
    #[serde(skip)]
    pub nominal_rapid: Option<f64>,
}

impl Report<'_> {
    fn unit(&self) -> AxisUnit {
        self.machine.axes[0].unit
    }

    pub(super) fn json(&self) -> Document {
        let rows = self.rows.iter().map(|row| {
            let figures = |of: fn(&FollowedContour) -> Option<f64>| figures(row, of);
            ShaperOnPath {
                kind: row.kind.clone(),
                in_file: row.in_file,
                equal_delays: row.matched,
                error_peak: figures(|followed| Some(followed.error?.peak)),
                error_rms: figures(|followed| Some(followed.error?.rms)),
                error_rapid: figures(|followed| Some(followed.rapid?.peak)),
                error_steady: row.nominal().and_then(|nominal| Some(nominal.steady?.peak)),
                reason: row.followed.as_ref().err().cloned(),
                nominal_rapid: row.nominal().and_then(|nominal| Some(nominal.rapid?.peak)),
            }
        });
        Document {
            name: self.machine.name.clone(),
            unit: UnitDocument::new(self.unit()),
            plane: plane_name(self.machine),
            contour: self.name.to_owned(),
            length: self.survey.length,
            rapid_length: self.survey.rapid_length,
            duration_s: self.survey.duration_s,
            stops: self.survey.stops,
            corner_tolerance: self.rules.tolerance,
            stop_angle_deg: self.rules.stop_angle.to_degrees(),
            frequency_factors: FREQUENCY_FACTORS,
            shapers: rows.collect(),
        }
    }

    /// The distance over time, without a shaper and with the machine's own.
    pub(super) fn panel(&self) -> Panel {
        let drawn = |row: &&ContourRow| row.in_file || row.kind == "none" && !row.matched;
        let sample_s = self.machine.clock.sample_period_s();
        let rows = || {
            let drawn = self.rows.iter().filter(drawn);
            drawn.filter_map(|row| Some((row, row.nominal()?.distance.as_ref()?)))
        };
        let samples = rows().map(|(_, distance)| distance.samples()).max().unwrap_or(0);
        let time = time_axis(samples as f64 * sample_s);
        let peaks = rows().flat_map(|(_, distance)| distance.points().map(|(_, distance)| distance));
        let length = self.unit().for_largest(peaks);
        let curves = rows().map(|(row, distance)| {
            let points = distance.points();
            let points = points.map(|(sample, distance)| (time.of(sample as f64 * sample_s), length.of(distance)));
            let delays = if row.matched { "equal delays" } else { "own delays" };
            let name = if row.kind == "none" && !row.in_file {
                "unshaped".to_owned()
            } else {
                format!("{}, {delays}", row.kind)
            };
            Curve::new(name, points.collect())
        });
        Panel {
            title: format!(
                "{}: {}, distance of the load from the path",
                self.machine.name, self.name
            ),
            x_label: label("time", time),
            y_label: label("to the left of the path", length),
            curves: curves.collect(),
            ..Panel::default()
        }
    }
}

/// A figure of a row at each frequency; `None` where one of them has none.
fn figures(row: &ContourRow, of: impl Fn(&FollowedContour) -> Option<f64>) -> Option<[f64; 5]> {
    let followed = row.followed.as_ref().ok()?;
    let found: Vec<f64> = followed.iter().filter_map(of).collect();
    found.try_into().ok()
}
