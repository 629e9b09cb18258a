//! Decides which columns of a header are used, and as what. If a header is ambiguous, the user is asked; nothing is guessed.

use super::columns::Column;
use super::names::{GRAVITY, Meaning, Name};
use super::{LogError, ReadOptions, Remark};

/// Meaning of the values of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Time,
    Index,
    Rate,
    Overflows,
    Column(usize),
}

/// A field that is used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Use {
    pub(super) field: usize,
    pub(super) target: Target,
    pub(super) factor: f64,
}

/// The fields of a header that are used.
pub(super) struct Uses {
    pub(super) fields: Vec<Use>,
    pub(super) columns: Vec<Column>,
    pub(super) remarks: Vec<Remark>,
    /// Whether the rows are numbered and have no times.
    pub(super) is_numbered: bool,
    /// The question to the user if the values do not decide what the columns of axes are.
    pub(super) question: Option<LogError>,
}

/// Kinds of logs, for messages.
const OF_ACCELEROMETER: &str = "that of an accelerometer";
const OF_COMMAND: &str = "that of a position command and its response";

/// Decides the use of each field of a header.
pub(super) fn uses(header: &[Name], options: &ReadOptions) -> Result<Uses, LogError> {
    let of = |meaning: Meaning| -> Vec<usize> {
        let fields = (0..header.len()).filter(|field| meaning_in(header, *field) == Some(meaning));
        fields.collect()
    };
    let times = of(Meaning::Time);
    if times.is_empty() && header.iter().any(Name::is_spectral) {
        return Err(LogError::Spectrum(texts(header)));
    }
    let mut uses = Uses {
        fields: Vec::new(),
        columns: Vec::new(),
        remarks: Vec::new(),
        is_numbered: false,
        question: None,
    };
    let indices = of(Meaning::Index);
    if let Some(time) = time(header, &times)? {
        if options.rate_hz.is_none() {
            uses.add(time, Target::Time, header[time].factor.unwrap_or(1.0));
        }
        for &other in times.iter().filter(|other| **other != time) {
            uses.remarks
                .push(Remark::OtherTime(header[other].text.clone(), header[time].text.clone()));
        }
    } else if let Some(&index) = indices.first() {
        uses.is_numbered = true;
        uses.add(index, Target::Index, 1.0);
    }
    for (meaning, target) in [(Meaning::Rate, Target::Rate), (Meaning::Overflows, Target::Overflows)] {
        if let Some(&field) = of(meaning).first() {
            uses.add(field, target, 1.0);
        }
    }
    let has_time = !uses.fields.is_empty() || options.rate_hz.is_some();
    let taken = measured(header, &of, &mut uses)?;
    if !has_time {
        return Err(missing("time", header));
    }
    for (field, name) in header.iter().enumerate() {
        if uses.fields.iter().any(|used| used.field == field) || matches!(name.text.as_str(), "" | "-") {
            continue;
        }
        match meaning_in(header, field) {
            Some(Meaning::Time | Meaning::Index | Meaning::Rate | Meaning::Overflows) => {}
            Some(Meaning::Frequency) | None => uses.remarks.push(Remark::Unknown(name.text.clone())),
            Some(_) => uses.remarks.push(Remark::Beside {
                column: name.text.clone(),
                taken,
            }),
        }
    }
    Ok(uses)
}

impl Uses {
    fn add(&mut self, field: usize, target: Target, factor: f64) {
        self.fields.push(Use { field, target, factor });
    }

    fn add_column(&mut self, header: &[Name], field: usize, meaning: Meaning, factor: Option<f64>) {
        self.add(field, Target::Column(self.columns.len()), factor.unwrap_or(1.0));
        self.columns.push(Column {
            name: header[field].text.clone(),
            meaning,
            factor,
            values: Vec::new(),
        });
    }
}

/// Returns the meaning of a field beside the others. `x-axis` is the abscissa of an oscilloscope, but a direction beside a time or
/// `y-axis`; an empty name is an index only if it comes first.
fn meaning_in(header: &[Name], field: usize) -> Option<Meaning> {
    let name = &header[field];
    let is_other = |other: &Name| {
        other.text != name.text && (other.meaning == Some(Meaning::Time) || other.text.starts_with("y_axis"))
    };
    if name.text.starts_with("x_axis") && header.iter().any(is_other) {
        return Some(Meaning::Axis);
    }
    if name.text.is_empty() && field > 0 {
        return None;
    }
    name.meaning
}

