//! Plans strokes as runs between stops, with the command in each sample.
//!
//! The path stops at a corner of more than 10 degrees, where the feed changes, and where a program says so. In
//! between, a run has one jerk-limited profile along the path, with
//!
//! ```text
//! v ≤ feed,   v² κ ≤ a/√2,   v³ κ² ≤ j/√8       κ: the largest curvature of its arcs
//! v · 2 sin(θ/2) ≤ a · T                         θ: its largest bend between two strokes; T: a sample
//! a_t ≤ min(a/√2, j/(3√2 v κ)),   j_t ≤ j/√8      along the path
//! ```
//!
//! so that acceleration and jerk of the path, along and across it together, stay within `a` and `j` of the weaker
//! axis. Where an arc begins or ends at a line, the acceleration across the path steps by `v² κ`; at a bend, the
//! velocity steps by what the axis gains in a sample.

use super::ContourError;
use super::stroke::{PlanePoint, Shape, Stroke, minus};
use crate::machine_file::{AxisSection, Machine};
use crate::motion::{Profile, SAMPLES_MAX, motion_limits};

/// Largest angle, in radians, of a bend that the path passes without a stop.
const BEND: f64 = 10.0 / 180.0 * std::f64::consts::PI;
/// Angle in radians below which a bend counts as straight, as the digits of programs leave it.
const STRAIGHT: f64 = 1e-4;
/// Relative difference below which two feeds are equal: inches and millimetres round differently.
const SAME: f64 = 1e-9;

/// Limits of both axes together, in m and s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourLimits {
    /// Velocity of the slower axis.
    pub velocity: f64,
    /// Acceleration of the weaker axis.
    pub acceleration: f64,
    /// Jerk of the weaker axis.
    pub jerk: f64,
}

impl ContourLimits {
    /// Limits of the first two axes of a machine.
    ///
    /// # Errors
    /// [`ContourError::Axes`] where they do not span a plane of lengths.
    pub fn of_machine(machine: &Machine) -> Result<Self, ContourError> {
        let [x, y] = plane(machine)?;
        let of = |axis: &AxisSection| motion_limits(axis.limits.as_ref());
        let (x, y) = (of(x), of(y));
        let [velocity, acceleration, jerk] = std::array::from_fn(|limit| f64::min(x[limit], y[limit]));
        Ok(Self {
            velocity,
            acceleration,
            jerk,
        })
    }
}

/// The first two axes of a machine, which span the plane.
pub(super) fn plane(machine: &Machine) -> Result<[&AxisSection; 2], ContourError> {
    let [x, y, ..] = machine.axes.as_slice() else {
        return Err(ContourError::Axes("the machine has one axis".to_owned()));
    };
    for axis in [x, y] {
        if axis.unit.si_name() != "m" {
            return Err(ContourError::Axes(format!(
                "the unit of axis {} is {}",
                axis.name,
                axis.unit.name()
            )));
        }
        if axis.modulo {
            return Err(ContourError::Axes(format!("axis {} is modulo", axis.name)));
        }
    }
    Ok([x, y])
}

/// The command in a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourSample {
    /// Distance along the path, m.
    pub along: f64,
    /// Speed along the path, m/s.
    pub speed: f64,
    /// Position in the plane, m.
    pub at: PlanePoint,
}

/// A part of the path between two stops.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    /// Distance along the path at which it begins, m.
    begin: f64,
    profile: Profile,
}

/// A path with its motion in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// The strokes, each with the distance along the path at which it begins.
    strokes: Vec<(f64, Shape)>,
    runs: Vec<Run>,
    length: f64,
}

