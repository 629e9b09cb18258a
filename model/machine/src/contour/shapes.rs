//! Strokes of a circle, of a square, and of lines through points.

use std::f64::consts::{PI, TAU};

use super::ContourError;
use super::lines::Lines;
use super::stroke::{PlanePoint, Shape, Stroke, minus};
use crate::unit::AxisUnit;
use std::io::BufRead;

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
        after_stop: true,
        ..Stroke::feed(shape, speed)
    }])
}

/// A square counter-clockwise from `(0, 0)`, its corner with the smallest coordinates, and back to it, with a stop in
/// each corner.
///
/// # Errors
/// [`ContourError::Size`] where side or speed is not positive.
pub fn square(side: f64, speed: f64) -> Result<Vec<Stroke>, ContourError> {
    positive("the side", side)?;
    let mut lines = polyline(&[[0.0, 0.0], [side, 0.0], [side, side], [0.0, side], [0.0, 0.0]], speed)?;
    lines.iter_mut().for_each(|line| line.after_stop = true);
    Ok(lines)
}

/// Straight lines from point to point; a point that repeats the last one is left out.
///
/// # Errors
/// [`ContourError::Empty`] for fewer than two distinct points, [`ContourError::Size`] for a speed that is not
/// positive.
pub fn polyline(points: &[PlanePoint], speed: f64) -> Result<Vec<Stroke>, ContourError> {
    positive("the speed", speed)?;
    let lines = points.windows(2).filter(|pair| pair[0] != pair[1]).map(|pair| {
        let [from, to] = [pair[0], pair[1]];
        Stroke::feed(Shape::Line { from, to }, speed)
    });
    let lines: Vec<Stroke> = lines.collect();
    if lines.is_empty() {
        Err(ContourError::Empty("it takes two points that differ".to_owned()))
    } else {
        Ok(lines)
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
        rapid: true,
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

/// The lines through the points of a text with a row `x,y` for each, in the units of the axes, read row by row. A first
/// row of words is a heading, and `#` begins a comment. A point that repeats the last one is left out.
pub struct Points<'a> {
    rows: Lines<Box<dyn BufRead + 'a>>,
    units: [AxisUnit; 2],
    speed: f64,
    heading: bool,
    at: Option<PlanePoint>,
    ended: bool,
}

impl<'a> Points<'a> {
    /// Reads this text, for lines at this speed in m/s.
    ///
    /// # Errors
    /// [`ContourError::Size`] for a speed that is not positive.
    pub fn new(source: Box<dyn BufRead + 'a>, units: [AxisUnit; 2], speed: f64) -> Result<Self, ContourError> {
        positive("the speed", speed)?;
        Ok(Self {
            rows: Lines::new(source),
            units,
            speed,
            heading: true,
            at: None,
            ended: false,
        })
    }

    /// The point of a row; `None` for a heading, a comment or an empty row.
    fn point(&mut self) -> Result<Option<PlanePoint>, ContourError> {
        let text = String::from_utf8_lossy(&self.rows.text);
        let row = text
            .trim_start_matches('\u{feff}')
            .split('#')
            .next()
            .unwrap_or_default()
            .trim();
        if row.is_empty() {
            return Ok(None);
        }
        let mut fields = row.split([',', ';', '\t']).map(str::trim);
        let fields = [fields.next(), fields.next(), fields.next()];
        let number = |field: Option<&str>| field?.parse().ok().filter(|number: &f64| number.is_finite());
        let is_heading = std::mem::take(&mut self.heading);
        match (fields, [number(fields[0]), number(fields[1])]) {
            ([_, _, None], [Some(x), Some(y)]) => Ok(Some([self.units[0].to_si(x), self.units[1].to_si(y)])),
            ([Some(_), Some(_), None], [None, None]) if is_heading => Ok(None),
            _ => {
                let shown: String = row.chars().take(40).collect();
                Err(ContourError::Line {
                    line: self.rows.number,
                    found: format!("`{shown}` is not a row x,y of two numbers"),
                    remedy: "give a row of two numbers for each point, in the units of the first two axes".to_owned(),
                })
            }
        }
    }
}

impl Iterator for Points<'_> {
    type Item = Result<Stroke, ContourError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            let point = match self.rows.next() {
                Ok(true) => self.point(),
                Ok(false) => {
                    self.ended = true;
                    Ok(None)
                }
                Err(error) => Err(error),
            };
            match point {
                Ok(None) => (),
                Ok(Some(to)) => {
                    if let Some(from) = self.at.replace(to).filter(|from| *from != to) {
                        return Some(Ok(Stroke::feed(Shape::Line { from, to }, self.speed)));
                    }
                }
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            }
        }
        None
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
    if found > 0.0 && found.is_finite() {
        Ok(())
    } else {
        Err(ContourError::Size { what, found })
    }
}
