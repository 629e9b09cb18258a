//! The command of a machine: from a CSV file, or a move of each axis.

use crate::allowance::Allowance;
use crate::failure::Failure;
use crate::observer::Observer;
use posicast_blocks::shaper::wrap;
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::motion::{
    AxisMove, SAMPLES_MAX, beyond_limits, command_words, end_velocity, modulo_words, resample, settle_s,
};
use posicast_machine::plan::{AxisTables, MachineDesign};
use posicast_machine::spelling::did_you_mean;
use std::fs::File;
use std::path::Path;

/// Largest length of a line in bytes: a heading and numbers need far less.
const LINE_BYTES: u64 = 1 << 16;

/// Command words per axis, all of the same length; those of a modulo axis include whole turns.
pub(crate) type Words = Vec<Vec<i64>>;

/// The words of the command in the CSV file `path`, or of the moves of the axes.
pub(crate) fn words(
    machine: &Machine,
    design: &MachineDesign,
    path: Option<&Path>,
    moves: &[AxisMove],
    observer: &dyn Observer,
) -> Result<Words, Failure> {
    let points = path.map(|path| read(machine, path, observer)).transpose()?;
    if let (Some(path), Some(points)) = (path, &points) {
        warn_of_limits(machine, path, points, observer);
        warn_of_jumps(machine, path, points, observer);
    }
    let sample_hz = machine.clock.sample_hz;
    let mut words = Words::new();
    let axes = machine.axes.iter().zip(&design.axes).zip(moves);
    for (index, ((axis, tables), of)) in axes.enumerate() {
        let shaper_s = tables.design.impulses.duration_s() + tables.delay.added_s;
        let settle = settle_s(shaper_s, axis.modes.iter().map(|m| m.mode));
        let (positions, counts_per_unit) = match &points {
            Some(points) => (
                resample(&points.of_axes[index], sample_hz, settle).map_err(|e| axis_failure(axis, e))?,
                axis.loop_counts_per_file_unit(),
            ),
            None => {
                let profile = of.profile(axis).map_err(|e| axis_failure(axis, e))?;
                let positions = profile.samples(sample_hz, settle).map_err(|e| axis_failure(axis, e))?;
                (positions, axis.loop_counts_per_unit())
            }
        };
        words.push(axis_words(machine, axis, tables, &positions, counts_per_unit)?);
    }
    Ok(equally_long(words))
}

/// The words of positions by axis and sample, in the axes' units.
pub(crate) fn words_of(machine: &Machine, design: &MachineDesign, positions: &[Vec<f64>]) -> Result<Words, Failure> {
    if positions.len() != machine.axes.len() {
        let names: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        let (found, allowed) = (positions.len(), names.len());
        return Err(
            Failure::input(format!("positions of {found} axes; the machine has {allowed}"))
                .with_help(format!("give the positions of {}", names.join(", "))),
        );
    }
    let axes = machine.axes.iter().zip(&design.axes).zip(positions);
    let words = axes.map(|((axis, tables), positions)| {
        if positions.is_empty() || positions.len() > SAMPLES_MAX {
            let found = positions.len();
            return Err(axis_failure(
                axis,
                format!("{found} samples; allowed are 1 to {SAMPLES_MAX}"),
            ));
        }
        axis_words(machine, axis, tables, positions, axis.loop_counts_per_file_unit())
    });
    Ok(equally_long(words.collect::<Result<_, Failure>>()?))
}

/// The words of an axis's positions.
fn axis_words(
    machine: &Machine,
    axis: &AxisSection,
    tables: &AxisTables,
    positions: &[f64],
    counts_per_unit: f64,
) -> Result<Vec<i64>, Failure> {
    let (bits, fraction) = (machine.fixed_point.command_bits, machine.fixed_point.command_fraction);
    let words = if axis.modulo {
        modulo_words(positions, counts_per_unit, bits, fraction, &tables.table)
    } else {
        command_words(positions, counts_per_unit, bits, fraction)
    };
    words.map_err(|error| axis_failure(axis, error))
}

