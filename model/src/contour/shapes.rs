//! Strokes of a circle, of a square, and of lines through points.

use std::f64::consts::{PI, TAU};

use super::ContourError;
use super::stroke::{PlanePoint, Shape, Stroke, minus};
use crate::unit::AxisUnit;

/// A circle counter-clockwise from `(0, 0)`, which is its right end, and back to it.
///
/// # Errors
/// [`ContourError::Size`] where radius or speed is not positive.
pub fn circle(radius: f64, speed: f64) -> Result<Vec<Stroke>, ContourError> {
    positive("the radius", radius)?;
    positive("the speed", speed)?;
    let shape = Shape::Arc {
        centre: [-radius, 0.0],
        radius,
        begin: 0.0,
        sweep: TAU,
    };
    Ok(vec![Stroke {
        shape,
        speed,
        after_stop: true,
    }])
}

/// A square counter-clockwise from `(0, 0)`, its corner with the smallest coordinates, and back to it.
///
/// # Errors
/// [`ContourError::Size`] where side or speed is not positive.
pub fn square(side: f64, speed: f64) -> Result<Vec<Stroke>, ContourError> {
    positive("the side", side)?;
    polyline(&[[0.0, 0.0], [side, 0.0], [side, side], [0.0, side], [0.0, 0.0]], speed)
}

/// Straight lines from point to point; a point that repeats the last one is left out.
///
/// # Errors
/// [`ContourError::Empty`] for fewer than two distinct points, [`ContourError::Size`] for a speed that is not
/// positive.
pub fn polyline(points: &[PlanePoint], speed: f64) -> Result<Vec<Stroke>, ContourError> {
    positive("the speed", speed)?;
    let lines = points.windows(2).filter(|pair| pair[0] != pair[1]).map(|pair| Stroke {
        shape: Shape::Line {
            from: pair[0],
            to: pair[1],
        },
        speed,
        after_stop: false,
    });
    let lines: Vec<Stroke> = lines.collect();
    match lines.is_empty() {
        true => Err(ContourError::Empty("it takes two points that differ".to_owned())),
        false => Ok(lines),
    }
}

/// The line from `(0, 0)` to the start of a path, at the largest speed of the axes; the path stops after it.
pub fn approach(begin: PlanePoint) -> Stroke {
    Stroke {
        shape: Shape::Line {
            from: [0.0, 0.0],
            to: begin,
        },
        speed: f64::INFINITY,
        after_stop: true,
    }
}

/// The strokes moved by a vector.
pub fn moved(strokes: &[Stroke], [x, y]: PlanePoint) -> Vec<Stroke> {
    let to = |[at_x, at_y]: PlanePoint| [at_x + x, at_y + y];
    let moved = strokes.iter().map(|stroke| Stroke {
        shape: match stroke.shape {
            Shape::Line { from, to: end } => Shape::Line {
                from: to(from),
                to: to(end),
            },
            Shape::Arc {
                centre,
                radius,
                begin,
                sweep,
            } => Shape::Arc {
                centre: to(centre),
                radius,
                begin,
                sweep,
            },
        },
        ..*stroke
    });
    moved.collect()
}

/// Reads points from a text with a row `x,y` for each, in the units of the axes. A first row of words is a heading,
/// and `#` begins a comment.
///
/// # Errors
/// [`ContourError::Line`] for a row that is not two finite numbers, [`ContourError::Empty`] for a text without
/// points.
pub fn points(text: &str, units: [AxisUnit; 2]) -> Result<Vec<PlanePoint>, ContourError> {
    let mut points = Vec::new();
    let mut heading = true;
    for (index, row) in text.lines().enumerate() {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let fields: Vec<&str> = row.split([',', ';', '\t']).map(str::trim).collect();
        let numbers: Vec<Option<f64>> = fields
            .iter()
            .map(|field| field.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        match numbers.as_slice() {
            [Some(x), Some(y)] => points.push([units[0].to_si(*x), units[1].to_si(*y)]),
            _ if heading && fields.len() == 2 && numbers.iter().all(Option::is_none) => (),
            _ => {
                return Err(ContourError::Line {
                    line: index + 1,
                    found: format!("`{row}` is not a row x,y of two numbers"),
                    remedy: "give a row of two numbers for each point, in the units of the first two axes".to_owned(),
                });
            }
        }
        heading = false;
    }
    match points.is_empty() {
        true => Err(ContourError::Empty("the file has no points".to_owned())),
        false => Ok(points),
    }
}

/// An arc between two points about a centre; a whole turn where the points are equal.
pub(super) fn arc(from: PlanePoint, to: PlanePoint, centre: PlanePoint, clockwise: bool) -> Shape {
    let angle = |of: PlanePoint| {
        let [x, y] = minus(of, centre);
        y.atan2(x)
    };
    let begin = angle(from);
    let turned = (angle(to) - begin).rem_euclid(TAU);
    let counter_clockwise = if from == to || turned == 0.0 { TAU } else { turned };
    let sweep = match clockwise {
        false => counter_clockwise,
        true if counter_clockwise == TAU => -TAU,
        true => counter_clockwise - TAU,
    };
    let [x, y] = minus(from, centre);
    Shape::Arc {
        centre,
        radius: x.hypot(y),
        begin,
        sweep,
    }
}

/// Centre of the arc of this radius between two points; `long` selects the arc that turns by more than half. `None`
/// where the points are equal, or further apart than the diameter.
pub(super) fn centre(from: PlanePoint, to: PlanePoint, radius: f64, clockwise: bool, long: bool) -> Option<PlanePoint> {
    let [x, y] = minus(to, from);
    let chord = x.hypot(y);
    let height = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
    // A half turn may be off by the rounding of the radius's digits.
    if chord == 0.0 || chord / 2.0 > radius * (1.0 + 1e-6) {
        return None;
    }
    let side = if clockwise == long { 1.0 } else { -1.0 };
    let (sin, cos) = (y.atan2(x) + side * PI / 2.0).sin_cos();
    let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
    Some([middle[0] + height * cos, middle[1] + height * sin])
}

fn positive(what: &'static str, found: f64) -> Result<(), ContourError> {
    match found > 0.0 && found.is_finite() {
        true => Ok(()),
        false => Err(ContourError::Size { what, found }),
    }
}