impl Contour {
    /// Plans the path of these strokes, each of which begins where the last one ends, for a machine with the sample
    /// period `sample_s` in seconds.
    ///
    /// # Errors
    /// [`ContourError::Empty`] without strokes or with a path of no length.
    pub fn new(strokes: &[Stroke], limits: &ContourLimits, sample_s: f64) -> Result<Self, ContourError> {
        let empty = || ContourError::Empty("it has no length".to_owned());
        let mut placed = Vec::with_capacity(strokes.len());
        let (mut length, mut runs): (f64, Vec<Limited>) = (0.0, Vec::new());
        let mut last: Option<&Stroke> = None;
        for stroke in strokes.iter().filter(|stroke| stroke.shape.length() > 0.0) {
            let bend = last.map_or(f64::INFINITY, |last| bend(&last.shape, &stroke.shape));
            let same_feed = last.is_some_and(|last| is_same(last.speed, stroke.speed));
            match runs
                .last_mut()
                .filter(|_| bend <= BEND && same_feed && !stroke.after_stop)
            {
                Some(run) => run.add(stroke, bend),
                None => runs.push(Limited::new(length, stroke)),
            }
            placed.push((length, stroke.shape));
            length += stroke.shape.length();
            last = Some(stroke);
        }
        let runs = runs.into_iter().map(|run| run.planned(limits, sample_s));
        let runs: Vec<Run> = runs.collect::<Option<_>>().ok_or_else(empty)?;
        match runs.is_empty() {
            true => Err(empty()),
            false => Ok(Self {
                strokes: placed,
                runs,
                length,
            }),
        }
    }

    /// Start of the path.
    pub fn begin(&self) -> PlanePoint {
        self.strokes.first().map_or([0.0, 0.0], |(_, shape)| shape.at(0.0))
    }

    /// Length of the path, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Duration of the command, s.
    pub fn duration_s(&self) -> f64 {
        self.runs.iter().map(|run| run.profile.duration_s()).sum()
    }

    /// Number of stops on the way.
    pub fn stops(&self) -> usize {
        self.runs.len().saturating_sub(1)
    }

    /// Smallest and largest coordinate that the path reaches, `[low, high]` for each axis.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let places = self.strokes.iter().flat_map(|(_, shape)| {
            let ends = [0.0, shape.length()];
            // An arc is widest where its direction is parallel to an axis.
            let widest = match shape {
                Shape::Arc {
                    centre: [x, y], radius, ..
                } => vec![[x + radius, *y], [x - radius, *y], [*x, y + radius], [*x, y - radius]],
                Shape::Line { .. } => Vec::new(),
            };
            let widest = widest
                .into_iter()
                .map(|place| shape.nearest(place))
                .collect::<Vec<f64>>();
            ends.into_iter()
                .chain(widest)
                .map(|along| shape.at(along))
                .collect::<Vec<PlanePoint>>()
        });
        let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for place in places {
            for (axis, [low, high]) in extent.iter_mut().enumerate() {
                (*low, *high) = (low.min(place[axis]), high.max(place[axis]));
            }
        }
        extent
    }

    /// Checks that the travel of both axes covers the whole path.
    ///
    /// # Errors
    /// [`ContourError::Travel`] with the axis whose travel is too short.
    pub fn check_travel(&self, machine: &Machine) -> Result<(), ContourError> {
        for (axis, [least, most]) in plane(machine)?.into_iter().zip(self.extent()) {
            let Some([low, high]) = axis.limits.and_then(|limits| limits.travel) else {
                continue;
            };
            let found = if least < low { least } else { most };
            if least < low || most > high {
                let [found, low, high] = [found, low, high].map(|place| axis.unit.show_round(place, ""));
                return Err(ContourError::Travel {
                    axis: axis.name.clone(),
                    found,
                    low,
                    high,
                });
            }
        }
        Ok(())
    }

    /// The command at each sample, from the start to `settle_s` seconds after the end.
    ///
    /// # Errors
    /// [`ContourError::TooLong`] for more samples than are simulated.
    pub fn samples(&self, sample_s: f64, settle_s: f64) -> Result<Vec<ContourSample>, ContourError> {
        let seconds = self.duration_s() + settle_s;
        let count = (seconds / sample_s).ceil();
        if count.is_nan() || count >= SAMPLES_MAX as f64 {
            return Err(ContourError::TooLong {
                seconds,
                most: SAMPLES_MAX,
            });
        }
        let mut samples = Vec::with_capacity(count as usize + 1);
        let (mut run, mut begun_s, mut stroke) = (0, 0.0, 0);
        for number in 0..=count as usize {
            let time_s = number as f64 * sample_s;
            while run + 1 < self.runs.len() && time_s >= begun_s + self.runs[run].profile.duration_s() {
                begun_s += self.runs[run].profile.duration_s();
                run += 1;
            }
            let along = self.runs[run].begin + self.runs[run].profile.position(time_s - begun_s);
            while self.strokes.get(stroke + 1).is_some_and(|(begin, _)| along >= *begin) {
                stroke += 1;
            }
            let (begin, shape) = &self.strokes[stroke];
            let before = samples.last().map_or(along, |last: &ContourSample| last.along);
            samples.push(ContourSample {
                along,
                speed: (along - before) / sample_s,
                at: shape.at((along - begin).min(shape.length())),
            });
        }
        Ok(samples)
    }

    /// Distance of a point from the part of the path between `low` and `high`: positive to the left of the direction
    /// of travel. Also returns the nearest point of the path and the normal there.
    pub fn distance(&self, point: PlanePoint, low: f64, high: f64) -> f64 {
        let first = self
            .strokes
            .partition_point(|(begin, _)| *begin <= low)
            .saturating_sub(1);
        let near = self.strokes[first..].iter().take_while(|(begin, _)| *begin <= high);
        let distances = near.map(|(_, shape)| {
            let along = shape.nearest(point);
            let [x, y] = minus(point, shape.at(along));
            let [dx, dy] = shape.direction(along);
            x.hypot(y).copysign(dx * y - dy * x)
        });
        distances.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    }
}

