//! `posicast simulate --contour`: a path of two axes, and the deviation from it that shapers cause.

mod file;
mod report;

use crate::failure::Failure;
use crate::observer::{Late, Observer};
use crate::plot;
use file::PathFile;
use posicast_machine::contour::{
    self, Contour, ContourError, ContourLimits, CornerRules, Stroke, Survey, gcode, shapes,
};
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::SAMPLES_MAX;
use posicast_machine::unit::AxisUnit;
use posicast_testbench::wave::write_text;
pub use report::Document;
use report::Report;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Default speed along a path, as a fraction of the slower axis's limit.
const PART_OF_VELOCITY: f64 = 0.4;
/// Default size of a circle or square, as a fraction of the smaller travel, and in m if there is no travel.
const PART_OF_TRAVEL: f64 = 0.25;
const SIZE_M: f64 = 0.02;
/// Number of strokes between two looks at the progress of reading.
const STROKES_LOOK: u32 = 1024;
/// File name extensions of G-code.
const GCODE_ENDINGS: [&str; 9] = ["gcode", "gco", "gc", "g", "nc", "ngc", "tap", "cnc", "bgcode"];

/// How the axes pass bends of the path.
#[derive(Debug, Default, Clone, Copy)]
pub struct Corners {
    /// Distance by which a cut corner could miss the bend if it were passed within the acceleration (junction deviation), which determines
    /// the speed, in the unit of the first axis; 0: stop at every bend; `None`: 0.01 mm, as grbl.
    pub tolerance: Option<f64>,
    /// Angle in degrees above which the axes stop at a bend of the path; 180: only the tolerance decides, as in printer firmware; `None`:
    /// 45.
    pub stop_angle_deg: Option<f64>,
}

impl Corners {
    /// The options that were given, with their values, as on a command line.
    pub(crate) fn given(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let options = [
            ("corner-tolerance", self.tolerance),
            ("stop-angle", self.stop_angle_deg),
        ];
        options.into_iter().filter_map(|(name, value)| Some((name, value?)))
    }

    fn rules(&self, unit: AxisUnit) -> Result<CornerRules, Failure> {
        let tolerance = self.tolerance.map(|tolerance| unit.to_si(tolerance));
        let stop_angle = self.stop_angle_deg.map(f64::to_radians);
        for (option, value, most, remedy) in [
            ("--corner-tolerance", tolerance, f64::MAX, "give a length from 0 on"),
            (
                "--stop-angle",
                stop_angle,
                std::f64::consts::PI,
                "give an angle from 0 to 180 degrees",
            ),
        ] {
            if value.is_some_and(|value| !(0.0..=most).contains(&value)) {
                return Err(refused(option, "outside its range", remedy));
            }
        }
        let default = CornerRules::default();
        Ok(CornerRules {
            tolerance: tolerance.unwrap_or(default.tolerance),
            stop_angle: stop_angle.unwrap_or(default.stop_angle),
        })
    }
}

/// A path of the first two axes, and its sizes.
#[derive(Debug, Clone, Default)]
pub struct PathOptions {
    /// `circle`, `square`, a CSV file of points `x,y` in the axes' units, or a G-code file.
    pub contour: Option<String>,
    /// Radius of the circle, in the unit of the first axis; `None`: an eighth of the smaller travel, else 10 mm.
    pub radius: Option<f64>,
    /// Side of the square, in the unit of the first axis; `None`: a quarter of the smaller travel, else 20 mm.
    pub side: Option<f64>,
    /// The SVG file into which the errors over time are drawn.
    pub plot: Option<PathBuf>,
    /// How bends are passed.
    pub corners: Corners,
}

