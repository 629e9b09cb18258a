//! Speeds at which a path passes its bends: junction deviation, as grbl, Marlin and Klipper use it.
//!
//! ```text
//! v² ≤ a · δ · c/(1 − c)               c = cos(θ/2), δ: the tolerance of corners            a corner of angle θ
//! v² ≤ a/√2 · r,   v³ ≤ j/√8 · r²      r = l/(2 tan(θ/2)), l: the mean of its two sides     facets of a curve
//! ```
//!
//! `r` is the radius of the circle whose facets they are (where the sides differ much, `l` is 1.5 times the shorter one,
//! because then they are not), and the limits there are those of an arc of this radius, so
//! that facets take the time of the arc; they hold down to the speed of a right angle. A bend sharper than the stop
//! angle is a stop.
//!
//! Programs have rounded coordinates: between points that lie close together, the direction is noise. So bends are
//! measured between chords, lines from which no point between their ends deviates by more than a quarter of the
//! tolerance.

use super::ContourError;
use super::plan::ContourLimits;
use super::stroke::{PlanePoint, Shape, Stroke, minus};
use std::collections::VecDeque;

/// Angle in radians below which a bend counts as straight, as the digits of programs leave it.
const STRAIGHT: f64 = 1e-4;
/// A bend may exceed the stop angle by this fraction: the facets of an octagon bend by 45 degrees plus a rounding
/// error.
const STOP_ROUNDING: f64 = 1e-6;
/// Points may deviate from a chord by this share of the tolerance.
const CHORD_SHARE: f64 = 0.25;
/// Largest mean of the sides of a bend, as a multiple of the shorter one.
const LONGEST_MEAN: f64 = 1.5;
/// Largest number of strokes of a chord.
const CHORD_STROKES: usize = 2000;

/// How a path passes its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerRules {
    /// Distance, in m, by which the path could cut a corner to pass it with the acceleration of the axes; 0: it stops
    /// at every bend.
    pub tolerance: f64,
    /// Angle, in radians, above which a bend is a stop.
    pub stop_angle: f64,
}

impl CornerRules {
    /// Default of [`CornerRules::tolerance`]: `$11` of grbl 1.1. Klipper's default, 5 mm/s in right angles, is 14 µm
    /// at 750 mm/s² and 3.5 µm at 3,000 mm/s²; Marlin's examples have 13 µm.
    pub const DEFAULT_TOLERANCE_M: f64 = 10e-6;
    /// Default of [`CornerRules::stop_angle`]: half a right angle.
    pub const DEFAULT_STOP_ANGLE: f64 = std::f64::consts::FRAC_PI_4;
}

impl Default for CornerRules {
    fn default() -> Self {
        Self {
            tolerance: Self::DEFAULT_TOLERANCE_M,
            stop_angle: Self::DEFAULT_STOP_ANGLE,
        }
    }
}

/// How a path goes on to a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Corner {
    /// The path stops.
    Stop,
    /// The path passes the corner at most at this speed, m/s.
    Speed(f64),
}

/// A line without noise, or an arc.
struct Element {
    begins: PlanePoint,
    ends: PlanePoint,
    /// Length of a line; infinite for an arc, which limits the speed by its own radius.
    length: f64,
}

/// A chord that may still grow.
struct Chord {
    from: PlanePoint,
    to: PlanePoint,
    strokes: usize,
    /// Direction to which the angles refer; `None` as long as no point is further from its beginning than the
    /// tolerance.
    direction: Option<PlanePoint>,
    /// Angles that all its points permit.
    permitted: [f64; 2],
    farthest: f64,
}

impl Chord {
    fn new(from: PlanePoint, to: PlanePoint, tolerance: f64) -> Self {
        let mut chord = Self {
            from,
            to: from,
            strokes: 0,
            direction: None,
            permitted: [-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2],
            farthest: 0.0,
        };
        chord.extend(to, tolerance);
        chord
    }

    /// Adds a point; returns whether it belongs to the chord.
    fn extend(&mut self, to: PlanePoint, tolerance: f64) -> bool {
        let [x, y] = minus(to, self.from);
        let distance = x.hypot(y);
        if self.strokes >= CHORD_STROKES || distance < self.farthest - tolerance {
            return false;
        }
        if distance > tolerance {
            let [dx, dy] = *self.direction.get_or_insert([x / distance, y / distance]);
            let angle = (dx * y - dy * x).atan2(dx * x + dy * y);
            let [low, high] = self.permitted;
            if angle < low || angle > high {
                return false;
            }
            let play = (tolerance / distance).asin().max(STRAIGHT);
            self.permitted = [low.max(angle - play), high.min(angle + play)];
        }
        self.farthest = self.farthest.max(distance);
        self.to = to;
        self.strokes += 1;
        true
    }

    fn element(&self) -> Element {
        let [x, y] = minus(self.to, self.from);
        let length = x.hypot(y);
        let direction = if length > 0.0 {
            [x / length, y / length]
        } else {
            self.direction.unwrap_or([1.0, 0.0])
        };
        Element {
            begins: direction,
            ends: direction,
            length,
        }
    }
}