/// Returns the column of the time. Of several, it is the only one whose name states a unit.
fn time(header: &[Name], times: &[usize]) -> Result<Option<usize>, LogError> {
    let stated: Vec<usize> = times
        .iter()
        .copied()
        .filter(|field| header[*field].factor.is_some())
        .collect();
    match (times, &stated[..]) {
        ([], _) => Ok(None),
        ([only], _) | (_, [only]) => Ok(Some(*only)),
        ([one, other, ..], _) => Err(twice(header, *one, *other)),
    }
}

fn twice(header: &[Name], one: usize, other: usize) -> LogError {
    LogError::Twice(header[one].text.clone(), header[other].text.clone())
}

fn missing(missing: &'static str, header: &[Name]) -> LogError {
    LogError::Missing {
        missing,
        found: texts(header),
    }
}

fn texts(header: &[Name]) -> Vec<String> {
    header.iter().map(|name| name.text.clone()).collect()
}

/// Adds the columns of measured quantities; returns the kind of log, for messages.
fn measured(header: &[Name], of: &impl Fn(Meaning) -> Vec<usize>, uses: &mut Uses) -> Result<&'static str, LogError> {
    let accelerations = of(Meaning::Acceleration);
    if !accelerations.is_empty() {
        if let Some((one, other)) = same_letter(header, &accelerations) {
            return Err(twice(header, one, other));
        }
        for field in accelerations {
            uses.add_column(header, field, Meaning::Acceleration, header[field].factor);
        }
        return Ok(OF_ACCELEROMETER);
    }
    let (axes, lengths) = (of(Meaning::Axis), of(Meaning::Length));
    let (mut responses, commands) = (of(Meaning::Response), of(Meaning::Command));
    let (drives, deviations) = (of(Meaning::Drive), of(Meaning::Deviation));
    let is_driven = !commands.is_empty() || !drives.is_empty();
    if responses.is_empty() {
        match (&axes[..], &lengths[..]) {
            ([], [only]) => responses.push(*only),
            ([only], []) if is_driven => responses.push(*only),
            ([], []) => return Err(missing("response", header)),
            ([], _) => return Err(question(header, &lengths)),
            _ => return use_axes_by_letter(header, &axes, uses),
        }
    }
    let (kept, taken): (&[&[usize]], _) = if !deviations.is_empty() {
        (&[&responses, &deviations], "a trace of motor and scale")
    } else if !commands.is_empty() {
        (&[&commands, &responses], OF_COMMAND)
    } else {
        (&[&responses, &drives], "that of a drive and its motor")
    };
    for fields in kept {
        if let [one, other, ..] = fields[..] {
            return Err(twice(header, one, other));
        }
        for &field in *fields {
            let meaning = match header[field].meaning {
                Some(Meaning::Axis | Meaning::Length) | None => Meaning::Response,
                Some(meaning) => meaning,
            };
            uses.add_column(header, field, meaning, header[field].factor);
        }
    }
    Ok(taken)
}

/// Uses columns whose names give only the letter of the axis. RepRapFirmware writes accelerations in g beside `Sample`. Otherwise the
/// values of three directions may decide, and the user is asked about one or two.
fn use_axes_by_letter(header: &[Name], axes: &[usize], uses: &mut Uses) -> Result<&'static str, LogError> {
    let is_recorder = uses.is_numbered && header.iter().any(|name| name.text == "sample");
    let is_one_sensor = same_letter(header, axes).is_none();
    if !is_one_sensor || (!is_recorder && axes.len() != 3) {
        return Err(question(header, axes));
    }
    uses.question = (!is_recorder).then(|| question(header, axes));
    let (meaning, factor) = if is_recorder {
        (Meaning::Acceleration, Some(GRAVITY))
    } else {
        (Meaning::Axis, None)
    };
    for &field in axes {
        uses.add_column(header, field, meaning, factor);
    }
    Ok(OF_ACCELEROMETER)
}