/// The path to drive.
enum Path2d<'a> {
    Circle,
    Square,
    Points(&'a Path),
    Gcode(&'a Path),
}

impl PathOptions {
    /// Refuses the options of a path if there is none. The parser accepts them beside an option that excludes `--contour`.
    pub(crate) fn only_with_a_path(&self) -> Result<(), Failure> {
        let given = [
            ("--radius", self.radius.is_some()),
            ("--side", self.side.is_some()),
            ("--plot", self.plot.is_some()),
            ("--corner-tolerance", self.corners.tolerance.is_some()),
            ("--stop-angle", self.corners.stop_angle_deg.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((option, _)) if self.contour.is_none() => {
                Err(Failure::input(format!("{option}: this option belongs to --contour"))
                    .with_help(format!("leave out {option}, or give a path with --contour")))
            }
            _ => Ok(()),
        }
    }

    /// The file of the path, if it comes from one.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self.kind()? {
            Path2d::Points(path) | Path2d::Gcode(path) => Some(path),
            Path2d::Circle | Path2d::Square => None,
        }
    }

    fn kind(&self) -> Option<Path2d<'_>> {
        let word = self.contour.as_deref()?;
        let path = Path::new(word);
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        Some(match (word, ending.as_deref()) {
            ("circle", _) => Path2d::Circle,
            ("square", _) => Path2d::Square,
            (_, Some(ending)) if GCODE_ENDINGS.contains(&ending) => Path2d::Gcode(path),
            _ => Path2d::Points(path),
        })
    }

    /// Plans the path within the limits and the travel of the machine, from `(0, 0)`, in memory.
    pub(crate) fn planned(
        &self,
        machine: &Machine,
        speed: Option<f64>,
        observer: &dyn Observer,
    ) -> Result<Contour, Failure> {
        let path = self.read(machine, speed)?;
        let survey = path.survey(machine, observer)?;
        let samples = survey.duration_s * machine.clock.sample_hz;
        if samples > SAMPLES_MAX as f64 {
            let error = ContourError::TooLong {
                seconds: survey.duration_s,
                most: SAMPLES_MAX as u64,
            };
            return Err(path.failure(&error));
        }
        let strokes = path.strokes()?.collect::<Result<Vec<Stroke>, _>>();
        let mut strokes = strokes.map_err(|error| path.failure(&error))?;
        if survey.begin != [0.0, 0.0] {
            strokes.iter_mut().take(1).for_each(|first| first.after_stop = true);
            strokes.insert(0, shapes::approach(survey.begin));
        }
        let planned = Contour::new(&strokes, &path.limits, &path.rules);
        let planned = planned.and_then(|contour| contour.survey().check_travel(machine).map(|()| contour));
        planned.map_err(|error| path.failure(&error))
    }

    /// Returns the path, which is read as often as needed; `speed` is in the unit of the first axis per second.
    fn read<'a>(&'a self, machine: &Machine, speed: Option<f64>) -> Result<DrivenPath<'a>, Failure> {
        let two_axes =
            |error: ContourError| refused("--contour", &error.to_string(), "take a machine with two linear axes");
        let limits = ContourLimits::of_machine(machine).map_err(two_axes)?;
        let kind = self
            .kind()
            .ok_or_else(|| refused("--contour", "no path is given", "name one"))?;
        for (option, given, wanted) in [
            ("--radius", self.radius, matches!(kind, Path2d::Circle)),
            ("--side", self.side, matches!(kind, Path2d::Square)),
            ("--speed", speed, !matches!(kind, Path2d::Gcode(_))),
        ] {
            if given.is_some() && !wanted {
                let found = format!(
                    "`--contour {}` has its own",
                    self.contour.as_deref().unwrap_or_default()
                );
                return Err(refused(option, &found, &format!("leave out {option}")));
            }
        }
        let units = [machine.axes[0].unit, machine.axes[1].unit];
        let rules = self.corners.rules(units[0])?;
        let speed = speed_of(machine, &limits, speed)?;
        let in_unit = |figure: Option<f64>| figure.map(|figure| units[0].to_si(figure));
        let size = size(machine);
        let drawn = |strokes: Result<Vec<Stroke>, ContourError>| {
            let strokes =
                strokes.map_err(|error| refused("--contour", &error.to_string(), "give a size and a speed above 0"))?;
            Ok::<_, Failure>(Source::Drawn(centred(machine, strokes, &limits)))
        };
        let source = match kind {
            Path2d::Circle => drawn(shapes::circle(in_unit(self.radius).unwrap_or(size / 2.0), speed))?,
            Path2d::Square => drawn(shapes::square(in_unit(self.side).unwrap_or(size), speed))?,
            Path2d::Points(path) => Source::Points {
                file: PathFile::open(path)?,
                units,
                speed,
            },
            Path2d::Gcode(path) => {
                let file = PathFile::open(path)?;
                let extrudes =
                    gcode::extrudes(&mut file.reader(&Rc::default())?).map_err(|error| in_file(path, &error))?;
                Source::Gcode { file, extrudes }
            }
        };
        Ok(DrivenPath {
            name: self.contour.as_deref().unwrap_or_default(),
            source,
            limits,
            rules,
        })
    }
}