/// Adds to each stroke how the path goes on to it.
pub(super) struct Corners<I> {
    strokes: I,
    rules: CornerRules,
    limits: ContourLimits,
    /// Strokes with their corners. Those from `open_at` on belong to the open chord, whose first corner is not known
    /// yet.
    waiting: VecDeque<(Stroke, Corner)>,
    open_at: usize,
    chord: Option<Chord>,
    before: Option<Element>,
    /// An error of the source, which follows the strokes before it.
    failed: Option<ContourError>,
    ended: bool,
}

impl<I: Iterator<Item = Result<Stroke, ContourError>>> Corners<I> {
    pub(super) fn new(strokes: I, rules: CornerRules, limits: ContourLimits) -> Self {
        Self {
            strokes,
            rules,
            limits,
            waiting: VecDeque::new(),
            open_at: 0,
            chord: None,
            before: None,
            failed: None,
            ended: false,
        }
    }

    fn chord_tolerance(&self) -> f64 {
        CHORD_SHARE * self.rules.tolerance
    }

    fn add(&mut self, stroke: Stroke) {
        let tolerance = self.chord_tolerance();
        if stroke.after_stop {
            self.close();
            self.before = None;
        }
        match stroke.shape {
            Shape::Line { to, .. } if self.chord.as_mut().is_some_and(|chord| chord.extend(to, tolerance)) => {
                self.waiting.push_back((stroke, Corner::Speed(f64::INFINITY)));
            }
            Shape::Line { from, to } => {
                self.close();
                self.waiting.push_back((stroke, Corner::Stop));
                self.chord = Some(Chord::new(from, to, tolerance));
            }
            Shape::Arc { .. } => {
                self.close();
                let arc = Element {
                    begins: stroke.shape.direction(0.0),
                    ends: stroke.shape.direction(stroke.shape.length()),
                    length: f64::INFINITY,
                };
                let corner = self.corner(&arc);
                self.waiting.push_back((stroke, corner));
                self.open_at = self.waiting.len();
                self.before = Some(arc);
            }
        }
    }

    /// Ends the open chord, so that its first corner is known.
    fn close(&mut self) {
        if let Some(chord) = self.chord.take() {
            let element = chord.element();
            let corner = self.corner(&element);
            if let Some(first) = self.waiting.get_mut(self.open_at) {
                first.1 = corner;
            }
            self.before = Some(element);
        }
        self.open_at = self.waiting.len();
    }

    fn corner(&self, after: &Element) -> Corner {
        let Some(before) = &self.before else {
            return Corner::Stop;
        };
        let ([ax, ay], [bx, by]) = (before.ends, after.begins);
        let bend = (ax * by - ay * bx).atan2(ax * bx + ay * by).abs();
        let mean = f64::midpoint(before.length, after.length);
        let side = mean.min(LONGEST_MEAN * before.length.min(after.length));
        self.limits.corner(&self.rules, bend, side)
    }
}

impl<I: Iterator<Item = Result<Stroke, ContourError>>> Iterator for Corners<I> {
    type Item = Result<(Stroke, Corner), ContourError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.open_at == 0 && !self.ended {
            match self.strokes.next() {
                Some(Ok(stroke)) if stroke.shape.length() > 0.0 => self.add(stroke),
                Some(Ok(_)) => (),
                Some(Err(error)) => {
                    self.close();
                    (self.failed, self.ended) = (Some(error), true);
                }
                None => {
                    self.close();
                    self.ended = true;
                }
            }
        }
        match self.waiting.pop_front() {
            Some(stroke) => {
                self.open_at = self.open_at.saturating_sub(1);
                Some(Ok(stroke))
            }
            None => self.failed.take().map(Err),
        }
    }
}

impl ContourLimits {
    /// Largest acceleration across a path, beside that along it, m/s².
    pub(super) fn across(&self) -> f64 {
        self.acceleration / 2f64.sqrt()
    }

    /// Largest share of the jerk along a path, and of that by which the direction of an acceleration across it turns,
    /// m/s³.
    pub(super) fn part_of_jerk(&self) -> f64 {
        self.jerk / 8f64.sqrt()
    }

    /// Largest speed on a curve, m/s.
    pub(super) fn on_curve(&self, radius: f64) -> f64 {
        (self.across() * radius)
            .sqrt()
            .min((self.part_of_jerk() * radius * radius).cbrt())
    }

    /// How a path passes a bend between two sides of this length.
    fn corner(&self, rules: &CornerRules, bend: f64, side: f64) -> Corner {
        if bend <= STRAIGHT {
            return Corner::Speed(f64::INFINITY);
        }
        // 1 − cos(θ/2) without cancellation.
        let deviated = |bend: f64| {
            let cut = 2.0 * (bend / 4.0).sin().powi(2);
            (self.acceleration * rules.tolerance * (1.0 - cut).max(0.0) / cut).sqrt()
        };
        let radius = side / (2.0 * (bend / 2.0).tan());
        let facets = self.on_curve(radius).max(deviated(std::f64::consts::FRAC_PI_2));
        let speed = deviated(bend).min(facets);
        if bend > rules.stop_angle * (1.0 + STOP_ROUNDING) || speed <= 0.0 {
            Corner::Stop
        } else {
            Corner::Speed(speed)
        }
    }
}
