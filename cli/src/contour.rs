//! `posicast simulate --contour`: a path of two axes, and how far shapers make them leave it.

use crate::failure::Failure;
use crate::output::{self, Table, UnitDocument};
use crate::plot::{self, Curve, Panel, label, time_axis};
use posicast_model::contour::{
    self, Contour, ContourError, ContourLimits, ContourRow, FREQUENCY_FACTORS, Stroke, gcode, shapes,
};
use posicast_model::machine_file::Machine;
use posicast_model::unit::{AxisUnit, show_seconds};
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::write_text;
use posicast_testbench::wording::counted;
use serde::Serialize;
use std::fmt::Write;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Default speed along a path, as a fraction of the slower axis's limit.
const PART_OF_VELOCITY: f64 = 0.4;
/// Default size of a circle or square, as a fraction of the smaller travel, and in m where there is no travel.
const PART_OF_TRAVEL: f64 = 0.25;
const SIZE_M: f64 = 0.02;
/// Largest size in bytes of a file of points or G-code.
const LARGEST_BYTES: u64 = 64 << 20;
/// File name extensions of G-code.
const GCODE_ENDINGS: [&str; 6] = ["gcode", "g", "nc", "ngc", "tap", "cnc"];

/// The options `--contour`, and its sizes.
#[derive(clap::Args)]
pub(crate) struct ContourArgs {
    /// Path of the first two axes: circle, square, a CSV file of points x,y in the axes' units, or a G-code file
    /// (.gcode, .nc, .ngc, …). Shows how far each kind of shaper makes the axes leave it, instead of writing a
    /// waveform
    #[arg(long, value_name = "SHAPE|FILE", conflicts_with = "command")]
    pub(crate) contour: Option<String>,
    /// Radius of the circle, in the unit of the first axis [default: an eighth of the smaller travel, else 10 mm]
    #[arg(long, requires = "contour", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// Side of the square, in the unit of the first axis [default: a quarter of the smaller travel, else 20 mm]
    #[arg(long, requires = "contour", allow_negative_numbers = true)]
    side: Option<f64>,
    /// With --contour: draw the errors over time into this SVG file
    #[arg(long, value_name = "FILE.svg", requires = "contour")]
    pub(crate) plot: Option<PathBuf>,
}

