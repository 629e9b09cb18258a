//! Reads the strokes of a G-code program: lines and arcs of the XY plane.
//!
//! | read | meaning |
//! |---|---|
//! | `G0`, `G1` | a line to X, Y; `G0` as fast as the axes go, `G1` at F |
//! | `G2`, `G3` | an arc to X, Y, clockwise or counter-clockwise, about the beginning plus I, J, or of radius R (negative: by more than half a turn) |
//! | `G20`, `G21` | inches, millimetres (which a program begins with) |
//! | `G90`, `G91` | absolute (which a program begins with), relative |
//! | `G4` | the path stops |
//! | `G17`, `G40`, `G49`, `G54`, `G61`, `G64`, `G80`, `G94`, M, T, S, N, Z, E, P | ignored: they do not change the path in the plane |
//!
//! Every other G code is refused, because its effect on the path is not known. A program begins at `(0, 0)`.

use gcode::{Argument, Block, Code, Value, WordAddress};

use super::ContourError;
use super::shapes::{arc, centre};
use super::stroke::{PlanePoint, Shape, Stroke, minus};

/// G codes that do not change a path in the plane.
const IGNORED: [u32; 8] = [17, 40, 49, 54, 61, 64, 80, 94];
/// Letters of words that do not change it either.
const IGNORED_WORDS: &str = "ZESPKTNQ";
/// Largest distance of an arc's end from its circle, as the digits of programs leave it: as a fraction of the radius,
/// and in m.
const OFF_CIRCLE: (f64, f64) = (1e-3, 5e-6);
const MILLIMETRE: f64 = 1e-3;
const INCH: f64 = 25.4e-3;
const MINUTE_S: f64 = 60.0;

/// The strokes of a program, in m.
///
/// # Errors
/// [`ContourError::Line`] with the line that cannot be driven; [`ContourError::Empty`] for a program that moves
/// neither X nor Y.
pub fn strokes(program: &str) -> Result<Vec<Stroke>, ContourError> {
    let parsed = gcode::parse(program).map_err(|problems| {
        let first = problems.iter().next();
        ContourError::Line {
            line: first.map_or(1, |problem| problem.span.line + 1),
            found: first.map_or_else(|| "it is not G-code".to_owned(), |problem| problem.kind.to_string()),
            remedy: "give G-code: words of a letter and a number, comments in ( ) or behind ;".to_owned(),
        }
    })?;
    let mut reader = Reader {
        program,
        at: [0.0, 0.0],
        unit: MILLIMETRE,
        relative: false,
        motion: None,
        speed: None,
        stopped: true,
        strokes: Vec::new(),
    };
    for block in &parsed.blocks {
        reader.block(block)?;
    }
    match reader.strokes.is_empty() {
        true => Err(ContourError::Empty("the program moves neither X nor Y".to_owned())),
        false => Ok(reader.strokes),
    }
}

struct Reader<'a> {
    program: &'a str,
    at: PlanePoint,
    unit: f64,
    relative: bool,
    motion: Option<u32>,
    /// Feed F in m/s.
    speed: Option<f64>,
    /// Whether the path stops after the last stroke.
    stopped: bool,
    strokes: Vec<Stroke>,
}

/// The words of a block that are used.
#[derive(Default)]
struct Words {
    x: Option<f64>,
    y: Option<f64>,
    i: Option<f64>,
    j: Option<f64>,
    radius: Option<f64>,
}

