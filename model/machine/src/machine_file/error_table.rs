//! `[axis.error_table]`: a measured error of screw or scale, as positions and errors in a CSV file beside the machine file.
//!
//! ```text
//! position,error          in the axis's unit; the heading may be left out, lines with # are comments
//! 0,0
//! 0.01,0.000004           at 0.01 by the counter the axis stands at 0.010004
//! ```

use super::LimitsSection;
use super::key::{Default, Key, Values};
use super::table::Table;
use crate::unit::AxisUnit;
use posicast_blocks::error_table::{EntryUnit, LARGEST_ENTRY};
use posicast_shaper::unit::short;

/// Rows of a file.
const MAX_ROWS: usize = 10_000;
/// Steepest error of a file: error per position. The hardware takes a sixteenth; what is left is for the rounding of its entries.
pub const STEEPEST_IN_FILE: f64 = 0.05;
/// Largest position of a word, in counts.
const LARGEST_POSITION_COUNTS: f64 = 8_388_608.0;
const FILE: &str = "file";
const COLUMNS: [&str; 2] = ["position", "error"];

/// Where the error is looked up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorUse {
    /// At the reference, the desired position of the axis.
    #[default]
    Reference,
    /// At the feedback, the counted position of the axis.
    Feedback,
}

impl ErrorUse {
    /// Every use with its name in the machine file.
    pub const ALL: [(Self, &str); 2] = [(Self::Reference, "reference"), (Self::Feedback, "feedback")];
}

/// `[axis.error_table]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorTableSection {
    /// Name of the CSV file, which is beside the machine file.
    pub file: String,
    /// Where the error is looked up.
    pub apply: ErrorUse,
    /// Position from the origin, and the true less the counted position there, both in m or rad; positions increase.
    pub points: Vec<(f64, f64)>,
}

impl ErrorTableSection {
    /// The error at a position: linear between two points, that of the nearest one outside. In m or rad, as the position.
    pub fn at(&self, position: f64) -> f64 {
        let above = self.points.partition_point(|(point, _)| *point <= position);
        match (
            above.checked_sub(1).and_then(|below| self.points.get(below)),
            self.points.get(above),
        ) {
            (Some((low, from)), Some((high, to))) => from + (to - from) * (position - low) / (high - low),
            (Some((_, error)), None) | (None, Some((_, error))) => *error,
            (None, None) => 0.0,
        }
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        FILE,
        Values::CsvName,
        "CSV file beside the machine file: rows of position and error (true less counted position) in the axis's unit.",
    )
    .required(),
    Key::new(
        "apply",
        Values::Word(|| ErrorUse::ALL.map(|(_, name)| name).to_vec()),
        "Takes the error at the desired (reference) or the counted (feedback) position.",
    )
    .default(Default::Word("reference")),
];

/// Why a file is refused.
struct Refused {
    found: String,
    allowed: String,
    remedy: &'static str,
}

/// Settings of an axis that its points must agree with.
#[derive(Clone, Copy)]
pub(super) struct OfAxis<'a> {
    pub(super) unit: AxisUnit,
    /// Counts of the loop per m or rad, if they are valid.
    pub(super) counts_per_unit: Option<f64>,
    pub(super) limits: Option<&'a LimitsSection>,
    pub(super) modulo: bool,
    /// The loop runs on a scale.
    pub(super) on_scale: bool,
}

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, axis: OfAxis<'_>) -> Option<ErrorTableSection> {
    table.allow(KEYS);
    let apply = table.word("apply", &ErrorUse::ALL);
    table.require(FILE, "the name of a CSV file beside the machine file");
    let file = table.text(FILE, "the name of a CSV file")?;
    if !is_csv_name(file) {
        let allowed = "a name that ends in .csv, of a file beside the machine file: no folder before it";
        table.refuse(FILE, allowed, "put the file beside the machine file, and give its name");
        return None;
    }
    if axis.modulo {
        let (found, allowed) = (
            "an error table with modulo = true",
            "an axis whose position does not wrap",
        );
        table.contradiction(FILE, found, allowed, "remove [axis.error_table], or modulo");
        return None;
    }
    if axis.on_scale {
        let found = "an error table on an axis whose loop runs on its scale";
        let allowed = "an axis whose loop runs on its encoder: the table begins at the origin of that counter";
        let remedy = "wire the scale as the axis's encoder, or remove [axis.error_table]";
        table.contradiction(FILE, found, allowed, remedy);
        return None;
    }
    let points = table.beside(file).map_err(|found| Refused {
        found,
        allowed: "a CSV file beside the machine file".to_owned(),
        remedy: "put the file beside the machine file, or remove [axis.error_table]",
    });
    let points = points.and_then(|text| points_of(&text, axis.unit));
    match points.and_then(|points| checked(points, axis)) {
        Ok(points) => Some(ErrorTableSection {
            file: file.to_owned(),
            apply: apply.unwrap_or_default(),
            points,
        }),
        Err(Refused { found, allowed, remedy }) => {
            table.contradiction(FILE, format!("{file}: {found}"), allowed, remedy);
            None
        }
    }
}

