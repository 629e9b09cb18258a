//! Plans strokes as runs between stops, with the command in each sample.
//!
//! The path stops where a program says so and at sharp bends ([`CornerRules`]). In between, the speed changes by
//! ramps of limited acceleration and jerk, with
//!
//! ```text
//! v ≤ feed,   v² κ ≤ a/√2,   v³ κ² ≤ j/√8       κ: the curvature of an arc
//! a_t ≤ min(a/√2, j/(3√2 v κ)),   j_t ≤ j/√8      along the path
//! ```
//!
//! so that acceleration and jerk of the path, along and across it together, stay within `a` and `j` of the weaker
//! axis. Where an arc begins or ends at a line, the acceleration across the path steps by `v² κ`; at a bend, the
//! velocity steps.
//!
//! A ramp may span any number of strokes. It ends, with acceleration 0, where the feed or the limit of an arc changes
//! and at those bends that would otherwise be passed too fast. They are found one by one: the slowest bend of each
//! ramp that exceeds it divides the ramp, until none does.
//!
//! Strokes are read as they are needed: up to the next stop, or at most [`LOOK_AHEAD`] of them. Then the first half is
//! driven as if the path stopped after the second half.

use super::ContourError;
use super::corners::{Corner, CornerRules, Corners};
use super::ramp::{Along, Ramps};
use super::stroke::{PlanePoint, Shape, Stroke};
use crate::machine_file::{AxisSection, Machine};
use crate::motion::{SAMPLES_MAX, motion_limits};

/// Largest number of strokes that are planned together.
const LOOK_AHEAD: usize = 1 << 15;
/// Relative difference below which two limits are equal: inches and millimetres round differently.
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

    /// Largest speed on a stroke, and the acceleration along it.
    fn on(&self, stroke: &Stroke) -> (f64, f64) {
        let (speed, across) = (stroke.speed.min(self.velocity), self.across());
        match stroke.shape {
            Shape::Line { .. } => (speed, across),
            Shape::Arc { radius, .. } => {
                let speed = speed.min(self.on_curve(radius));
                (speed, across.min(self.jerk * radius / (3.0 * 2f64.sqrt() * speed)))
            }
        }
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

/// A line or an arc at its place along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// Distance along the path at which it begins, m.
    pub(super) begin: f64,
    pub(super) shape: Shape,
    pub(super) rapid: bool,
    /// The speed at which it counts as driven at full speed, m/s.
    pub(super) full: f64,
}

/// A part of a path that one pair of ramps covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    /// Distance along the path at which it begins, m.
    pub(super) begin: f64,
    pub(super) ramps: Ramps,
}

/// A planned part of a path.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) strokes: Vec<Placed>,
    pub(super) spans: Vec<Span>,
    /// Whether it begins at rest.
    pub(super) from_rest: bool,
}

impl Run {
    pub(super) fn duration_s(&self) -> f64 {
        self.spans.iter().map(|span| span.ramps.duration_s()).sum()
    }
}

/// A stroke that is not planned yet.
#[derive(Debug, Clone, Copy)]
struct Limited {
    placed: Placed,
    end: f64,
    /// Largest speed at its beginning and on it.
    corner: f64,
    most: f64,
    acceleration: f64,
}

impl Limited {
    /// Whether two strokes have the same limits.
    fn is_like(&self, other: &Self) -> bool {
        is_same(self.most, other.most) && is_same(self.acceleration, other.acceleration)
    }
}

/// Plans the strokes of a path, each of which begins where the last one ends.
pub(super) struct Planner<I> {
    corners: Corners<I>,
    limits: ContourLimits,
    /// Strokes that are read and not planned.
    read: Vec<Limited>,
    /// The stroke after the next stop.
    next: Option<Limited>,
    /// Speed at the beginning of the first of them.
    speed: f64,
    length: f64,
    failed: Option<ContourError>,
    ended: bool,
}

impl<I: Iterator<Item = Result<Stroke, ContourError>>> Planner<I> {
    pub(super) fn new(strokes: I, limits: ContourLimits, rules: CornerRules) -> Self {
        Self {
            corners: Corners::new(strokes, rules, limits),
            limits,
            read: Vec::new(),
            next: None,
            speed: 0.0,
            length: 0.0,
            failed: None,
            ended: false,
        }
    }

