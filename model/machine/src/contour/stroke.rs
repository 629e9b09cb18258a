//! Lines and arcs of a plane.

use std::f64::consts::TAU;

/// A point `[x, y]` of the plane.
pub type PlanePoint = [f64; 2];

/// A line or an arc of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line {
        /// Start of the line.
        from: PlanePoint,
        /// End of the line.
        to: PlanePoint,
    },
    /// A part of a circle.
    Arc {
        /// Centre of the circle.
        centre: PlanePoint,
        /// Radius of the circle.
        radius: f64,
        /// Direction from the centre to the start, in radians from the x axis, counter-clockwise.
        begin: f64,
        /// Angle by which the arc turns, in radians: positive counter-clockwise.
        sweep: f64,
    },
}

/// A shape with its commanded speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// The line or arc.
    pub shape: Shape,
    /// Speed along it, per s; infinite for the largest speed of the axes.
    pub speed: f64,
    /// Whether the path stops before it even where it continues straight on.
    pub after_stop: bool,
    /// Whether it only goes somewhere, as G0 does: its error is reported apart.
    pub rapid: bool,
}

impl Stroke {
    /// A line or an arc of the work, at this speed per s, that the path goes on to without a stop.
    pub fn feed(shape: Shape, speed: f64) -> Self {
        Self {
            shape,
            speed,
            after_stop: false,
            rapid: false,
        }
    }
}

/// The difference `a − b` of two points.
pub(super) fn minus(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

impl Shape {
    /// Length of the line or arc.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => {
                let [x, y] = minus(*to, *from);
                x.hypot(y)
            }
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point at the distance `along` from the start, from 0 to the length.
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

    /// The direction of travel at the distance `along` from the start, as a unit vector.
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

    /// Curvature: one over the radius; 0 for a line.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { radius, .. } => radius.recip(),
        }
    }

    /// Widens a range, `[low, high]` for each axis, so that it holds the shape.
    pub(super) fn extend(&self, range: &mut [[f64; 2]; 2]) {
        let mut hold = |place: PlanePoint| {
            for (axis, [low, high]) in range.iter_mut().enumerate() {
                (*low, *high) = (low.min(place[axis]), high.max(place[axis]));
            }
        };
        match self {
            Self::Line { from, to } => {
                hold(*from);
                hold(*to);
            }
            Self::Arc {
                centre: [x, y], radius, ..
            } => {
                hold(self.at(0.0));
                hold(self.at(self.length()));
                // An arc is widest where its direction is parallel to an axis.
                for widest in [[x + radius, *y], [x - radius, *y], [*x, y + radius], [*x, y - radius]] {
                    hold(self.at(self.nearest(widest)));
                }
            }
        }
    }

    /// Distance from the start of its point that is nearest to `point`.
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
                // The angle counts from the start in the direction of travel; beyond the end the nearest point is the
                // end or the start.
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
