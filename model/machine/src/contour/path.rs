//! The part of a path that a machine is just driving, and the distance of a point from it.

use super::plan::Placed;
use super::stroke::{PlanePoint, Shape, minus};

/// Strokes are dropped once this many are behind the machine.
const DROP: usize = 8192;

/// A line or an arc, prepared for many distances from it.
#[derive(Debug, Clone, Copy)]
struct Piece {
    /// Distance along the path at its end.
    end: f64,
    rapid: bool,
    from: PlanePoint,
    to: PlanePoint,
    /// Directions of travel at its beginning and its end.
    directions: [PlanePoint; 2],
    form: Form,
}

#[derive(Debug, Clone, Copy)]
enum Form {
    Line {
        length: f64,
    },
    Arc {
        centre: PlanePoint,
        radius: f64,
        /// 1 counter-clockwise, −1 clockwise.
        turn: f64,
        /// Whether it turns by more than half a turn.
        is_wide: bool,
    },
}

/// Distance of a point from a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// Positive to the left of the direction of travel, m.
    pub(super) distance: f64,
    /// Index of the stroke that is nearest.
    pub(super) stroke: usize,
    pub(super) rapid: bool,
}

fn dot(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: PlanePoint) -> f64 {
    dot(a, a).sqrt()
}

impl Piece {
    fn new(placed: &Placed) -> Self {
        let size = placed.shape.length();
        Self {
            end: placed.begin + size,
            rapid: placed.rapid,
            from: placed.shape.at(0.0),
            to: placed.shape.at(size),
            directions: [placed.shape.direction(0.0), placed.shape.direction(size)],
            form: match placed.shape {
                Shape::Line { .. } => Form::Line { length: size },
                Shape::Arc {
                    centre, radius, sweep, ..
                } => Form::Arc {
                    centre,
                    radius,
                    turn: sweep.signum(),
                    is_wide: sweep.abs() > std::f64::consts::PI,
                },
            },
        }
    }

    /// Signed distance of a point; positive to the left of the direction of travel.
    fn distance(&self, point: PlanePoint) -> f64 {
        let offset = minus(point, self.from);
        let [first, last] = self.directions;
        let beyond = |end: PlanePoint, direction: PlanePoint| {
            let offset = minus(point, end);
            length(offset).copysign(cross(direction, offset))
        };
        match self.form {
            Form::Line { length } => {
                let along = dot(offset, first);
                if along < 0.0 {
                    beyond(self.from, first)
                } else if along > length {
                    beyond(self.to, first)
                } else {
                    cross(first, offset)
                }
            }
            Form::Arc {
                centre,
                radius,
                turn,
                is_wide,
            } => {
                let from_centre = minus(point, centre);
                // The sides of the lines from the centre through both ends: cross products with these lines, which
                // are the directions of travel turned by a right angle.
                let after_first = dot(first, from_centre) >= 0.0;
                let before_last = dot(last, from_centre) <= 0.0;
                let is_beside = if is_wide {
                    after_first || before_last
                } else {
                    after_first && before_last
                };
                if is_beside {
                    return turn * (radius - length(from_centre));
                }
                let (at_from, at_to) = (beyond(self.from, first), beyond(self.to, last));
                if at_from.abs() <= at_to.abs() { at_from } else { at_to }
            }
        }
    }
}

/// The strokes round the place that is just driven.
#[derive(Debug, Clone, Default)]
pub(super) struct PathWindow {
    pieces: Vec<Piece>,
    /// Number of strokes that were dropped.
    dropped: usize,
}