    fn limited(&mut self, stroke: &Stroke, corner: Corner) -> Limited {
        let (most, acceleration) = self.limits.on(stroke);
        let begin = self.length;
        self.length += stroke.shape.length();
        Limited {
            placed: Placed {
                begin,
                shape: stroke.shape,
                rapid: stroke.rapid,
                full: stroke.speed.min(self.limits.velocity),
            },
            end: self.length,
            corner: match corner {
                Corner::Stop => 0.0,
                Corner::Speed(speed) => speed.min(most),
            },
            most,
            acceleration,
        }
    }

    /// Reads strokes up to the next stop, the look-ahead or the end.
    fn read(&mut self) {
        self.read.extend(self.next.take());
        while self.next.is_none() && self.read.len() < LOOK_AHEAD && !self.ended {
            match self.corners.next() {
                Some(Ok((stroke, corner))) => {
                    let limited = self.limited(&stroke, corner);
                    if limited.corner == 0.0 && !self.read.is_empty() {
                        self.next = Some(limited)
                    } else {
                        self.read.push(limited)
                    }
                }
                Some(Err(error)) => (self.failed, self.ended) = (Some(error), true),
                None => self.ended = true,
            }
        }
    }

    /// Ends of ramps with the speeds there, as indices of strokes: the first begins at `self.speed`, the last is the
    /// end of what was read, at rest.
    fn knots(&self) -> Vec<(usize, f64)> {
        let strokes = &self.read;
        let changes = (1..strokes.len()).filter(|at| !strokes[*at].is_like(&strokes[at - 1]));
        let slower = |at: usize| strokes[at].corner.min(strokes[at - 1].most);
        let mut knots: Vec<(usize, f64)> = std::iter::once((0, self.speed))
            .chain(changes.map(|at| (at, slower(at))))
            .chain([(strokes.len(), 0.0)])
            .collect();
        // Bends within a stretch of equal limits that are slower than it.
        let bends: Vec<usize> = (1..strokes.len())
            .filter(|at| strokes[*at].corner < strokes[*at].most && strokes[*at].is_like(&strokes[at - 1]))
            .collect();
        loop {
            self.attain(&mut knots);
            let mut bend = bends.iter().copied().peekable();
            let mut found = Vec::new();
            for pair in knots.windows(2) {
                let (begin, end) = (pair[0].0, pair[1].0);
                let mut slowest: Option<(usize, f64, usize)> = None;
                let mut ramps = None;
                while let Some(at) = bend.next_if(|at| *at < end) {
                    if at == begin {
                        continue;
                    }
                    let ramps = ramps.get_or_insert_with(|| self.ramps(pair[0], pair[1]));
                    let speed = strokes[at].corner;
                    // Of equal ones the one in the middle: each round then halves the ramps.
                    let off_middle = (2 * at).abs_diff(begin + end);
                    let is_slower =
                        slowest.is_none_or(|(_, slowest, off)| speed < slowest || speed == slowest && off_middle < off);
                    if is_slower && ramps.exceeds(strokes[at].placed.begin - strokes[begin].placed.begin, speed) {
                        slowest = Some((at, speed, off_middle));
                    }
                }
                found.extend(slowest.map(|(at, speed, _)| (at, speed)));
            }
            if found.is_empty() {
                return knots;
            }
            knots.extend(found);
            knots.sort_unstable_by_key(|(at, _)| *at);
        }
    }

    /// Lowers the speeds to those that are reached from the knots on both sides.
    fn attain(&self, knots: &mut [(usize, f64)]) {
        for at in 1..knots.len() {
            let (before, here) = (knots[at - 1], knots[at]);
            knots[at].1 = self.reach(before, here, here.1);
        }
        for at in (1..knots.len()).rev() {
            let (here, after) = (knots[at - 1], knots[at]);
            // The speed at the beginning is given; the plan before it left room to stop.
            if at > 1 {
                knots[at - 1].1 = self.reach(after, here, here.1);
            }
        }
    }

    /// The largest speed, up to `most`, at one knot that is reached from the other.
    fn reach(&self, from: (usize, f64), to: (usize, f64), most: f64) -> f64 {
        let (first, last) = (from.0.min(to.0), from.0.max(to.0) - 1);
        let length = self.read[last].end - self.read[first].placed.begin;
        self.along(first).reach(from.1, length, most)
    }

    fn along(&self, stroke: usize) -> Along {
        Along {
            acceleration: self.read[stroke].acceleration,
            jerk: self.limits.part_of_jerk(),
        }
    }