/// Returns two fields of the same direction.
fn same_letter(header: &[Name], fields: &[usize]) -> Option<(usize, usize)> {
    fields.iter().enumerate().find_map(|(n, one)| {
        let letter = header[*one].letter()?;
        let other = fields[n + 1..]
            .iter()
            .find(|other| header[**other].letter() == Some(letter))?;
        Some((*one, *other))
    })
}

/// Returns the question what the columns are, with the options that answer it.
fn question(header: &[Name], open: &[usize]) -> LogError {
    let row = |column: &dyn Fn(usize) -> String| {
        let columns = (0..header.len()).map(|field| match meaning_in(header, field) {
            _ if open.contains(&field) => column(field),
            Some(Meaning::Time | Meaning::Index | Meaning::Command) => header[field].text.clone(),
            _ => "-".to_owned(),
        });
        columns.collect::<Vec<_>>().join(",")
    };
    let letters = ['x', 'y', 'z'];
    let first_of = |letter: char| {
        open.iter()
            .copied()
            .find(|field| header[*field].letter() == Some(letter))
    };
    let accelerations = row(
        &|field| match header[field].letter().filter(|letter| first_of(*letter) == Some(field)) {
            Some(letter) => format!("accel_{letter}_g"),
            None if letters.iter().all(|letter| first_of(*letter).is_none()) => {
                let place = open.iter().position(|other| *other == field).unwrap_or(0);
                letters
                    .get(place)
                    .map_or("-".to_owned(), |letter| format!("accel_{letter}_g"))
            }
            None => "-".to_owned(),
        },
    );
    let position = row(&|field| {
        if field == open[0] {
            "response".to_owned()
        } else {
            "-".to_owned()
        }
    });
    LogError::Ambiguous {
        columns: open.iter().map(|field| header[*field].text.clone()).collect(),
        accelerations,
        position,
    }
}

/// Returns the unit of accelerations for which the three directions together measure gravity while nothing moves.
fn unit_by_gravity(columns: &[Column]) -> Option<(&'static str, f64, f64)> {
    /// Largest relative error of a sensor that is not calibrated.
    const TOLERANCE: f64 = 0.12;
    const UNITS: [(&str, f64); 3] = [("g", GRAVITY), ("m/s²", 1.0), ("mm/s²", 1e-3)];
    if columns.len() != 3
        || columns
            .iter()
            .any(|column| super::saturated::dead(&column.values).is_some())
    {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let measured = columns
        .iter()
        .map(|column| mean(&column.values).powi(2))
        .sum::<f64>()
        .sqrt();
    let unit = UNITS
        .iter()
        .find(|(_, factor)| (measured * factor / GRAVITY - 1.0).abs() < TOLERANCE);
    unit.map(|(name, factor)| (*name, *factor, measured))
}

/// Determines the unit of accelerations without one, and decides whether columns of axes are accelerations.
///
/// # Errors
/// The question that remains for the user.
pub(super) fn decide(
    columns: &mut [Column],
    remarks: &mut Vec<Remark>,
    question: Option<LogError>,
) -> Result<(), LogError> {
    /// Printer firmware writes mm/s² without naming the unit.
    const OF_FIRMWARE: (&str, f64) = ("mm/s²", 1e-3);
    let is_open =
        |column: &Column| matches!(column.meaning, Meaning::Acceleration | Meaning::Axis) && column.factor.is_none();
    if !columns.iter().any(is_open) {
        return Ok(());
    }
    let by_gravity = if columns.iter().all(is_open) {
        unit_by_gravity(columns)
    } else {
        None
    };
    let factor = match (by_gravity, question) {
        (None, Some(question)) => return Err(question),
        (None, None) => OF_FIRMWARE.1,
        (Some((unit, factor, measured)), question) => {
            if question.is_some() || unit != OF_FIRMWARE.0 {
                remarks.push(Remark::Gravity { unit, measured });
            }
            factor
        }
    };
    for column in columns.iter_mut().filter(|column| is_open(column)) {
        column.meaning = Meaning::Acceleration;
        column.factor = Some(factor);
        column.values.iter_mut().for_each(|value| *value *= factor);
    }
    Ok(())
}