/// The words with the last one repeated where an axis ends before another.
fn equally_long(mut words: Words) -> Words {
    let longest = words.iter().map(Vec::len).max().unwrap_or(0);
    for of_axis in &mut words {
        let last = of_axis.last().copied().unwrap_or(0);
        of_axis.resize(longest, last);
    }
    words
}

/// The words as the hardware gets them, without whole turns.
pub(crate) fn on_the_ports(machine: &Machine, words: &Words) -> Words {
    let bits = machine.fixed_point.command_bits;
    let of_axis = |words: &Vec<i64>| words.iter().map(|word| wrap(*word, bits)).collect();
    words.iter().map(of_axis).collect()
}

fn axis_failure(axis: &AxisSection, error: impl std::fmt::Display) -> Failure {
    Failure::input(format!("command of axis `{}`: {error}", axis.name))
}

/// The points of a command file.
struct Points {
    /// Line of each point in the file.
    lines: Vec<u64>,
    /// The points `(time_s, position)` of every axis.
    of_axes: Vec<Vec<(f64, f64)>>,
}

/// Warns if a command exceeds the limits of the machine file. It is simulated nevertheless, because the behaviour beyond a limit is worth a
/// look.
fn warn_of_limits(machine: &Machine, path: &Path, points: &Points, observer: &dyn Observer) {
    for (axis, of_axis) in machine.axes.iter().zip(&points.of_axes) {
        let Some(limits) = &axis.limits else {
            continue;
        };
        let unit = axis.unit;
        let travel = limits.travel.filter(|_| !axis.modulo);
        let in_file = (
            travel.map(|ends| ends.map(|end| unit.in_file(end))),
            limits.velocity.map(|v| unit.in_file(v)),
        );
        let (outside, too_fast) = beyond_limits(of_axis, in_file.0, in_file.1);
        let warn = |index: usize, what: String| {
            let (path, line, name) = (path.display(), points.lines[index], &axis.name);
            observer.say(&format!(
                "warning: command file `{path}`, line {line}: axis `{name}` {what}"
            ));
        };
        if let (Some(index), Some(ends)) = (outside, travel) {
            let [position, low, high] =
                [unit.to_si(of_axis[index].1), ends[0], ends[1]].map(|figure| unit.as_in_file(figure, ""));
            warn(
                index,
                format!("goes to {position}, beyond its travel of {low} to {high}"),
            );
        }
        if let (Some(index), Some(limit)) = (too_fast, limits.velocity) {
            warn(
                index,
                format!("moves faster than limits.velocity, {}", unit.as_in_file(limit, "/s")),
            );
        }
    }
}

/// Warns if a command jumps: from the reset position to its first point, or to rest from the motion in which it ends.
fn warn_of_jumps(machine: &Machine, path: &Path, points: &Points, observer: &dyn Observer) {
    let path = path.display();
    for (axis, of_axis) in machine.axes.iter().zip(&points.of_axes) {
        let (Some(first), Some(last)) = (of_axis.first(), of_axis.last()) else {
            continue;
        };
        let (unit, name, counts) = (axis.unit, &axis.name, axis.loop_counts_per_file_unit());
        if (first.1 * counts).abs() >= 1.0 {
            observer.say(&format!(
                "warning: command file `{path}`, line {}: axis `{name}` begins at {}, and stands at 0 after a reset: the command jumps \
                 there",
                points.lines[0],
                unit.as_in_file(unit.to_si(first.1), "")
            ));
        }
        let before = of_axis.len().checked_sub(2).map_or(last, |before| &of_axis[before]);
        let velocity = end_velocity(of_axis);
        if velocity != 0.0 && ((last.1 - before.1) * counts).abs() >= 1.0 {
            observer.say(&format!(
                "warning: command file `{path}`, line {}: axis `{name}` ends in mid-motion, at {}: the command stops there at once; add \
                 the points in which it comes to rest",
                points.lines[points.lines.len() - 1],
                unit.as_in_file(unit.to_si(velocity), "/s")
            ));
        }
    }
}