    fn ramps(&self, (first, from): (usize, f64), (end, to): (usize, f64)) -> Ramps {
        let length = self.read[end - 1].end - self.read[first].placed.begin;
        Ramps::new(length, [from, to], self.read[first].most, &self.along(first))
    }

    /// Plans what was read; up to the middle if the path does not stop there.
    fn run(&mut self) -> Run {
        let stops = self.next.is_some() || self.ended;
        let mut knots = self.knots();
        let from_rest = self.speed == 0.0;
        let mut planned = self.read.len();
        self.speed = 0.0;
        if !stops {
            planned = planned.div_ceil(2);
            let whole = knots.partition_point(|(at, _)| *at <= planned);
            let (before, after) = (knots[whole - 1], knots[whole]);
            if before.0 < planned {
                // Here the first half ends, with acceleration 0 as at every knot.
                let here = (planned, self.read[planned].corner.min(self.read[planned - 1].most));
                let speed = self.reach(before, here, here.1).min(self.reach(after, here, here.1));
                knots.truncate(whole);
                knots.push((planned, speed));
            } else {
                knots.truncate(whole);
            }
            self.speed = knots.last().map_or(0.0, |knot| knot.1);
        }
        let spans = knots.windows(2).map(|pair| Span {
            begin: self.read[pair[0].0].placed.begin,
            ramps: self.ramps(pair[0], pair[1]),
        });
        let spans = spans.collect();
        let strokes = self.read.drain(..planned).map(|limited| limited.placed).collect();
        Run {
            strokes,
            spans,
            from_rest,
        }
    }
}

impl<I: Iterator<Item = Result<Stroke, ContourError>>> Iterator for Planner<I> {
    type Item = Result<Run, ContourError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.read();
        if self.read.is_empty() {
            self.failed.take().map(Err)
        } else {
            Some(Ok(self.run()))
        }
    }
}

fn is_same(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().min(b.abs())
}

/// Figures of a path that are known before it is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Start of the path.
    pub begin: PlanePoint,
    /// Length of the path, m.
    pub length: f64,
    /// Length of the rapids in it, m.
    pub rapid_length: f64,
    /// Duration of the command, s.
    pub duration_s: f64,
    /// Number of stops on the way.
    pub stops: usize,
    /// Smallest and largest coordinate that the path reaches, `[low, high]` for each axis.
    pub extent: [[f64; 2]; 2],
}

impl Survey {
    /// Plans a path without driving it.
    ///
    /// # Errors
    /// Those of the strokes, and [`ContourError::Empty`] without strokes or with a path of no length.
    pub fn new(
        strokes: &mut dyn Iterator<Item = Result<Stroke, ContourError>>,
        limits: &ContourLimits,
        rules: &CornerRules,
    ) -> Result<Self, ContourError> {
        let mut survey = Self::nothing();
        for run in Planner::new(strokes, *limits, *rules) {
            survey.add(&run?);
        }
        survey.checked()
    }

    fn nothing() -> Self {
        Self {
            begin: [0.0, 0.0],
            length: 0.0,
            rapid_length: 0.0,
            duration_s: 0.0,
            stops: 0,
            extent: [[f64::INFINITY, f64::NEG_INFINITY]; 2],
        }
    }

    fn add(&mut self, run: &Run) {
        if self.length == 0.0 {
            self.begin = run.strokes.first().map_or([0.0, 0.0], |first| first.shape.at(0.0));
        } else if run.from_rest {
            self.stops += 1;
        }
        for Placed { shape, rapid, .. } in &run.strokes {
            self.length += shape.length();
            self.rapid_length += if *rapid { shape.length() } else { 0.0 };
            shape.extend(&mut self.extent);
        }
        self.duration_s += run.duration_s();
    }

    fn checked(self) -> Result<Self, ContourError> {
        if !self.duration_s.is_finite() {
            return Err(ContourError::TooLong {
                seconds: self.duration_s,
                most: SAMPLES_MAX as u64,
            });
        }
        if self.length > 0.0 && self.length.is_finite() {
            Ok(self)
        } else {
            Err(ContourError::Empty("it has no length".to_owned()))
        }
    }