/// The path to drive.
enum Path2d<'a> {
    Circle,
    Square,
    Points(&'a Path),
    Gcode(&'a Path),
}

impl ContourArgs {
    /// Refuses the options of a path where there is none. The parser takes them beside an option that excludes `--contour`.
    pub(crate) fn only_with_a_path(&self) -> Result<(), Failure> {
        let given = [
            ("--radius", self.radius.is_some()),
            ("--side", self.side.is_some()),
            ("--plot", self.plot.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((option, _)) if self.contour.is_none() => Err(Failure::from(miette::miette!(
                help = format!("leave out {option}, or give a path with --contour"),
                "{option}: this option belongs to --contour"
            ))),
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

    /// The path for `run`, where `--radius` is the circle's.
    pub(crate) fn of_run(contour: Option<&str>, radius: Option<f64>) -> Option<Self> {
        Some(Self {
            contour: Some(contour?.to_owned()),
            radius,
            side: None,
            plot: None,
        })
    }

    /// Plans the path within the limits and the travel of the machine; from `(0, 0)` if `from_reset`.
    pub(crate) fn planned(&self, machine: &Machine, speed: Option<f64>, from_reset: bool) -> Result<Contour, Failure> {
        let two_axes =
            |error: ContourError| refused("--contour", &error.to_string(), "take a machine with two linear axes");
        let limits = ContourLimits::of_machine(machine).map_err(two_axes)?;
        let mut strokes = self.strokes(machine, &limits, speed)?;
        let name = self.contour.as_deref().unwrap_or_default();
        let of_path = |error: ContourError| {
            refused(
                "--contour",
                &format!("{name}: {error}"),
                "give a smaller path, or another place for it",
            )
        };
        let contour = |strokes: &[Stroke]| {
            let contour = Contour::new(strokes, &limits, machine.clock.sample_period_s())?;
            contour.check_travel(machine)?;
            Ok(contour)
        };
        let planned = contour(&strokes).map_err(of_path)?;
        if !from_reset || planned.begin() == [0.0, 0.0] {
            return Ok(planned);
        }
        strokes.insert(0, shapes::approach(planned.begin()));
        contour(&strokes).map_err(of_path)
    }

    /// The strokes of the path; `speed` is in the unit of the first axis per second.
    fn strokes(&self, machine: &Machine, limits: &ContourLimits, speed: Option<f64>) -> Result<Vec<Stroke>, Failure> {
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
        let speed = speed_of(machine, limits, speed)?;
        let in_unit = |figure: Option<f64>| figure.map(|figure| units[0].to_si(figure));
        let size = size(machine);
        let drawn = |strokes: Result<Vec<Stroke>, ContourError>| {
            strokes.map_err(|error| refused("--contour", &error.to_string(), "give a size and a speed above 0"))
        };
        match kind {
            Path2d::Circle => drawn(shapes::circle(in_unit(self.radius).unwrap_or(size / 2.0), speed))
                .map(|strokes| centred(machine, strokes, limits)),
            Path2d::Square => drawn(shapes::square(in_unit(self.side).unwrap_or(size), speed))
                .map(|strokes| centred(machine, strokes, limits)),
            Path2d::Points(path) => {
                let points = read(path)?;
                let points = shapes::points(&points, units).map_err(|error| in_file(path, &error))?;
                shapes::polyline(&points, speed).map_err(|error| in_file(path, &error))
            }
            Path2d::Gcode(path) => gcode::strokes(&read(path)?).map_err(|error| in_file(path, &error)),
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
    match speed > limits.velocity * (1.0 + 1e-9) {
        true => {
            let [found, most] = [speed, limits.velocity].map(|speed| unit.show_round(speed, "/s"));
            Err(refused(
                "--speed",
                &ContourError::Speed { found, most }.to_string(),
                "give a lower speed, or raise `velocity` in [axis.limits]",
            ))
        }
        false => Ok(speed),
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
    let Ok(contour) = Contour::new(&strokes, limits, machine.clock.sample_period_s()) else {
        return strokes;
    };
    let middles = machine.axes.iter().zip(contour.extent()).map(|(axis, [low, high])| {
        let travel = axis.limits.and_then(|limits| limits.travel);
        travel.map_or(0.0, |[least, most]| {
            f64::midpoint(least, most) - f64::midpoint(low, high)
        })
    });
    let middles: Vec<f64> = middles.collect();
    shapes::moved(&strokes, [middles[0], middles[1]])
}

fn read(path: &Path) -> Result<String, Failure> {
    let unreadable = |found: String| {
        Failure::from(miette::miette!(
            help = "name `circle`, `square`, a CSV file with rows x,y, or a G-code file (.gcode, .nc, .ngc)",
            "--contour: cannot read `{}`: {found}",
            path.display()
        ))
    };
    let file = File::open(path).map_err(|error| unreadable(error.to_string()))?;
    let mut text = String::new();
    let read = file.take(LARGEST_BYTES + 1).read_to_string(&mut text);
    let bytes = read.map_err(|error| unreadable(error.to_string()))? as u64;
    match bytes > LARGEST_BYTES {
        true => Err(unreadable(format!("it has more than {LARGEST_BYTES} bytes"))),
        false => Ok(text),
    }
}

fn in_file(path: &Path, error: &ContourError) -> Failure {
    let place = match error {
        ContourError::Line { line, found, .. } => format!("{}:{line}: {found}", path.display()),
        other => format!("{}: {other}", path.display()),
    };
    match error.remedy() {
        Some(remedy) => Failure::from(miette::miette!(help = remedy.to_owned(), "{place}")),
        None => Failure::from(miette::miette!("{place}")),
    }
}

fn refused(option: &str, found: &str, remedy: &str) -> Failure {
    Failure::from(miette::miette!(help = remedy.to_owned(), "{option}: {found}"))
}

/// Drives the path with each kind of shaper, and reports the distances.
pub(crate) fn run(
    args: &ContourArgs,
    machine: &Machine,
    speed: Option<f64>,
    outputs: &OutputFiles,
    json: bool,
) -> Result<(), Failure> {
    let contour = args.planned(machine, speed, false)?;
    let name = args.contour.as_deref().unwrap_or_default();
    let of_path = |error: ContourError| refused("--contour", &format!("{name}: {error}"), "give a shorter path");
    let rows = contour::compare(machine, &contour).map_err(of_path)?;
    if rows.iter().take(2).all(|row| row.errors.is_err()) {
        let reason = rows[0].errors.as_ref().err().cloned().unwrap_or_default();
        return Err(refused("--contour", &reason, "`posicast design` tells more about it"));
    }
    let report = Report {
        machine,
        name,
        contour: &contour,
        rows: &rows,
    };
    if let Some(path) = &args.plot {
        write_text(path, &plot::svg(&[report.panel()])?).map_err(Failure::because)?;
    }
    match json {
        true => output::print_json(&report.json()),
        false => output::print_beside(outputs, &report.text()),
    }
}

struct Report<'a> {
    machine: &'a Machine,
    name: &'a str,
    contour: &'a Contour,
    rows: &'a [ContourRow],
}

/// `simulate --contour --json`. Lengths are in m.
#[derive(Serialize)]
struct Document {
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    contour: String,
    length: f64,
    duration_s: f64,
    stops: usize,
    frequency_factors: [f64; 5],
    shapers: Vec<RowDocument>,
}

#[derive(Serialize)]
struct RowDocument {
    kind: String,
    in_file: bool,
    equal_delays: bool,
    /// Largest distance from the path for each of `frequency_factors`.
    #[serde(skip_serializing_if = "Option::is_none")]
    error_peak: Option<[f64; 5]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error_rms: Option<[f64; 5]>,
    /// Largest distance while the path is driven at full speed, with the modes as in the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    error_steady: Option<f64>,
    /// Why there are no figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

impl Report<'_> {
    fn unit(&self) -> AxisUnit {
        self.machine.axes[0].unit
    }

    fn json(&self) -> Document {
        let rows = self.rows.iter().map(|row| {
            let errors = row.errors.as_ref().ok();
            RowDocument {
                kind: row.kind.clone(),
                in_file: row.in_file,
                equal_delays: row.matched,
                error_peak: errors.map(|errors| errors.map(|error| error.peak)),
                error_rms: errors.map(|errors| errors.map(|error| error.rms)),
                error_steady: row.nominal.as_ref().and_then(|nominal| Some(nominal.steady?.peak)),
                reason: row.errors.as_ref().err().cloned(),
            }
        });
        Document {
            name: self.machine.name.clone(),
            unit: UnitDocument::new(self.unit()),
            contour: self.name.to_owned(),
            length: self.contour.length(),
            duration_s: self.contour.duration_s(),
            stops: self.contour.stops(),
            frequency_factors: FREQUENCY_FACTORS,
            shapers: rows.collect(),
        }
    }

    fn text(&self) -> String {
        let axes: Vec<&str> = self
            .machine
            .axes
            .iter()
            .take(2)
            .map(|axis| axis.name.as_str())
            .collect();
        let mut text = format!(
            "{}: {} of axes {}, {} in {}, {}\nlargest distance of the load from the path, its modes at\n",
            self.machine.name,
            self.name,
            axes.join(" and "),
            self.unit().show_round(self.contour.length(), ""),
            show_seconds(self.contour.duration_s(), 3),
            counted(self.contour.stops() as u64, "stop"),
        );
        let factors = FREQUENCY_FACTORS.map(|factor| format!(">{:.0} %", 100.0 * factor));
        let mut headings = vec!["shaper", "delays"];
        headings.extend(factors.iter().map(String::as_str));
        headings.push(">at speed");
        let mut table = Table::new(&headings);
        let mut reasons = Vec::new();
        for row in self.rows {
            let kind = if row.in_file {
                format!("{}, of the file", row.kind)
            } else {
                row.kind.clone()
            };
            let delays = if row.matched { "equal" } else { "own" };
            // A smaller distance is only a rounding error.
            let show = |error: f64| {
                if error < 1e-12 {
                    "0".to_owned()
                } else {
                    self.unit().show(error, 3)
                }
            };
            let mut cells = vec![kind.clone(), delays.to_owned()];
            match &row.errors {
                Ok(errors) => cells.extend(errors.map(|error| show(error.peak))),
                Err(reason) => {
                    reasons.push(format!("  {kind}, {delays} delays: {reason}"));
                    cells.extend(FREQUENCY_FACTORS.map(|_| "–".to_owned()));
                }
            }
            let steady = row.nominal.as_ref().and_then(|nominal| nominal.steady);
            cells.push(steady.map_or_else(|| "–".to_owned(), |steady| show(steady.peak)));
            table.row(cells);
        }
        text += &table.text("  ");
        for reason in reasons {
            let _ = writeln!(text, "{reason}");
        }
        text
    }

    /// The distance over time, without a shaper and with the machine's own.
    fn panel(&self) -> Panel {
        let drawn = |row: &&ContourRow| row.in_file || row.kind == "none" && !row.matched;
        let sample_s = self.machine.clock.sample_period_s();
        let rows = || {
            self.rows
                .iter()
                .filter(drawn)
                .filter_map(|row| Some((row, row.nominal.as_ref()?)))
        };
        let samples = rows().map(|(_, followed)| followed.distance.len()).max().unwrap_or(0);
        let time = time_axis(samples as f64 * sample_s);
        let peaks = rows().map(|(_, followed)| followed.error.peak);
        let length = self.unit().for_largest(peaks);
        let curves = rows().map(|(row, followed)| {
            let points = followed.distance.iter().enumerate();
            let points = points.map(|(sample, distance)| (time.of(sample as f64 * sample_s), length.of(*distance)));
            let delays = if row.matched { "equal delays" } else { "own delays" };
            let name = if row.kind == "none" && !row.in_file {
                "unshaped".to_owned()
            } else {
                format!("{}, {delays}", row.kind)
            };
            Curve::new(name, points.collect())
        });
        Panel {
            title: format!(
                "{}: {}, distance of the load from the path",
                self.machine.name, self.name
            ),
            x_label: label("time", time),
            y_label: label("to the left of the path", length),
            curves: curves.collect(),
            ..Panel::default()
        }
    }
}