/// A path with how it is driven.
struct DrivenPath<'a> {
    name: &'a str,
    source: Source<'a>,
    limits: ContourLimits,
    rules: CornerRules,
}

/// Where the strokes of a path come from.
enum Source<'a> {
    Drawn(Vec<Stroke>),
    Points {
        file: PathFile<'a>,
        units: [AxisUnit; 2],
        speed: f64,
    },
    Gcode {
        file: PathFile<'a>,
        extrudes: bool,
    },
}

type Strokes<'a> = Box<dyn Iterator<Item = Result<Stroke, ContourError>> + 'a>;

impl DrivenPath<'_> {
    fn strokes(&self) -> Result<Strokes<'_>, Failure> {
        self.counted_strokes(&Rc::default())
    }

    /// The strokes from the beginning; `bytes` counts what was read of the file.
    fn counted_strokes(&self, bytes: &Rc<Cell<u64>>) -> Result<Strokes<'_>, Failure> {
        Ok(match &self.source {
            Source::Drawn(strokes) => Box::new(strokes.iter().copied().map(Ok)),
            Source::Points { file, units, speed } => {
                let points = shapes::Points::new(file.reader(bytes)?, *units, *speed);
                Box::new(points.map_err(|error| self.failure(&error))?)
            }
            Source::Gcode { file, extrudes } => Box::new(gcode::Program::new(file.reader(bytes)?, *extrudes)),
        })
    }

    /// Plans the path once without driving it, to find all errors in it.
    fn survey(&self, machine: &Machine, observer: &dyn Observer) -> Result<Survey, Failure> {
        let bytes = Rc::default();
        let mut bar = Late::new(observer, "reading the path", self.file().map_or(0, |file| file.bytes));
        let mut seen = 0u32;
        let mut strokes = self.counted_strokes(&bytes)?.inspect(|_| {
            seen = seen.wrapping_add(1);
            if seen.is_multiple_of(STROKES_LOOK) {
                bar.reach(bytes.get());
            }
        });
        let survey = Survey::new(&mut strokes, &self.limits, &self.rules);
        drop(strokes);
        let survey = match (&self.source, survey) {
            (Source::Gcode { .. }, Err(ContourError::Empty(_))) => {
                Err(ContourError::Empty("the program moves neither X nor Y".to_owned()))
            }
            (Source::Points { .. }, Err(ContourError::Empty(_))) => {
                Err(ContourError::Empty("it takes two points that differ".to_owned()))
            }
            (_, survey) => survey,
        };
        let survey = survey.and_then(|survey| survey.check_travel(machine).map(|()| survey));
        survey.map_err(|error| self.failure(&error))
    }

    fn file(&self) -> Option<&PathFile<'_>> {
        match &self.source {
            Source::Drawn(_) => None,
            Source::Points { file, .. } | Source::Gcode { file, .. } => Some(file),
        }
    }

    fn failure(&self, error: &ContourError) -> Failure {
        let is_of_file = matches!(
            error,
            ContourError::Line { .. } | ContourError::Read { .. } | ContourError::Empty(_)
        );
        match self.file().filter(|_| is_of_file) {
            Some(file) => in_file(file.path, error),
            None => refused(
                "--contour",
                &format!("{}: {error}", self.name),
                "give a smaller path, or another place for it",
            ),
        }
    }
}

