//! Reads the strokes of a G-code program, line by line: lines and arcs of the XY plane.
//!
//! | read | meaning |
//! |---|---|
//! | `G0`, `G1` | a line to X, Y; `G0` as fast as the axes go, `G1` at F |
//! | `G2`, `G3` | an arc to X, Y, clockwise or counter-clockwise, about I, J, or of radius R (negative: by more than half a turn); P: number of turns |
//! | `G17` | the plane of arcs; arcs of `G18` and `G19` are refused |
//! | `G20`, `G21` | inches, millimetres (which a program begins with) |
//! | `G90`, `G91`, `G90.1`, `G91.1` | absolute (which a program begins with) or relative places; centres of arcs absolute, or from the beginning (which a program begins with) |
//! | `G53` | this line in the coordinates that the program began with |
//! | `G92`, `G52` | move the origin |
//! | `G4`, `G9`, `G61`, `M0`, `M1`, `M6`, `M400` | the path stops |
//! | `G93`, `G94` | F per move, per minute |
//! | `G28`, `G30` | ignored with other axes than X and Y; `G28` without axes before the first move |
//! | `M2`, `M30` | the program ends |
//!
//! Z, E and other axes are followed only as far as X and Y depend on them: F is the speed of X, Y and Z together, and a
//! move of other axes alone is a stop of X and Y. Every other line that moves neither X nor Y is ignored; what moves
//! them and is not in the table is refused. A program begins at `(0, 0)`.
//!
//! Programs of slicers extrude (E beside X or Y). In these, moves without E are travels: they count as rapids, and G0
//! has the speed F, as in the firmware of printers. In other programs, G0 ends at rest.

mod line;

use super::ContourError;
use super::lines::{LINE_BYTES, Lines};
use super::shapes::{arc, centre};
use super::stroke::{PlanePoint, Shape, Stroke, minus};
use line::{Code, Line, Words};
use std::io::BufRead;

/// Largest distance of an arc's end from its circle, caused by the digits of programs: as a fraction of the radius, and
/// in millimetres (three digits) or inches (four).
const OFF_CIRCLE: f64 = 1e-3;
const OFF_CIRCLE_UNITS: [f64; 2] = [5e-3, 5e-4];
const MILLIMETRE: f64 = 1e-3;
const INCH: f64 = 25.4e-3;
const MINUTE_S: f64 = 60.0;
/// Largest number of turns of an arc.
const TURNS_MAX: f64 = 1e4;
/// Axes other than X and Y.
const OTHER_AXES: &[u8] = b"ZEABCUVW";

/// The strokes of a program, in m.
///
/// # Errors
/// [`ContourError::Line`] with the line that cannot be driven; [`ContourError::Empty`] for a program that moves
/// neither X nor Y.
pub fn strokes(program: &str) -> Result<Vec<Stroke>, ContourError> {
    let extrudes = extrudes(&mut program.as_bytes())?;
    let strokes: Vec<Stroke> = Program::new(Box::new(program.as_bytes()), extrudes).collect::<Result<_, _>>()?;
    if strokes.is_empty() {
        Err(ContourError::Empty("the program moves neither X nor Y".to_owned()))
    } else {
        Ok(strokes)
    }
}

