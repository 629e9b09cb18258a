//! Lines and arcs of a plane.

use std::f64::consts::TAU;

/// A place `[x, y]`.
pub type PlanePoint = [f64; 2];

/// A line or an arc of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Straight on.
    Line {
        /// Its beginning.
        from: PlanePoint,
        /// Its end.
        to: PlanePoint,
    },
    /// Along a circle.
    Arc {
        /// Its centre.
        centre: PlanePoint,
        /// Its radius.
        radius: f64,
        /// Direction from the centre to the beginning, in radians from the x axis, counter-clockwise.
        begin: f64,
        /// Angle that it turns by, in radians: positive counter-clockwise.
        sweep: f64,
    },
}

/// A shape, and the speed that it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// What is drawn.
    pub shape: Shape,
    /// Speed along it, per s; infinite where the axes' own is asked for.
    pub speed: f64,
    /// Whether the path stops before it, also where it goes straight on.
    pub after_stop: bool,
}

/// The difference of two places.
pub(super) fn minus(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

impl Shape {
    /// Its length.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => {
                let [x, y] = minus(*to, *from);
                x.hypot(y)
            }
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The place `along` it, from 0 to its length.
    pub fn at(&self, along: f64) -> PlanePoint {
        match self {
            Self::Line { from, to } => {
                let length = self.length();
                let share = if length > 0.0 { along / length } else { 0.0 };
                let [x, y] = minus(*to, *from);
                [from[0] + share * x, from[1] + share * y]
            }
            Self::Arc {
                centre,
                radius,
                begin,
                sweep,
            } => {
                let (sin, cos) = (begin + sweep.signum() * along / radius).sin_cos();
                [centre[0] + radius * cos, centre[1] + radius * sin]
            }
        }
    }

    /// The direction of travel `along` it: a unit vector.
    pub fn direction(&self, along: f64) -> PlanePoint {
        match self {
            Self::Line { from, to } => {
                let (length, [x, y]) = (self.length(), minus(*to, *from));
                [x / length, y / length]
            }
            Self::Arc {
                radius, begin, sweep, ..
            } => {
                let turn = sweep.signum();
                let (sin, cos) = (begin + turn * along / radius).sin_cos();
                [-turn * sin, turn * cos]
            }
        }
    }

    /// One over its radius; 0 of a line.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { radius, .. } => radius.recip(),
        }
    }

    /// How far along it the place nearest to `point` is.
    pub fn nearest(&self, point: PlanePoint) -> f64 {
        let length = self.length();
        match self {
            Self::Line { from, .. } => {
                let [x, y] = minus(point, *from);
                let [dx, dy] = self.direction(0.0);
                (x * dx + y * dy).clamp(0.0, length)
            }
            Self::Arc {
                centre,
                radius,
                begin,
                sweep,
            } => {
                let [x, y] = minus(point, *centre);
                // From the beginning in the direction of travel; what is beyond the end is nearer to the end or to the beginning.
                let turned = ((y.atan2(x) - begin) * sweep.signum()).rem_euclid(TAU);
                let sweep = sweep.abs();
                let beyond = turned - sweep;
                match beyond <= 0.0 {
                    true => turned * radius,
                    false if beyond < TAU - turned => length,
                    false => 0.0,
                }
            }
        }
    }
}