/// The speed along the path, in m/s.
fn speed_of(machine: &Machine, limits: &ContourLimits, asked: Option<f64>) -> Result<f64, Failure> {
    let unit = machine.axes[0].unit;
    let Some(asked) = asked else {
        let of_stage = machine.stage.and_then(|stage| stage.contour_speed);
        return Ok(of_stage
            .unwrap_or(PART_OF_VELOCITY * limits.velocity)
            .min(limits.velocity));
    };
    let speed = unit.to_si(asked);
    if speed > limits.velocity * (1.0 + 1e-9) {
        let [found, most] = [speed, limits.velocity].map(|speed| unit.show_round(speed, "/s"));
        Err(refused(
            "--speed",
            &ContourError::Speed { found, most }.to_string(),
            "give a lower speed, or raise `velocity` in [axis.limits]",
        ))
    } else {
        Ok(speed)
    }
}

/// A size of a circle or a square, in m, that fits the travel of the plane.
fn size(machine: &Machine) -> f64 {
    let travels = machine.axes.iter().take(2).filter_map(|axis| axis.limits?.travel);
    let smallest = travels.map(|[low, high]| high - low).reduce(f64::min);
    smallest.map_or(SIZE_M, |travel| PART_OF_TRAVEL * travel)
}

/// Moves strokes to the middle of the travel of each axis that has one.
fn centred(machine: &Machine, strokes: Vec<Stroke>, limits: &ContourLimits) -> Vec<Stroke> {
    let Ok(survey) = Survey::new(&mut strokes.iter().copied().map(Ok), limits, &CornerRules::default()) else {
        return strokes;
    };
    let middles = machine.axes.iter().zip(survey.extent).map(|(axis, [low, high])| {
        let travel = axis.limits.and_then(|limits| limits.travel);
        travel.map_or(0.0, |[least, most]| {
            f64::midpoint(least, most) - f64::midpoint(low, high)
        })
    });
    let middles: Vec<f64> = middles.collect();
    shapes::moved(&strokes, [middles[0], middles[1]])
}

fn in_file(path: &Path, error: &ContourError) -> Failure {
    let place = match error {
        ContourError::Line { line, found, .. } => format!("{}:{line}: {found}", path.display()),
        other => format!("{}: {other}", path.display()),
    };
    Failure::input(place).with_any_help(error.remedy())
}

fn refused(option: &str, found: &str, remedy: &str) -> Failure {
    Failure::input(format!("{option}: {found}")).with_help(remedy)
}

/// Drives the path with each kind of shaper, and reports the distances.
pub(crate) fn simulate(
    options: &PathOptions,
    machine: &Machine,
    speed: Option<f64>,
    observer: &dyn Observer,
) -> Result<Document, Failure> {
    let path = options.read(machine, speed)?;
    let survey = path.survey(machine, observer)?;
    let samples = survey.duration_s * machine.clock.sample_hz;
    let mut bar = Late::new(observer, "driving the path", samples as u64);
    let rows = contour::compare(machine, &mut path.strokes()?, &path.rules, &mut |done| bar.reach(done));
    drop(bar);
    let rows = rows.map_err(|error| path.failure(&error))?;
    if let Some(reason) = rows[0].followed.as_ref().err().filter(|_| rows[1].followed.is_err()) {
        return Err(refused("--contour", reason, "run `posicast design` for the details"));
    }
    let report = Report {
        machine,
        name: path.name,
        survey: &survey,
        rules: &path.rules,
        rows: &rows,
    };
    if let Some(path) = &options.plot {
        write_text(path, &plot::svg(&[report.panel()])?).map_err(Failure::because)?;
    }
    Ok(report.json())
}