impl Reader<'_> {
    fn block(&mut self, block: &Block) -> Result<(), ContourError> {
        let line = block.span.line + 1;
        let mut words = Words::default();
        let mut feed = None;
        for code in &block.codes {
            let arguments = match code {
                Code::General(general) => {
                    self.general(
                        general.number.major(),
                        general.number.minor().map_or(0, u32::from),
                        line,
                    )?;
                    &general.args
                }
                Code::Miscellaneous(code) => &code.args,
                _ => continue,
            };
            for Argument {
                letter, value, span, ..
            } in arguments
            {
                self.word(*letter, value, (span.start, span.length), line, &mut words, &mut feed)?;
            }
        }
        for WordAddress {
            letter, value, span, ..
        } in &block.word_addresses
        {
            self.word(*letter, value, (span.start, span.length), line, &mut words, &mut feed)?;
        }
        if let Some(feed) = feed {
            if feed <= 0.0 {
                return Err(refused(
                    line,
                    format!("F{feed}"),
                    "give a feed above 0, in units per minute",
                ));
            }
            self.speed = Some(feed * self.unit / MINUTE_S);
        }
        self.moved(&words, line)
    }

    fn general(&mut self, major: u32, minor: u32, line: usize) -> Result<(), ContourError> {
        match (major, minor) {
            (0..=3, 0) => self.motion = Some(major),
            (4, 0) => self.stopped = true,
            (20, 0) => self.unit = INCH,
            (21, 0) => self.unit = MILLIMETRE,
            (90, 0) => self.relative = false,
            (91, 0) => self.relative = true,
            (91, 1) => (),
            (other, 0) if IGNORED.contains(&other) => (),
            _ => {
                let code = if minor == 0 {
                    format!("G{major}")
                } else {
                    format!("G{major}.{minor}")
                };
                let remedy = "remove it, or write it as lines and arcs: G0 to G4, G17, G20, G21, G90 and G91 are read";
                return Err(refused(line, format!("{code} is not read"), remedy));
            }
        }
        Ok(())
    }

    /// Reads a number from its text, because the parser's own number has only seven digits.
    fn word(
        &self,
        letter: char,
        value: &Value,
        (start, length): (usize, usize),
        line: usize,
        words: &mut Words,
        feed: &mut Option<f64>,
    ) -> Result<(), ContourError> {
        let letter = letter.to_ascii_uppercase();
        let text = self.program.get(start..start + length).unwrap_or_default();
        let number = text.trim_start_matches(|c: char| c.is_ascii_alphabetic() || c.is_whitespace());
        let number = number.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let (Value::Literal(_), Some(number)) = (value, number) else {
            let remedy = "give numbers: variables and expressions are not read";
            return Err(refused(line, format!("`{text}` has no number"), remedy));
        };
        match letter {
            'X' => words.x = Some(number),
            'Y' => words.y = Some(number),
            'I' => words.i = Some(number),
            'J' => words.j = Some(number),
            'R' => words.radius = Some(number),
            'F' => *feed = Some(number),
            other if IGNORED_WORDS.contains(other) => (),
            other => {
                let remedy = "remove it: the path is that of X and Y";
                return Err(refused(line, format!("`{other}` is not read"), remedy));
            }
        }
        Ok(())
    }

    fn moved(&mut self, words: &Words, line: usize) -> Result<(), ContourError> {
        let is_arc = matches!(self.motion, Some(2 | 3));
        let turns = is_arc && (words.i.is_some() || words.j.is_some());
        if words.x.is_none() && words.y.is_none() && !turns {
            return Ok(());
        }
        let Some(motion) = self.motion else {
            let found = "a place before the first of G0, G1, G2, G3";
            return Err(refused(
                line,
                found.to_owned(),
                "say how it is gone to: G1 with F, for example",
            ));
        };
        let from = self.at;
        let to = [words.x, words.y].map(|word| word.map(|word| word * self.unit));
        let to: PlanePoint = std::array::from_fn(|axis| match (to[axis], self.relative) {
            (None, _) => from[axis],
            (Some(word), true) => from[axis] + word,
            (Some(word), false) => word,
        });
        let speed = match (motion, self.speed) {
            (0, _) => f64::INFINITY,
            (_, Some(speed)) => speed,
            (_, None) => {
                return Err(refused(
                    line,
                    format!("G{motion} without a feed"),
                    "add F, in units per minute",
                ));
            }
        };
        let shape = match is_arc {
            true => self.arc(from, to, words, motion == 2, line)?,
            false => Shape::Line { from, to },
        };
        self.at = to;
        if shape.length() > 0.0 {
            self.strokes.push(Stroke {
                shape,
                speed,
                after_stop: self.stopped,
            });
            self.stopped = false;
        }
        Ok(())
    }

    fn arc(
        &self,
        from: PlanePoint,
        to: PlanePoint,
        words: &Words,
        clockwise: bool,
        line: usize,
    ) -> Result<Shape, ContourError> {
        let in_mm = |length: f64| format!("{:.4} mm", length / MILLIMETRE);
        if let Some(radius) = words.radius {
            let radius = radius * self.unit;
            let of_radius = centre(from, to, radius.abs(), clockwise, radius < 0.0);
            let Some(centre) = of_radius else {
                let [x, y] = minus(to, from);
                let found = format!(
                    "an arc of radius {} to a place {} away",
                    in_mm(radius.abs()),
                    in_mm(x.hypot(y))
                );
                return Err(refused(
                    line,
                    found,
                    "give a radius of at least half of that way; a whole turn takes I and J",
                ));
            };
            return Ok(arc(from, to, centre, clockwise));
        }
        if words.i.is_none() && words.j.is_none() {
            return Err(refused(
                line,
                "an arc without I, J or R".to_owned(),
                "add the centre, I and J from the beginning, or R",
            ));
        }
        let offset = [words.i, words.j].map(|word| word.unwrap_or(0.0) * self.unit);
        let centre = [from[0] + offset[0], from[1] + offset[1]];
        let radii = [from, to].map(|end| {
            let [x, y] = minus(end, centre);
            x.hypot(y)
        });
        let off = (radii[0] - radii[1]).abs();
        if radii[0] == 0.0 || off > OFF_CIRCLE.1.max(OFF_CIRCLE.0 * radii[0]) {
            let [begin, end] = radii.map(in_mm);
            let found = format!("an arc whose beginning is {begin} from its centre, and its end {end}");
            return Err(refused(
                line,
                found,
                "check I and J, which count from the beginning, and X and Y",
            ));
        }
        Ok(arc(from, to, centre, clockwise))
    }
}

fn refused(line: usize, found: String, remedy: &str) -> ContourError {
    ContourError::Line {
        line,
        found,
        remedy: remedy.to_owned(),
    }
}