impl PathWindow {
    pub(super) fn extend<'a>(&mut self, strokes: impl IntoIterator<Item = &'a Placed>) {
        self.pieces.extend(strokes.into_iter().map(Piece::new));
    }

    /// Drops strokes that end before `along`, sooner or later.
    pub(super) fn drop_before(&mut self, along: f64) {
        let behind = self.pieces.partition_point(|piece| piece.end < along);
        let behind = behind.min(self.pieces.len().saturating_sub(1));
        if behind >= DROP {
            self.pieces.drain(..behind);
            self.dropped += behind;
        }
    }

    /// Index of the first stroke that ends at `along` or later, from `guess` on, which ends before or is the first one.
    pub(super) fn first_at(&self, along: f64, guess: usize) -> usize {
        let mut index = guess.max(self.dropped) - self.dropped;
        while index + 1 < self.pieces.len() && self.pieces[index].end < along {
            index += 1;
        }
        index + self.dropped
    }

    /// Distance of a point from the strokes `first` to `last`. The search begins at `guess`; far strokes are skipped,
    /// because a point of the path at a distance `D` has no point of the path closer than `D − s` within the length
    /// `s` of it.
    pub(super) fn nearest(&self, point: PlanePoint, first: usize, last: usize, guess: usize) -> Nearest {
        let last = last.saturating_sub(self.dropped).min(self.pieces.len() - 1);
        let first = (first.max(self.dropped) - self.dropped).min(last);
        let guess = guess.saturating_sub(self.dropped).clamp(first, last);
        let (mut distance, mut nearest) = (self.pieces[guess].distance(point), guess);
        let mut look = |index: usize, distance: &mut f64| {
            let found = self.pieces[index].distance(point);
            if found.abs() < distance.abs() {
                (*distance, nearest) = (found, index);
            }
        };
        let mut index = guess;
        while index < last {
            let piece = &self.pieces[index];
            let clear = piece.end + length(minus(point, piece.to)) - distance.abs();
            index += 1 + self.pieces[index + 1..=last].partition_point(|piece| piece.end <= clear);
            if index <= last {
                look(index, &mut distance);
            }
        }
        let mut index = guess;
        while index > first {
            let begin = self.pieces[index - 1].end;
            let clear = begin - length(minus(point, self.pieces[index].from)) + distance.abs();
            // The next stroke that begins before `clear`: each begins where the one before it ends.
            index = first + self.pieces[first..index - 1].partition_point(|piece| piece.end < clear);
            look(index, &mut distance);
        }
        Nearest {
            distance,
            stroke: nearest + self.dropped,
            rapid: self.pieces[nearest].rapid,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::shapes::arc;
    use proptest::prelude::*;

    /// A path of lines and arcs with strokes of very different lengths.
    fn paths() -> impl Strategy<Value = Vec<Placed>> {
        let stroke = (-4.0..0.0f64, -3.1..3.1f64, prop::option::of(-3.0..3.0f64));
        prop::collection::vec(stroke, 1..60).prop_map(|strokes| {
            let (mut begin, mut at) = (0.0, [0.0, 0.0]);
            let placed = strokes.into_iter().map(|(size, direction, bulge)| {
                let length = 10f64.powf(size);
                let (sin, cos) = direction.sin_cos();
                let to = [at[0] + length * cos, at[1] + length * sin];
                let shape = match bulge.filter(|bulge| bulge.abs() > 0.1) {
                    None => Shape::Line { from: at, to },
                    Some(bulge) => {
                        let middle = [f64::midpoint(at[0], to[0]), f64::midpoint(at[1], to[1])];
                        let centre = [middle[0] - bulge * (to[1] - at[1]), middle[1] + bulge * (to[0] - at[0])];
                        arc(at, to, centre, direction > 0.0)
                    }
                };
                let placed = Placed {
                    begin,
                    shape,
                    rapid: false,
                    full: 1.0,
                };
                begin += shape.length();
                at = shape.at(shape.length());
                placed
            });
            placed.collect()
        })
    }

    proptest! {
        #[test]
        fn prop_the_distance_is_the_least_of_all_strokes(
            strokes in paths(), x in -1.5..1.5f64, y in -1.5..1.5f64, guess in 0usize..60, near in any::<bool>(), first in 0usize..60
        ) {
            let mut path = PathWindow::default();
            path.extend(&strokes);
            let last = strokes.len() - 1;
            let (first, guess) = (first % strokes.len(), guess % strokes.len());
            let at = strokes[guess].shape.at(0.3 * strokes[guess].shape.length());
            let point = if near { [at[0] + 1e-3 * x, at[1] + 1e-3 * y] } else { [x, y] };
            let found = path.nearest(point, first, last, guess);
            let away = |placed: &Placed| {
                let [dx, dy] = minus(point, placed.shape.at(placed.shape.nearest(point)));
                dx.hypot(dy)
            };
            let least = strokes[first..].iter().map(away).fold(f64::INFINITY, f64::min);
            prop_assert!((found.distance.abs() - least).abs() < 1e-9, "{found:?} {least}");
            prop_assert!((away(&strokes[found.stroke]) - least).abs() < 1e-9);
        }
    }

    #[test]
    fn distances_are_positive_to_the_left() {
        let mut path = PathWindow::default();
        path.extend(&[Placed {
            begin: 0.0,
            shape: arc([0.0, 0.0], [0.0, 0.0], [-0.01, 0.0], false),
            rapid: true,
            full: 1.0,
        }]);
        // A point 1 mm outside the circle is to the right of a counter-clockwise path.
        for (point, distance) in [([0.001, 0.0], -0.001), ([-0.01, 0.009], 0.001), ([-0.021, 0.0], -0.001)] {
            let found = path.nearest(point, 0, 0, 0);
            assert!((found.distance - distance).abs() < 1e-15 && found.rapid, "{found:?}");
        }
    }

    #[test]
    fn strokes_behind_are_dropped_and_keep_their_numbers() {
        let mut path = PathWindow::default();
        let line = |k: usize| Placed {
            begin: k as f64,
            shape: Shape::Line {
                from: [k as f64, 0.0],
                to: [k as f64 + 1.0, 0.0],
            },
            rapid: false,
            full: 1.0,
        };
        for block in 0..10 {
            path.extend(&(block * DROP..(block + 1) * DROP).map(line).collect::<Vec<_>>());
            path.drop_before(((block + 1) * DROP) as f64 - 10.0);
        }
        assert!(path.pieces.len() < 2 * DROP);
        let last = 10 * DROP - 1;
        let first = path.first_at(last as f64 - 5.5, 0);
        assert_eq!(first, last - 6);
        let found = path.nearest([last as f64 - 2.5, 0.25], first, last, 0);
        assert_eq!((found.stroke, found.distance), (last - 3, 0.25));
    }
}