/// Whether a program is one of a printer: whether a line moves E beside X or Y.
///
/// # Errors
/// [`ContourError::Read`] where it cannot be read.
pub fn extrudes(program: &mut dyn BufRead) -> Result<bool, ContourError> {
    let (mut lines, mut scratch) = (Lines::new(program), Vec::new());
    while lines.next()? {
        // This skips most lines without E quickly.
        if !lines.text.iter().any(|byte| byte.eq_ignore_ascii_case(&b'E')) {
            continue;
        }
        if let Line::Words(words) = line::read(&lines.text, &mut scratch) {
            let is_code = |code: &Code| code.letter == b'G' && code.major <= 3;
            if words.has(b'E') && words.has_any(b"XY") && words.codes.iter().all(is_code) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// Length of one unit of F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FeedMode {
    PerMinute,
    /// One over the minutes of a move.
    Inverse,
    PerTurn,
}

/// The strokes of a program, read line by line.
pub struct Program<'a> {
    lines: Lines<Box<dyn BufRead + 'a>>,
    scratch: Vec<u8>,
    extrudes: bool,
    /// Place in m, in the coordinates that the program began with.
    at: PlanePoint,
    height: f64,
    /// Offset of the program's coordinates by G92 and G52, in m.
    origin: PlanePoint,
    saved_origin: PlanePoint,
    local_origin: PlanePoint,
    unit: f64,
    relative: bool,
    centres_absolute: bool,
    plane: u32,
    exact_stops: bool,
    feed_mode: FeedMode,
    motion: Option<Code>,
    /// F, and the unit in which it was given.
    feed: Option<(f64, f64)>,
    /// Whether the path stops after the last stroke.
    stopped: bool,
    /// Whether the last stroke was G0.
    was_rapid: bool,
    has_moved: bool,
    work_offset: Option<Code>,
    ended: bool,
}

impl<'a> Program<'a> {
    /// Reads this program; `extrudes` is the result of [`extrudes`]: whether the program is for a printer.
    pub fn new(source: Box<dyn BufRead + 'a>, extrudes: bool) -> Self {
        Self {
            lines: Lines::new(source),
            scratch: Vec::new(),
            extrudes,
            at: [0.0, 0.0],
            height: 0.0,
            origin: [0.0, 0.0],
            saved_origin: [0.0, 0.0],
            local_origin: [0.0, 0.0],
            unit: MILLIMETRE,
            relative: false,
            centres_absolute: false,
            plane: 17,
            exact_stops: false,
            feed_mode: FeedMode::PerMinute,
            motion: None,
            feed: None,
            stopped: true,
            was_rapid: false,
            has_moved: false,
            work_offset: None,
            ended: false,
        }
    }

    fn refused(&self, found: String, remedy: &str) -> ContourError {
        ContourError::Line {
            line: self.lines.number,
            found,
            remedy: remedy.to_owned(),
        }
    }

    fn not_read(&self, code: Code, why: &str) -> ContourError {
        self.refused(
            format!("{code} is not read: {why}"),
            "remove it, or write the path as lines and arcs: G0 to G3",
        )
    }

    fn line(&mut self) -> Result<Option<Stroke>, ContourError> {
        if self.lines.number == 1 && (self.lines.text.starts_with(b"GCDE") || self.lines.text.contains(&0)) {
            return Err(self.refused(
                "it is not a text".to_owned(),
                "give G-code as text; slicers have a setting for binary G-code, and tools convert it",
            ));
        }
        match line::read(&self.lines.text, &mut self.scratch) {
            Line::Nothing => Ok(None),
            Line::Unreadable(text) => Err(self.refused(
                format!("`{text}` is not read"),
                "give a program without loops, calls and jogs",
            )),
            Line::Named { name, has_place } if has_place => Err(self.refused(
                format!("`{name}` has X or Y, but posicast does not know what it does with them"),
                "remove it, or replace it by what it does",
            )),
            Line::Named { .. } => Ok(None),
            Line::Words(words) => self.words(&words),
        }
    }

    fn words(&mut self, words: &Words) -> Result<Option<Stroke>, ContourError> {
        if let Some(first) = words.codes.first().filter(|code| code.letter == b'M') {
            self.miscellaneous(*first, words)?;
            // Only M codes of machine tools may share a line with other codes; all others take the rest of the line as parameters.
            let is_alone = !matches!(first.major, 2..=11 | 19 | 48..=53 | 60..=68) || words.bad.is_some();
            if is_alone || self.ended {
                return Ok(None);
            }
        }
        let mut axes_are_its_own = false;
        let (mut is_machine_place, mut is_exact) = (false, false);
        let mut motions = 0;
        for code in &words.codes {
            match (code.letter, code.major, code.minor) {
                (b'G', 53, 0) => is_machine_place = true,
                (b'G', 9, 0) => is_exact = true,
                (b'G', 0..=3, 0) => {
                    motions += u32::from(self.motion != Some(*code) || motions == 0);
                    self.motion = Some(*code);
                }
                (b'G', ..) => axes_are_its_own |= self.general(*code, words)?,
                _ if words.codes.first() != Some(code) => self.miscellaneous(*code, words)?,
                _ => (),
            }
        }
        if axes_are_its_own {
            return Ok(None);
        }
        if let Some(feed) = words.number(b'F') {
            self.feed = Some((feed, self.unit));
        }
        let is_arc = self.motion.is_some_and(|motion| matches!(motion.major, 2 | 3));
        let in_other_plane = self.plane != 17 && words.has_any(b"ZKR");
        let moves = words.has_any(b"XY") || is_arc && (words.has_any(b"IJ") || in_other_plane);
        if let Some(bad) = words
            .bad
            .as_ref()
            .filter(|_| moves || motions > 0 || words.codes.is_empty())
        {
            return Err(self.refused(
                bad.clone(),
                "give words of a letter and a number: variables, expressions and polar places are not read",
            ));
        }
        let height = words.number(b'Z').map(|z| {
            let z = z * self.unit;
            if self.relative { self.height + z } else { z }
        });
        if !moves {
            // While other axes move, X and Y stand.
            self.stopped |= words.has_any(OTHER_AXES) && self.motion.is_some();
            self.height = height.unwrap_or(self.height);
            return Ok(None);
        }
        if motions > 1 {
            return Err(self.refused("two of G0, G1, G2 and G3".to_owned(), "write two lines"));
        }
        if words.is_optional {
            let found = "`/`: a switch of the controller decides whether this line runs";
            return Err(self.refused(found.to_owned(), "remove the line, or its `/`"));
        }
        if self.lines.is_cut {
            return Err(self.refused(format!("a line of more than {LINE_BYTES} bytes"), "divide it"));
        }
        let stroke = self.moved(words, height, is_machine_place)?;
        self.stopped |= (is_exact || self.exact_stops) && stroke.is_some();
        Ok(stroke)
    }

    /// Follows an M code.
    fn miscellaneous(&mut self, code: Code, words: &Words) -> Result<(), ContourError> {
        let shifts = || words.has_any(b"XY");
        match code.major {
            2 | 30 => self.ended = true,
            0 | 1 | 6 | 60 | 400 | 600 => self.stopped = true,
            97 => return Err(self.not_read(code, "it calls another program")),
            98 if words.number(b'P').is_some() => return Err(self.not_read(code, "it calls another program")),
            206 | 218 | 290 if shifts() => return Err(self.not_read(code, "it moves the origin of X or Y")),
            _ => (),
        }
        Ok(())
    }

    /// Follows a G code other than G0 to G3; returns whether the axes of the line are its own.
    fn general(&mut self, code: Code, words: &Words) -> Result<bool, ContourError> {
        let has_place = words.has_any(b"XY");
        let other_axes = words.has_any(b"ZABCUV");
        match (code.major, code.minor) {
            (4, 0) | (29, _) => {
                self.stopped = true;
                return Ok(true);
            }
            (10 | 11, 0) => {
                if has_place {
                    return Err(self.not_read(code, "it sets an origin of X or Y"));
                }
                self.stopped = true;
                return Ok(true);
            }
            (28, 0) => {
                if words.has_any(b"XY") {
                    return Err(self.not_read(code, "it takes X or Y to its reference"));
                }
                if !other_axes && self.has_moved {
                    return Err(self.not_read(code, "it takes X and Y to their reference"));
                }
                self.stopped = true;
                return Ok(true);
            }
            (30, 0) => {
                if has_place || !other_axes {
                    return Err(self.not_read(code, "it takes X or Y to its second reference"));
                }
                self.stopped = true;
                return Ok(true);
            }
            (28 | 30, 1) => return Ok(true),
            (52, 0) => {
                for (axis, letter) in [b'X', b'Y'].into_iter().enumerate() {
                    self.local_origin[axis] = self.word(words, letter)?.unwrap_or(self.local_origin[axis]);
                }
                return Ok(true);
            }
            (92, _) => {
                self.set_origin(code, words)?;
                return Ok(true);
            }
            (17..=19, 0) => self.plane = code.major,
            (20, 0) => self.unit = INCH,
            (21, 0) => self.unit = MILLIMETRE,
            (90, 0) => self.relative = false,
            (91, 0) => self.relative = true,
            (90, 1) => self.centres_absolute = true,
            (91, 1) => self.centres_absolute = false,
            (61, _) if words.has(b'S') || has_place && self.motion.is_none() => {
                return Err(self.not_read(code, "printers return to a saved place at it"));
            }
            (61, _) => self.exact_stops = true,
            (64, 0) => self.exact_stops = false,
            (93, 0) => self.feed_mode = FeedMode::Inverse,
            (94, 0) => self.feed_mode = FeedMode::PerMinute,
            (95, 0) => self.feed_mode = FeedMode::PerTurn,
            (54..=59, _) => {
                if self.has_moved && self.work_offset.is_some_and(|before| before != code) {
                    return Err(self.not_read(code, "how far it is from the one before is not known"));
                }
                self.work_offset = Some(code);
            }
            (7 | 12 | 13 | 16 | 26 | 27 | 41 | 42 | 51 | 68, _) => {
                return Err(self.not_read(code, "it changes where X and Y go"));
            }
            (8 | 15 | 40 | 43 | 49 | 50 | 69 | 96..=99, _) => (),
            // Without X and Y, codes of this number check or level the bed of a printer.
            (80, 0) => {
                self.motion = None;
                return Ok(true);
            }
            (5 | 33 | 38 | 73..=76 | 81..=89, _) if !has_place => self.motion = Some(code),
            _ if has_place || words.has_any(b"IJ") => {
                return Err(self.not_read(code, "how it moves X and Y is not known"));
            }
            _ => return Ok(true),
        }
        Ok(false)
    }

    /// G92: this place has the given coordinates from now on.
    fn set_origin(&mut self, code: Code, words: &Words) -> Result<(), ContourError> {
        match code.minor {
            0 => {
                // Without any axis, printers set all to 0.
                let all = !words.has_any(b"XY") && !words.has_any(OTHER_AXES);
                for (axis, letter) in [b'X', b'Y'].into_iter().enumerate() {
                    let here = if all { Some(0.0) } else { self.word(words, letter)? };
                    if let Some(here) = here {
                        self.origin[axis] = self.at[axis] - self.local_origin[axis] - here;
                        self.saved_origin[axis] = self.origin[axis];
                    }
                }
                self.height = words.number(b'Z').map_or(self.height, |z| z * self.unit);
            }
            1 => (self.origin, self.saved_origin) = ([0.0, 0.0], [0.0, 0.0]),
            2 => self.origin = [0.0, 0.0],
            3 => self.origin = self.saved_origin,
            _ => return Err(self.not_read(code, "it moves the origin")),
        }
        Ok(())
    }

    /// The number of a letter as a length in m.
    fn word(&self, words: &Words, letter: u8) -> Result<Option<f64>, ContourError> {
        match (words.has(letter), words.number(letter)) {
            (false, _) => Ok(None),
            (true, Some(number)) => Ok(Some(number * self.unit)),
            (true, None) => Err(self.refused(
                format!("`{}` has no number", char::from(letter)),
                "give words of a letter and a number",
            )),
        }
    }

    fn moved(
        &mut self,
        words: &Words,
        height: Option<f64>,
        is_machine_place: bool,
    ) -> Result<Option<Stroke>, ContourError> {
        let Some(motion) = self.motion else {
            return Err(self.refused(
                "a place before the first of G0, G1, G2, G3".to_owned(),
                "say how to move there: G1 with F, for example",
            ));
        };
        if motion.major > 3 {
            return Err(self.not_read(motion, "how it moves X and Y is not known"));
        }
        let from = self.at;
        let mut to = from;
        for (axis, letter) in [b'X', b'Y'].into_iter().enumerate() {
            to[axis] = match self.word(words, letter)? {
                None => from[axis],
                Some(word) if is_machine_place => word,
                Some(word) if self.relative => from[axis] + word,
                Some(word) => word + self.origin[axis] + self.local_origin[axis],
            };
        }
        let shape = match motion.major {
            2 | 3 => self.arc(from, to, words, motion.major == 2)?,
            _ => Shape::Line { from, to },
        };
        let length = shape.length();
        let climb = height.map_or(0.0, |height| height - self.height);
        let speed = self.speed(motion, length, climb)?;
        self.at = to;
        self.height += climb;
        if length == 0.0 {
            // Z or E alone.
            self.stopped |= words.has_any(OTHER_AXES);
            return Ok(None);
        }
        if !length.is_finite() {
            return Err(self.refused("a place that is too far away".to_owned(), "give smaller numbers"));
        }
        let is_rapid = motion.major == 0;
        let stroke = Stroke {
            shape,
            speed,
            after_stop: self.stopped || !self.extrudes && is_rapid != self.was_rapid,
            rapid: is_rapid || self.extrudes && !words.has(b'E'),
        };
        (self.stopped, self.was_rapid, self.has_moved) = (false, is_rapid, true);
        Ok(Some(stroke))
    }

    /// Speed in the plane, in m/s, of a move of this length in the plane that climbs in Z.
    fn speed(&self, motion: Code, length: f64, climb: f64) -> Result<f64, ContourError> {
        let is_rapid = motion.major == 0;
        if is_rapid && !(self.extrudes && self.feed.is_some()) || length == 0.0 {
            return Ok(f64::INFINITY);
        }
        let Some((feed, unit)) = self.feed else {
            return Err(self.refused(format!("{motion} without a feed"), "add F, in units per minute"));
        };
        if feed <= 0.0 {
            return Err(self.refused(format!("F{feed}"), "give a feed above 0, in units per minute"));
        }
        let speed = match self.feed_mode {
            FeedMode::PerMinute => feed * unit / MINUTE_S * (length / length.hypot(climb)),
            FeedMode::Inverse => feed * length / MINUTE_S,
            FeedMode::PerTurn => {
                return Err(self.refused(
                    "G95: F is per turn of the spindle, whose speed is not known".to_owned(),
                    "give feeds per minute (G94)",
                ));
            }
        };
        if speed > 0.0 && speed.is_finite() {
            Ok(speed)
        } else {
            Err(self.refused(format!("F{feed}"), "give another feed"))
        }
    }

    fn arc(&self, from: PlanePoint, to: PlanePoint, words: &Words, clockwise: bool) -> Result<Shape, ContourError> {
        if self.plane != 17 {
            return Err(self.refused(
                format!("an arc in the plane of G{}, which moves X or Y unevenly", self.plane),
                "write it as lines, or in the plane of X and Y (G17)",
            ));
        }
        let turns = words.number(b'P').unwrap_or(1.0);
        if !(1.0..=TURNS_MAX).contains(&turns) || turns.fract() != 0.0 {
            return Err(self.refused(
                format!("an arc of P{turns} turns"),
                "give a whole number of turns, from 1",
            ));
        }
        let shape = match self.word(words, b'R')? {
            Some(radius) => self.arc_of_radius(from, to, radius, clockwise)?,
            None => self.arc_about_centre(from, to, words, clockwise)?,
        };
        let Shape::Arc {
            centre,
            radius,
            begin,
            sweep,
        } = shape
        else {
            return Ok(shape);
        };
        Ok(Shape::Arc {
            centre,
            radius,
            begin,
            sweep: sweep + (turns - 1.0) * std::f64::consts::TAU.copysign(sweep),
        })
    }

    fn arc_of_radius(
        &self,
        from: PlanePoint,
        to: PlanePoint,
        radius: f64,
        clockwise: bool,
    ) -> Result<Shape, ContourError> {
        match centre(from, to, radius.abs(), clockwise, radius < 0.0) {
            Some(centre) => Ok(arc(from, to, centre, clockwise)),
            None => {
                let [x, y] = minus(to, from);
                let [radius, chord] = [radius.abs(), x.hypot(y)].map(in_mm);
                Err(self.refused(
                    format!("an arc of radius {radius} to a place {chord} away"),
                    "give a radius of at least half of that distance; a full circle needs I and J",
                ))
            }
        }
    }

    fn arc_about_centre(
        &self,
        from: PlanePoint,
        to: PlanePoint,
        words: &Words,
        clockwise: bool,
    ) -> Result<Shape, ContourError> {
        let given = [self.word(words, b'I')?, self.word(words, b'J')?];
        if given == [None, None] {
            return Err(self.refused(
                "an arc without I, J or R".to_owned(),
                "add the centre, I and J from the beginning, or R",
            ));
        }
        let centre: PlanePoint = std::array::from_fn(|axis| match (given[axis], self.centres_absolute) {
            (Some(place), true) => place + self.origin[axis] + self.local_origin[axis],
            (offset, _) => from[axis] + offset.unwrap_or(0.0),
        });
        let radii = [from, to].map(|end| {
            let [x, y] = minus(end, centre);
            x.hypot(y)
        });
        let rounding = OFF_CIRCLE_UNITS[usize::from(self.unit == INCH)] * self.unit;
        let off = (radii[0] - radii[1]).abs();
        if radii[0] == 0.0 || off > rounding.max(OFF_CIRCLE * radii[0]) {
            let [begin, end] = radii.map(in_mm);
            return Err(self.refused(
                format!("an arc whose beginning is {begin} from its centre, and its end {end}"),
                "check I and J, which count from the beginning unless G90.1 says otherwise, and X and Y",
            ));
        }
        // The centre of the same arc that is equally far from both ends, so that the path has no gap.
        let (chord, middle) = (minus(to, from), [0, 1].map(|axis| f64::midpoint(from[axis], to[axis])));
        let square = chord[0] * chord[0] + chord[1] * chord[1];
        let off = minus(centre, middle);
        let along = (off[0] * chord[0] + off[1] * chord[1]) / square;
        let centre = if square > 0.0 && along.is_finite() {
            [centre[0] - along * chord[0], centre[1] - along * chord[1]]
        } else {
            centre
        };
        Ok(arc(from, to, centre, clockwise))
    }
}

fn in_mm(length: f64) -> String {
    format!("{:.4} mm", length / MILLIMETRE)
}

impl Iterator for Program<'_> {
    type Item = Result<Stroke, ContourError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            let stroke = match self.lines.next() {
                Ok(true) => self.line(),
                Ok(false) => {
                    self.ended = true;
                    Ok(None)
                }
                Err(error) => Err(error),
            };
            self.ended |= stroke.is_err();
            if let Some(stroke) = stroke.transpose() {
                return Some(stroke);
            }
        }
        None
    }
}
