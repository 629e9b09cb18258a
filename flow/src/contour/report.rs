//! The distances of a path by kind of shaper: text, JSON and picture.

use crate::machine::plane_name;
use crate::plot::{Curve, Panel, label, time_axis};
use crate::text::{Table, UnitDocument};
use posicast_machine::contour::{ContourRow, CornerRules, FREQUENCY_FACTORS, FollowedContour, Survey};
use posicast_machine::machine_file::Machine;
use posicast_machine::unit::AxisUnit;
use posicast_shaper::unit::show_seconds;
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

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
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    contour: String,
    length: f64,
    /// Part of it that is rapids, or travels of a print.
    rapid_length: f64,
    duration_s: f64,
    stops: usize,
    corner_tolerance: f64,
    stop_angle_deg: f64,
    frequency_factors: [f64; 5],
    shapers: Vec<ShaperOnPath>,
}

#[derive(Serialize, JsonSchema)]
struct ShaperOnPath {
    kind: String,
    in_file: bool,
    equal_delays: bool,
    /// Largest distance from the path for each of `frequency_factors`, on the feeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    error_peak: Option<[f64; 5]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error_rms: Option<[f64; 5]>,
    /// Largest distance on the rapids for each of `frequency_factors`.
    #[serde(skip_serializing_if = "Option::is_none")]
    error_rapid: Option<[f64; 5]>,
    /// Largest distance while a feed is driven at full speed, with the modes as in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    error_steady: Option<f64>,
    /// Why there are no figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
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
            }
        });
        Document {
            name: self.machine.name.clone(),
            unit: UnitDocument::new(self.unit()),
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

    pub(super) fn text(&self) -> String {
        let rapids = if self.survey.rapid_length > 0.0 {
            format!(
                " ({} of it rapids)",
                self.unit().show_round(self.survey.rapid_length, "")
            )
        } else {
            String::new()
        };
        let mut text = format!(
            "{}: {} of axes {}, {}{rapids} in {}, {}\nlargest distance of the load from the path{}, its modes at\n",
            self.machine.name,
            self.name,
            plane_name(self.machine),
            self.unit().show_round(self.survey.length, ""),
            show_seconds(self.survey.duration_s, 3),
            counted(self.survey.stops as u64, "stop"),
            if rapids.is_empty() { "" } else { " while feeding" },
        );
        let factors = FREQUENCY_FACTORS.map(|factor| format!(">{:.0} %", 100.0 * factor));
        let mut headings = vec!["shaper", "delays"];
        headings.extend(factors.iter().map(String::as_str));
        headings.push(">at speed");
        if !rapids.is_empty() {
            headings.push(">in rapids");
        }
        let mut table = Table::new(&headings);
        let mut reasons = Vec::new();
        for row in self.rows {
            let kind = if row.in_file {
                format!("{}, of the file", row.kind)
            } else {
                row.kind.clone()
            };
            let delays = if row.matched { "equal" } else { "own" };
            // A smaller distance is due to rounding and the end of the settling.
            let show = |error: Option<f64>| match error {
                None => "–".to_owned(),
                Some(error) if error < 1e-10 => "0".to_owned(),
                Some(error) => self.unit().show(error, 3),
            };
            let mut cells = vec![kind.clone(), delays.to_owned()];
            let errors = figures(row, |followed| Some(followed.error?.peak));
            cells.extend((0..FREQUENCY_FACTORS.len()).map(|factor| show(errors.map(|errors| errors[factor]))));
            if let Err(reason) = &row.followed {
                reasons.push(format!("  {kind}, {delays} delays: {reason}"));
            }
            cells.push(show(row.nominal().and_then(|nominal| Some(nominal.steady?.peak))));
            if !rapids.is_empty() {
                cells.push(show(row.nominal().and_then(|nominal| Some(nominal.rapid?.peak))));
            }
            table.row(cells);
        }
        text += &table.text("  ");
        for reason in reasons {
            let _ = writeln!(text, "{reason}");
        }
        text
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