/// Refuses a duplicate or probably misspelt column, and reports other columns that are not used.
fn check_columns(
    machine: &Machine,
    path: &Path,
    headings: &csv::StringRecord,
    observer: &dyn Observer,
) -> Result<(), String> {
    let axes: Vec<&str> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
    let known: Vec<&str> = ["time_s", "position"].into_iter().chain(axes.iter().copied()).collect();
    let is_there = |name: &str| headings.iter().any(|heading| heading == name);
    for (index, heading) in headings.iter().enumerate() {
        if !heading.is_empty() && headings.iter().take(index).any(|earlier| earlier == heading) {
            return Err(format!("line 1: the column `{heading}` is there twice"));
        }
        let absent: Vec<&str> = known.iter().copied().filter(|name| !is_there(name)).collect();
        let unused = match heading {
            "" => format!("column {} has no name and", index + 1),
            // All axes have columns of their own.
            "position" if axes.iter().all(|axis| is_there(axis)) => "column `position`".to_owned(),
            _ if known.contains(&heading) => continue,
            _ => match did_you_mean(heading, &absent, '`') {
                Some(question) => return Err(format!("line 1: unknown column `{heading}`: {question}")),
                None => format!("column `{heading}`"),
            },
        };
        observer.say(&format!(
            "warning: command file `{}`, line 1: {unused} is not used; the columns are `time_s`, and `position` or one per axis: {}",
            path.display(),
            axes.join(", ")
        ));
    }
    Ok(())
}

/// Reads the points `(time_s, position)` of every axis, with positions in its unit. The columns are `time_s` and
/// either `position` for all axes or one per axis.
fn read(machine: &Machine, path: &Path, observer: &dyn Observer) -> Result<Points, Failure> {
    let refused = |found: String| {
        Failure::input(format!("command file `{}`: {found}", path.display()))
            .with_help("give a CSV file with the heading `time_s,position`, or `time_s` and one column per axis")
    };
    let file =
        File::open(path).map_err(|error| Failure::input(format!("command file `{}`: {error}", path.display())))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(Allowance::new(file, LINE_BYTES));
    let headings = reader.headers().map_err(|e| refused(e.to_string()))?.clone();
    let column = |name: &str| headings.iter().position(|h| h == name);
    let time = column("time_s").ok_or_else(|| {
        refused(match headings.iter().collect::<Vec<_>>()[..] {
            [] => "the file is empty".to_owned(),
            [one] if one.contains(';') => {
                "line 1: the columns are separated by semicolons; commas are needed".to_owned()
            }
            _ => "line 1: no column `time_s`".to_owned(),
        })
    })?;
    check_columns(machine, path, &headings, observer).map_err(refused)?;
    let columns: Vec<usize> = machine
        .axes
        .iter()
        .map(|axis| {
            let own = column(&axis.name).or_else(|| column("position"));
            own.ok_or_else(|| {
                refused(format!(
                    "line 1: there is neither a column `position` nor `{}`",
                    axis.name
                ))
            })
        })
        .collect::<Result<_, _>>()?;
    let mut lines = Vec::new();
    let mut points = vec![Vec::new(); machine.axes.len()];
    let mut record = csv::StringRecord::new();
    let mut before_s = None;
    loop {
        reader.get_mut().renew();
        if !reader.read_record(&mut record).map_err(|e| refused(e.to_string()))? {
            break;
        }
        if points
            .first()
            .is_some_and(|points: &Vec<_>| points.len() == SAMPLES_MAX)
        {
            return Err(refused(format!("more than {SAMPLES_MAX} points")));
        }
        let line = record.position().map_or(0, csv::Position::line);
        let value = |column: usize| {
            let text = record.get(column).unwrap_or("");
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| {
                refused(format!(
                    "line {line}: `{}` is `{text}`, not a finite number",
                    headings.get(column).unwrap_or("?")
                ))
            })
        };
        let time_s = value(time)?;
        if let Some(before_s) = before_s.replace(time_s).filter(|before_s| time_s <= *before_s) {
            return Err(refused(format!(
                "line {line}: time {time_s} s does not lie after {before_s} s: times must increase"
            )));
        }
        lines.push(line);
        for (points, column) in points.iter_mut().zip(&columns) {
            points.push((time_s, value(*column)?));
        }
    }
    if before_s.is_none() {
        return Err(refused(
            "no points: at least one line is needed below the heading".to_owned(),
        ));
    }
    Ok(Points { lines, of_axes: points })
}
