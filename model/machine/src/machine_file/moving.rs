//! Modes that move with load, position or height: `points` of `[[axis.mode]]`, and `[axis.family]`.
//!
//! A moving mode is given by points over a named variable. Between two points frequency and damping are interpolated linearly. The
//! design makes a family of tap tables of them ([`crate::plan::family`]); the table for the nominal value stands in the hardware's ROM.

use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{AxisSection, ClockSection, LimitsSection, mode};
use crate::unit::AxisUnit;
use posicast_shaper::axis::{AxisMode, ModePoint};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::short;

/// Largest number of points of a mode.
pub(super) const MAX_POINTS: usize = 64;
/// Largest number of tap tables of a family.
pub(crate) const MAX_TABLES: usize = 64;
/// Range of the variable.
const VALUE: NumberRange = NumberRange::closed(-1e9, 1e9);
/// Range of a point's numbers before its frequency and damping are checked.
const ANY: NumberRange = NumberRange::closed(-1e9, 1e9);
pub(super) const POINTS: &str = "points";
pub(super) const MOVES_WITH: &str = "moves_with";
const FAMILY: &str = "family";
const NOMINAL: &str = "nominal";
const VALUES: &str = "values";
/// Names of the numbers of a point.
const NUMBERS: &str = "value, frequency_hz, damping";
/// Name of the variable that is the axis's own position.
pub(super) const POSITION: &str = "position";

/// The keys `points` and `moves_with` of a mode.
pub(super) const KEYS_OF_MODE: [Key; 2] = [
    Key::new(
        POINTS,
        Values::Rows(&[VALUE, mode::FREQUENCY_HZ, mode::DAMPING], MAX_POINTS),
        "Mode that moves: rows [value, frequency_hz, damping] with increasing values.",
    )
    .rule("at least 2; one range for all moving modes of an axis")
    .instead_of("frequency_hz"),
    Key::new(
        MOVES_WITH,
        Values::Name,
        "Variable of `points`: `position` is the axis's own, in its unit; the host measures any other.",
    )
    .rule("beside `points`, the same for all modes of an axis"),
];

/// The keys of `[axis.family]`.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        NOMINAL,
        Values::Number(VALUE),
        "Value after reset, whose table is in the ROM. Absent: the first of `values`, else of the points.",
    )
    .rule("within the points; one of `values` if given"),
    Key::new(
        VALUES,
        Values::Numbers(VALUE, MAX_TABLES),
        "Values that get a table each. Absent: as few as cover all points.",
    )
    .rule("increasing, within the points; neighbouring tables must overlap"),
];

/// `[axis.family]`: the variable that the modes of an axis depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct FamilySection {
    /// Name of the variable: `position` is the axis's own position; the host knows the value of any other.
    pub variable: String,
    /// First and last value that the points cover.
    pub range: [f64; 2],
    /// Value of the variable after reset, whose table is in the ROM.
    pub nominal: f64,
    /// Values of the variable that get a table each, `nominal` among them; empty where the design chooses them.
    pub values: Vec<f64>,
}

impl FamilySection {
    /// Whether the variable is the axis's own position.
    pub fn is_position(&self) -> bool {
        self.variable == POSITION
    }

    /// Writes a value of the variable for a report: a position in the axis's unit, any other as a plain number.
    pub fn show(&self, value: f64, unit: AxisUnit) -> String {
        if self.is_position() {
            unit.as_in_file(value, "")
        } else {
            short(value)
        }
    }
}

impl AxisSection {
    /// Returns the axis with its modes as they are at this value of the variable.
    pub fn at_value(&self, value: f64) -> Self {
        let modes = self.modes.iter().map(|mode| AxisMode {
            mode: mode.at(value),
            ..mode.clone()
        });
        Self {
            modes: modes.collect(),
            ..self.clone()
        }
    }
}