    /// Checks that the travel of both axes covers the whole path.
    ///
    /// # Errors
    /// [`ContourError::Travel`] with the axis whose travel is too short.
    pub fn check_travel(&self, machine: &Machine) -> Result<(), ContourError> {
        for (axis, [least, most]) in plane(machine)?.into_iter().zip(self.extent) {
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
    /// Index of the stroke, counted from the first one of the path that has a length.
    pub(super) stroke: usize,
    /// Whether a feed is driven at full speed.
    pub(super) is_full: bool,
}

/// A stroke counts as driven at full speed from this fraction of the commanded speed on.
const FULL: f64 = 0.999;

/// The command of planned runs, sample by sample.
#[derive(Debug, Clone)]
pub(super) struct Sampler {
    sample_s: f64,
    /// Time of the next sample, from the beginning of the run.
    time_s: f64,
    /// Number of strokes in the runs before.
    strokes_before: usize,
    last: Option<ContourSample>,
}

impl Sampler {
    pub(super) fn new(sample_s: f64) -> Self {
        Self {
            sample_s,
            time_s: 0.0,
            strokes_before: 0,
            last: None,
        }
    }

    /// Passes on the samples that lie within a run: from its beginning to before its end.
    pub(super) fn run(&mut self, run: &Run, mut each: impl FnMut(ContourSample)) {
        let mut stroke = 0;
        for span in &run.spans {
            let duration_s = span.ramps.duration_s();
            while self.time_s < duration_s {
                let (length, speed) = span.ramps.after(self.time_s);
                let along = span.begin + length;
                while run.strokes.get(stroke + 1).is_some_and(|next| along >= next.begin) {
                    stroke += 1;
                }
                let placed = &run.strokes[stroke];
                let sample = ContourSample {
                    along,
                    speed,
                    at: placed
                        .shape
                        .at((along - placed.begin).clamp(0.0, placed.shape.length())),
                    stroke: self.strokes_before + stroke,
                    is_full: !placed.rapid && speed >= FULL * placed.full,
                };
                each(sample);
                self.time_s += self.sample_s;
            }
            self.time_s -= duration_s;
        }
        self.strokes_before += run.strokes.len();
        if let Some(placed) = run.strokes.last() {
            let length = placed.shape.length();
            self.last = Some(ContourSample {
                along: placed.begin + length,
                speed: 0.0,
                at: placed.shape.at(length),
                stroke: self.strokes_before - 1,
                is_full: false,
            });
        }
    }

    /// The sample at rest at the end of all runs.
    pub(super) fn at_end(&self) -> Option<ContourSample> {
        self.last
    }
}

/// A path with its motion in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    runs: Vec<Run>,
    survey: Survey,
}

impl Contour {
    /// Plans the path of these strokes, each of which begins where the last one ends.
    ///
    /// # Errors
    /// [`ContourError::Empty`] without strokes or with a path of no length.
    pub fn new(strokes: &[Stroke], limits: &ContourLimits, rules: &CornerRules) -> Result<Self, ContourError> {
        let mut survey = Survey::nothing();
        let mut runs = Vec::new();
        for run in Planner::new(strokes.iter().copied().map(Ok), *limits, *rules) {
            let run = run?;
            survey.add(&run);
            runs.push(run);
        }
        let survey = survey.checked()?;
        Ok(Self { runs, survey })
    }

    /// Its length, duration, stops and extent.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Its lines and arcs.
    pub(super) fn placed(&self) -> impl Iterator<Item = &Placed> {
        self.runs.iter().flat_map(|run| &run.strokes)
    }

    /// The command at each sample, from the start to `settle_s` seconds after the end.
    ///
    /// # Errors
    /// [`ContourError::TooLong`] for more samples than are held in memory.
    pub fn samples(&self, sample_s: f64, settle_s: f64) -> Result<Vec<ContourSample>, ContourError> {
        let seconds = self.survey.duration_s + settle_s;
        let count = (seconds / sample_s).ceil();
        if count.is_nan() || count >= SAMPLES_MAX as f64 {
            return Err(ContourError::TooLong {
                seconds,
                most: SAMPLES_MAX as u64,
            });
        }
        let mut samples = Vec::with_capacity(count as usize + 1);
        let mut sampler = Sampler::new(sample_s);
        for run in &self.runs {
            sampler.run(run, |sample| samples.push(sample));
        }
        let last = sampler.at_end();
        let missing = (count as usize + 1).saturating_sub(samples.len());
        samples.extend(last.into_iter().cycle().take(missing));
        Ok(samples)
    }
}