/// A run with the limits of its speed.
struct Limited {
    begin: f64,
    length: f64,
    feed: f64,
    curvature: f64,
    bend: f64,
}

impl Limited {
    fn new(begin: f64, stroke: &Stroke) -> Self {
        Self {
            begin,
            length: stroke.shape.length(),
            feed: stroke.speed,
            curvature: stroke.shape.curvature(),
            bend: 0.0,
        }
    }

    fn add(&mut self, stroke: &Stroke, bend: f64) {
        self.length += stroke.shape.length();
        self.curvature = self.curvature.max(stroke.shape.curvature());
        if bend > STRAIGHT {
            self.bend = self.bend.max(bend);
        }
    }

    /// Plans the run; `None` where its length or a limit is not a positive number.
    fn planned(&self, limits: &ContourLimits, sample_s: f64) -> Option<Run> {
        let (across, jerk) = (limits.acceleration / 2f64.sqrt(), limits.jerk / 8f64.sqrt());
        let mut speed = self.feed.min(limits.velocity);
        let mut acceleration = across;
        if self.bend > 0.0 {
            speed = speed.min(limits.acceleration * sample_s / (2.0 * (self.bend / 2.0).sin()));
        }
        if self.curvature > 0.0 {
            speed = speed
                .min((across / self.curvature).sqrt())
                .min((jerk / self.curvature.powi(2)).cbrt());
            acceleration = acceleration.min(limits.jerk / (3.0 * 2f64.sqrt() * speed * self.curvature));
        }
        let profile = Profile::new(0.0, self.length, speed, acceleration, jerk).ok()?;
        Some(Run {
            begin: self.begin,
            profile,
        })
    }
}

fn bend(before: &Shape, after: &Shape) -> f64 {
    let ([ax, ay], [bx, by]) = (before.direction(before.length()), after.direction(0.0));
    (ax * by - ay * bx).atan2(ax * bx + ay * by).abs()
}

fn is_same(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().min(b.abs())
}