/// Reads the points of a mode that moves; `None` where they are refused.
pub(super) fn read_points(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<Vec<ModePoint>> {
    let others = [
        "frequency_hz",
        "damped_frequency_hz",
        "damping",
        "measured",
        "motor_mass",
        "load_mass",
    ];
    if let Some(key) = others.into_iter().find(|key| table.has(key)) {
        let found = format!("both `{POINTS}` and `{key}`");
        let allowed = format!("`{POINTS}` alone, whose rows have frequency and damping with the motor held");
        table.contradiction(POINTS, found, allowed, format!("remove `{key}`, or `{POINTS}`"));
        return None;
    }
    table.require_with(
        MOVES_WITH,
        "the name of the variable on which the mode depends",
        format!("add `{MOVES_WITH} = \"{POSITION}\"` for the axis's own position, or a name such as \"load\""),
    );
    let rows = table.rows::<3>(POINTS, ANY, NUMBERS, MAX_POINTS)?;
    for (number, [value, frequency_hz, damping]) in (1..).zip(&rows) {
        let checks = [
            ("value", *value, VALUE),
            ("frequency_hz", *frequency_hz, mode::FREQUENCY_HZ),
            ("damping", *damping, mode::DAMPING),
        ];
        if let Some((name, found, range)) = checks.into_iter().find(|(_, found, range)| !range.contains(*found)) {
            let found = format!("{name} {} in row {number}", short(found));
            let remedy = format!("the numbers of a row are [{NUMBERS}]");
            table.contradiction(POINTS, found, format!("{name} {range}"), remedy);
            return None;
        }
        let half_hz = clock.map_or(f64::INFINITY, |clock| clock.sample_hz / 2.0);
        if *frequency_hz >= half_hz {
            let found = format!("{} Hz in row {number}", short(*frequency_hz));
            let allowed = format!("below {} Hz, half of clock.sample_hz", short(half_hz));
            let remedy = format!("raise clock.sample_hz above {} Hz", short(2.0 * frequency_hz));
            table.contradiction(POINTS, found, allowed, remedy);
            return None;
        }
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let found = format!("the value {} after {}", short(pair[1][0]), short(pair[0][0]));
        table.contradiction(
            POINTS,
            found,
            "rows whose values increase",
            "sort the rows by their first number",
        );
        return None;
    }
    if rows.len() < 2 {
        let remedy = "add a second row, or give `frequency_hz` and `damping` for a mode that does not move";
        table.contradiction(POINTS, "one row", format!("2 to {MAX_POINTS} rows"), remedy);
        return None;
    }
    let points = rows.into_iter().map(|[value, frequency_hz, damping]| ModePoint {
        value,
        mode: Mode { frequency_hz, damping },
    });
    Some(points.collect())
}

/// Reads what the moving modes of an axis share: `Some(None)` where none moves, `None` where it is refused. Values of
/// a position are converted to m or rad, and each mode is set to its value at the nominal point.
pub(super) fn read_family<'r, 't>(
    axis: &Table<'r, 't>,
    modes: &mut [(Table<'r, 't>, AxisMode)],
    unit: AxisUnit,
) -> Option<Option<FamilySection>> {
    let family = axis.table(FAMILY);
    let (given_nominal, given_values) = match &family {
        Some(table) => {
            table.allow(KEYS);
            (table.number(NOMINAL, VALUE), read_values(table))
        }
        None => (None, None),
    };
    let moving: Vec<usize> = (0..modes.len())
        .filter(|index| !modes[*index].1.points.is_empty())
        .collect();
    let Some(first) = moving.first().copied() else {
        if family.is_some() {
            let remedy = format!("give a mode `{POINTS}` and `{MOVES_WITH}`, or remove [axis.{FAMILY}]");
            axis.contradiction(
                FAMILY,
                "a family without a mode that moves",
                "a mode with `points`",
                remedy,
            );
        }
        return Some(None);
    };
    let variable = modes[first].0.text(MOVES_WITH, "a name")?.to_owned();
    let ends = |mode: &AxisMode| Some((mode.points.first()?.value, mode.points.last()?.value));
    let (low, high) = ends(&modes[first].1)?;
    for index in &moving {
        let (table, mode) = &modes[*index];
        let other = table.text(MOVES_WITH, "a name")?;
        if other != variable {
            let found = format!("{MOVES_WITH} = {}", table.quote(MOVES_WITH));
            let allowed = format!("\"{variable}\", with which another mode of the axis moves");
            let remedy = "a table is chosen by one value: give all modes of the axis over the same variable";
            table.contradiction(MOVES_WITH, found, allowed, remedy);
            return None;
        }
        if ends(mode) != Some((low, high)) {
            let found = ends(mode).map_or_else(String::new, |(low, high)| {
                format!("values {} to {}", short(low), short(high))
            });
            let allowed = format!(
                "values {} to {}, as of another mode of the axis",
                short(low),
                short(high)
            );
            table.contradiction(POINTS, found, allowed, "give all modes of the axis over the same range");
            return None;
        }
    }
    let values = given_values.unwrap_or_default();
    let nominal = given_nominal.or(values.first().copied()).unwrap_or(low);
    let within = NumberRange::closed(low, high);
    if let Some(table) = &family {
        for (key, value) in given_nominal
            .map(|value| (NOMINAL, value))
            .into_iter()
            .chain(values.iter().map(|value| (VALUES, *value)))
        {
            if !within.contains(value) {
                let remedy = format!("add rows to `{POINTS}`, or give a value that they cover");
                table.contradiction(key, short(value), within.to_string(), remedy);
                return None;
            }
        }
    }
    if let Some(table) = family
        .as_ref()
        .filter(|_| !values.is_empty() && !values.contains(&nominal))
    {
        let found = format!("{NOMINAL} = {}, which is not in `{VALUES}`", short(nominal));
        let remedy = format!("add {} to `{VALUES}`, or remove `{NOMINAL}`", short(nominal));
        table.contradiction(
            NOMINAL,
            found,
            "a value of the list: its table stands in the ROM",
            remedy,
        );
        return None;
    }
    let scale = |value: f64| if variable == POSITION { unit.to_si(value) } else { value };
    for index in moving {
        let mode = &mut modes[index].1;
        mode.points
            .iter_mut()
            .for_each(|point| point.value = scale(point.value));
        mode.mode = mode.at(scale(nominal));
    }
    Some(Some(FamilySection {
        range: [scale(low), scale(high)],
        nominal: scale(nominal),
        values: values.into_iter().map(scale).collect(),
        variable,
    }))
}

fn read_values(table: &Table<'_, '_>) -> Option<Vec<f64>> {
    let values = table.list(VALUES, VALUE, MAX_TABLES)?;
    if let Some(pair) = values.windows(2).find(|pair| pair[1] <= pair[0]) {
        let found = format!("{} after {}", short(pair[1]), short(pair[0]));
        table.contradiction(VALUES, found, "values that increase", "sort them");
        return None;
    }
    Some(values)
}

/// Checks the family against the rest of its axis.
pub(super) fn check(
    axis: &Table<'_, '_>,
    family: &FamilySection,
    kind: Option<ShaperKind>,
    limits: Option<&LimitsSection>,
    modulo: bool,
    unit: AxisUnit,
) {
    if let Some(kind) = kind.filter(|kind| !kind.depends_on_modes()) {
        let found = format!("shaper \"{kind}\" with a mode that moves");
        let remedy =
            "choose a kind that is designed for its modes, such as \"zvd\", or give `frequency_hz` and `damping`";
        axis.contradiction("mode", found, "a kind that depends on the mode", remedy);
    }
    if !family.is_position() {
        return;
    }
    if modulo {
        let found = format!("{MOVES_WITH} = \"{POSITION}\" with modulo = true");
        let remedy = "give another variable, which the host measures, or remove `modulo`";
        axis.contradiction("modulo", found, "a position with ends", remedy);
    }
    let Some([low, high]) = limits.and_then(|limits| limits.travel) else {
        return;
    };
    let [first, last] = family.range;
    if low < first || high > last {
        let show = |figure: f64| unit.as_in_file(figure, "");
        let found = format!("travel {} to {}, beyond the points of a mode", show(low), show(high));
        let allowed = format!("within {} to {}, which the points cover", show(first), show(last));
        axis.contradiction(
            "limits",
            found,
            allowed,
            format!("add rows to `{POINTS}` up to the ends of the travel"),
        );
    }
}