/// A plain file name: what stands there is copied into the output folder under the same name.
fn is_csv_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._- ".contains(c);
    name.len() > 4 && name.ends_with(".csv") && !name.starts_with('.') && name.chars().all(plain)
}

/// A row of the file: its line, position and error in m or rad.
type Row = (u64, f64, f64);

fn points_of(text: &str, unit: AxisUnit) -> Result<Vec<Row>, Refused> {
    let allowed = || format!("rows of two numbers, {}, in {}", COLUMNS.join(" and "), unit.name());
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let (mut rows, mut is_first) = (Vec::new(), true);
    for record in reader.records() {
        let record = record.map_err(|error| Refused {
            found: error.to_string(),
            allowed: allowed(),
            remedy: "export the file as plain CSV",
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let fields: Vec<&str> = record.iter().collect();
        if std::mem::take(&mut is_first) && fields == COLUMNS {
            continue;
        }
        let numbers: Vec<f64> = (fields.iter())
            .filter_map(|field| field.parse().ok())
            .filter(|number: &f64| number.is_finite())
            .collect();
        let (2, &[position, error]) = (fields.len(), numbers.as_slice()) else {
            let shown: String = fields.join(",").chars().filter(|c| !c.is_control()).take(40).collect();
            return Err(Refused {
                found: format!("row {line}, `{shown}`"),
                allowed: allowed(),
                remedy: "correct or remove the row; a heading is `position,error`",
            });
        };
        if rows.len() == MAX_ROWS {
            return Err(Refused {
                found: format!("row {line}, one more than {MAX_ROWS}"),
                allowed: format!("2 to {MAX_ROWS} rows"),
                remedy: "leave points out: the hardware has 256",
            });
        }
        rows.push((line, unit.to_si(position), unit.to_si(error)));
    }
    Ok(rows)
}

/// The points, once they fit each other and the axis.
fn checked(rows: Vec<Row>, axis: OfAxis<'_>) -> Result<Vec<(f64, f64)>, Refused> {
    let unit = axis.unit;
    let (Some(first), Some(last), true) = (rows.first(), rows.last(), rows.len() > 1) else {
        return Err(Refused {
            found: format!("{} of numbers", if rows.is_empty() { "no row" } else { "one row" }),
            allowed: "2 rows and more".to_owned(),
            remedy: "measure at both ends of the travel, and between them",
        });
    };
    for pair in rows.windows(2) {
        let [(_, low, from), (line, high, to)] = pair else {
            continue;
        };
        if high <= low {
            return Err(Refused {
                found: format!(
                    "row {line}, the position {} after {}",
                    short(unit.in_file(*high)),
                    short(unit.in_file(*low))
                ),
                allowed: "positions that increase from row to row".to_owned(),
                remedy: "sort the rows by position, and take the mean of those that were measured twice",
            });
        }
        let slope = (to - from) / (high - low);
        if slope.abs() > STEEPEST_IN_FILE {
            return Err(Refused {
                found: format!(
                    "row {line}, an error that changes by {} of the way from the row before",
                    short(slope)
                ),
                allowed: format!("at most {STEEPEST_IN_FILE} of it"),
                remedy: "errors are in the unit of the axis, as positions are; correct the row",
            });
        }
    }
    if let Some([low, high]) = axis.limits.and_then(|limits| limits.travel) {
        // What a conversion to SI and back rounds is no gap.
        let slack = 1e-9 * (high - low);
        if low < first.1 - slack || high > last.1 + slack {
            return Err(Refused {
                found: format!(
                    "rows {} to {}, positions {} to {}",
                    first.0,
                    last.0,
                    short(unit.in_file(first.1)),
                    short(unit.in_file(last.1))
                ),
                allowed: format!(
                    "positions that cover the travel, {} to {}",
                    short(unit.in_file(low)),
                    short(unit.in_file(high))
                ),
                remedy: "measure to both ends of the travel, or make axis.limits.travel shorter",
            });
        }
    }
    if let Some(counts) = axis.counts_per_unit {
        let most = f64::from(LARGEST_ENTRY) * EntryUnit::Coarse.counts();
        for (line, position, error) in &rows {
            if (error * counts).abs() > most || (position * counts).abs() > LARGEST_POSITION_COUNTS {
                return Err(Refused {
                    found: format!(
                        "row {line}, position {} and error {} counts",
                        short(position * counts),
                        short(error * counts)
                    ),
                    allowed: format!("positions of ±{LARGEST_POSITION_COUNTS} and errors of ±{most} counts"),
                    remedy: "both are in the unit of the axis; correct the row, or counts_per_unit",
                });
            }
        }
    }
    Ok(rows.into_iter().map(|(_, position, error)| (position, error)).collect())
}
