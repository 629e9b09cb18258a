//! `[[axis.mode]]`: frequency and damping of a mode, and whether it was measured with the motor held or free.
//!
//! A shaper on the reference of a position loop is designed for the mode that rings while the loop holds the motor. A
//! mode that was measured with the motor free is converted, which needs the two masses. A file without them is refused,
//! because the right shaper is then unknown.

use super::hint::{self, KILO};
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, moving, shaper};
use posicast_shaper::axis::AxisMode;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::short;

/// Largest number of modes of an axis: with five impulses each their convolution has 390,625, far more than any table
/// holds.
pub(super) const MAX_MODES: usize = 8;
/// Range of a frequency before it is compared with the sample rate. Below it a shaper would last for hours.
pub(super) const FREQUENCY_HZ: NumberRange = NumberRange::closed(1e-3, 1e9).unit("Hz");
/// Damping ratio of a mode that rings.
pub(super) const DAMPING: NumberRange = NumberRange::closed(0.0, 1.0).open_above();
/// Weights of the modes.
const PARTICIPATION: NumberRange = NumberRange::closed(0.0, 1e9);
/// Masses in kg, or inertias in kg·m².
const MASS: NumberRange = NumberRange::positive(1e12);
/// Reference to the page on measuring a mode, for messages.
pub(super) const MEASURE: &str = "docs/modes.md explains how to measure frequency and damping";
/// A sample rate below this was most likely given in kHz.
const LIKELY_SAMPLE_HZ: f64 = 100.0;
/// Word for a mode that was measured with the motor held.
const MOTOR_HELD: &str = "motor_held";
const FREE: &str = "free";
const MEASURED: [&str; 2] = [MOTOR_HELD, FREE];
/// Key of the undamped natural frequency.
const UNDAMPED: &str = "frequency_hz";
const DAMPED: &str = "damped_frequency_hz";
/// The uncertainty of a mode.
const FREQUENCY_BAND: &str = "frequency_band";
const DAMPING_BAND: &str = "damping_band";
/// The masses that a conversion takes.
const MASSES: [&str; 2] = ["motor_mass", "load_mass"];

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "frequency_hz",
        Values::Number(FREQUENCY_HZ),
        "Undamped natural frequency, below half of `sample_hz`.",
    ),
    Key::new(
        "damped_frequency_hz",
        Values::Number(FREQUENCY_HZ),
        "Damped frequency f·√(1−ζ²), at which the mode rings.",
    )
    .instead_of("frequency_hz"),
    Key::new("damping", Values::Number(DAMPING), "Damping ratio ζ.").needed_by("frequency_hz"),
    moving::KEYS_OF_MODE[0],
    moving::KEYS_OF_MODE[1],
    Key::new(
        "measured",
        Values::Word(|| MEASURED.to_vec()),
        "Motor while the mode was measured: held, as by a position loop, or free (the mode is converted).",
    )
    .rule("`free` needs both masses, except with kind `custom` or `none`")
    .default(Default::Word(MOTOR_HELD)),
    Key::new(
        MASSES[0],
        Values::Number(MASS),
        "Mass of the motor's side in kg, or inertia in kg·m², to convert a free mode.",
    ),
    Key::new(
        MASSES[1],
        Values::Number(MASS),
        "Mass of the load in kg, or inertia in kg·m², referred to the motor.",
    ),
    Key::new(
        "shaper",
        Values::Word(shaper::of_modes),
        "Kind of shaper of this mode. Absent: the axis's.",
    )
    .rule("a [kind](shaper-design.md#the-kinds) for one mode; under one for all modes: `zv`, `zvd` (`simultaneous`)"),
    Key::new(
        "tolerance",
        Values::Number(shaper::TOLERANCE),
        "Tolerance of this mode. Absent: the axis's.",
    ),
    Key {
        about: "`order` of this mode's kind, as in [axis.shaper].",
        ..shaper::ORDER
    },
    Key::new(
        FREQUENCY_BAND,
        Values::Number(DAMPING),
        "Relative uncertainty of the frequency, which `optimal` covers: 0.1 is ±10 %.",
    )
    .rule("the band must end below half of `sample_hz`")
    .default(Default::Number(0.0)),
    Key::new(
        DAMPING_BAND,
        Values::PlainPair(DAMPING),
        "Range [low, high] of the damping ratio. Absent: just `damping`.",
    )
    .rule("`damping` between them"),
    Key::new(
        "participation",
        Values::Number(PARTICIPATION),
        "Modal participation: share of the axis's response; only ratios count.",
    )
    .rule("not 0 in every mode")
    .default(Default::Number(1.0)),
];

/// Reads the modes of an axis whose shaper is of this kind, each with its table; `None` where a mode is refused.
pub(super) fn read_all<'r, 't>(
    axis: &Table<'r, 't>,
    clock: Option<ClockSection>,
    kind: Option<ShaperKind>,
) -> Option<Vec<(Table<'r, 't>, AxisMode)>> {
    let tables = axis.tables("mode", MAX_MODES);
    // All modes are read before the first refusal ends the reading, so that every mode's problems are reported.
    let modes: Vec<Option<(Table, AxisMode)>> = tables
        .into_iter()
        .enumerate()
        .map(|(index, table)| {
            let table = table.at(format!("{}, mode {}", axis.place(), index + 1));
            read(&table, clock, kind).map(|mode| (table, mode))
        })
        .collect();
    let modes: Vec<(Table, AxisMode)> = modes.into_iter().collect::<Option<_>>()?;
    if !modes.is_empty() && modes.iter().all(|(_, mode)| mode.participation == 0.0) {
        let found = "participation 0 in every mode";
        let remedy = "give the most visible mode a participation of 1";
        axis.contradiction("mode", found, "at least one mode with a participation above 0", remedy);
    }
    Some(modes)
}

fn read(table: &Table<'_, '_>, clock: Option<ClockSection>, axis_kind: Option<ShaperKind>) -> Option<AxisMode> {
    table.allow(KEYS);
    let kind = shaper::kind(table, "shaper");
    let tolerance = table.number("tolerance", shaper::TOLERANCE);
    let order = shaper::order(table);
    let participation = table.number("participation", PARTICIPATION).unwrap_or(1.0);
    let (mode, free, points) = if table.has(moving::POINTS) {
        let points = moving::read_points(table, clock)?;
        (points.first()?.mode, None, points)
    } else {
        if table.has(moving::MOVES_WITH) {
            let remedy = format!(
                "add `{} = [[value, frequency_hz, damping], …]`, or remove `{}`",
                moving::POINTS,
                moving::MOVES_WITH
            );
            let allowed = "the points of a mode that moves, together with its variable";
            table.contradiction(moving::MOVES_WITH, "a variable without `points`", allowed, remedy);
        }
        let (mode, free) = read_fixed(table, clock, axis_kind)?;
        (mode, free, Vec::new())
    };
    let frequency_band = table.number(FREQUENCY_BAND, DAMPING);
    if let Some(band) = frequency_band {
        check_band_below_half(table, &mode, band, clock?)?;
    }
    let damping_band = read_damping_band(table, &mode)?;
    Some(AxisMode {
        frequency_band,
        damping_band,
        mode,
        free,
        shaper: kind,
        tolerance,
        order,
        participation,
        points,
    })
}

/// Reads a mode that does not move. Returns it with the motor held, and as measured where that was with the motor
/// free.
fn read_fixed(
    table: &Table<'_, '_>,
    clock: Option<ClockSection>,
    axis_kind: Option<ShaperKind>,
) -> Option<(Mode, Option<Mode>)> {
    let remedy = format!("add `damping`, the part of critical damping: a steel frame has 0.005 to 0.05; {MEASURE}");
    table.require_with("damping", DAMPING, remedy);
    let damping = table.number("damping", DAMPING);
    let given = read_frequency(table, damping);
    let masses = read_masses(table, axis_kind);
    let given = Mode {
        frequency_hz: given?,
        damping: damping?,
    };
    let (mode, free) = match masses? {
        Some([motor, load]) => (given.with_motor_held(motor, load), Some(given)),
        None => (given, None),
    };
    check_below_half(table, &mode, clock?)?;
    Some((mode, free))
}

/// Reads the masses that convert a mode which was measured free. `Some(None)`: the mode is used as given. `None`: the
/// keys contradict each other.
fn read_masses(table: &Table<'_, '_>, axis_kind: Option<ShaperKind>) -> Option<Option<[f64; 2]>> {
    let [motor, load] = MASSES.map(|key| table.number(key, MASS));
    let measured = table.choice("measured", &MEASURED);
    let missing: Vec<&str> = MASSES.into_iter().filter(|key| table.lacks(key)).collect();
    if table.lacks("measured") && missing.len() < MASSES.len() {
        let found = "a mass without `measured`";
        let allowed =
            "masses with measured = \"free\", which they convert; without `measured` the mode is taken as it is";
        let present = MASSES.into_iter().find(|key| table.has(key)).unwrap_or(MASSES[0]);
        let remedy = "add `measured = \"free\"`, or `measured = \"motor_held\"`; docs/modes.md explains which";
        table.contradiction(present, found, allowed, remedy);
        return None;
    }
    // The impulses of these kinds do not depend on the modes.
    let changes_shaper = axis_kind.is_none_or(ShaperKind::depends_on_modes);
    if measured != Some(FREE) || (!changes_shaper && missing.len() == MASSES.len()) {
        return Some(None);
    }
    if !missing.is_empty() {
        let keys = missing.join(" and ");
        let found = format!("measured = \"free\" without {keys}");
        let allowed = "\"free\" with motor_mass and load_mass, which convert the mode to that of a held motor; else \"motor_held\"";
        let remedy = format!(
            "add {keys} (kg, of a rotary axis kg·m²), or measure with the position loop on, which holds the motor; \
             docs/modes.md says why the two differ"
        );
        table.contradiction("measured", found, allowed, remedy);
        return None;
    }
    Some(Some([motor?, load?]))
}

/// Reads the undamped natural frequency in Hz, from whichever of the two keys the file has.
fn read_frequency(table: &Table<'_, '_>, damping: Option<f64>) -> Option<f64> {
    match (table.has(UNDAMPED), table.has(DAMPED)) {
        (true, true) => {
            let found = "both frequency_hz and damped_frequency_hz";
            table.contradiction(DAMPED, found, "one of the two", "remove one of them");
            None
        }
        (true, false) => table.number(UNDAMPED, FREQUENCY_HZ),
        (false, true) => {
            let given = table.number(DAMPED, FREQUENCY_HZ)?;
            Some(given / (1.0 - damping? * damping?).sqrt())
        }
        (false, false) => {
            // Where one of the two is present but misspelt, that has been reported already.
            if table.lacks(UNDAMPED) && table.lacks(DAMPED) {
                let allowed = format!("{FREQUENCY_HZ}, or damped_frequency_hz or points in its place");
                table.require_with(UNDAMPED, allowed, format!("add `frequency_hz`; {MEASURE}"));
            }
            None
        }
    }
}

/// Checks that a mode lies below half the sample rate. Then its damped frequency does too, so `ω_d·T_s < π`, which two
/// taps need to place an impulse between two samples.
fn check_below_half(table: &Table<'_, '_>, mode: &Mode, clock: ClockSection) -> Option<()> {
    let (half, hz) = (clock.sample_hz / 2.0, mode.frequency_hz);
    if hz < half {
        return Some(());
    }
    let key = if table.has(UNDAMPED) { UNDAMPED } else { DAMPED };
    let converted = match (table.has("measured"), key == DAMPED) {
        (false, true) => format!(", an undamped frequency of {} Hz", short(hz)),
        (true, _) => format!(", with the motor held {} Hz", short(hz)),
        (false, false) => String::new(),
    };
    let found = format!("{}{converted}", table.quote(key));
    let allowed = format!("below {} Hz, half of clock.sample_hz", short(half));
    table.contradiction(key, found, allowed, above_half_remedy(hz, clock.sample_hz));
    None
}

/// Checks that the whole band of a mode lies below half the sample rate.
fn check_band_below_half(table: &Table<'_, '_>, mode: &Mode, band: f64, clock: ClockSection) -> Option<()> {
    let (half, high_hz) = (clock.sample_hz / 2.0, mode.frequency_hz * (1.0 + band));
    if high_hz < half {
        return Some(());
    }
    let most = half / mode.frequency_hz - 1.0;
    let found = format!("{band}, a band up to {} Hz", short(high_hz));
    let allowed = format!("a band that ends below {} Hz, half of clock.sample_hz", short(half));
    let remedy = format!("choose a band below {}, or raise clock.sample_hz", short(most));
    table.contradiction(FREQUENCY_BAND, found, allowed, remedy);
    None
}

/// Reads the band of the damping; `Some(None)` if the file has none. The band must contain `damping`, unless the mode moves and has
/// several.
fn read_damping_band(table: &Table<'_, '_>, mode: &Mode) -> Option<Option<[f64; 2]>> {
    if !table.has(DAMPING_BAND) {
        return Some(None);
    }
    let [low, high] = table.numbers::<2>(DAMPING_BAND, DAMPING)?;
    let moves = table.has(moving::POINTS);
    if low <= high && (moves || (low <= mode.damping && mode.damping <= high)) {
        return Some(Some([low, high]));
    }
    let allowed = if moves {
        "[low, high], low at most high".to_owned()
    } else {
        format!("[low, high] with the damping of {} between them", short(mode.damping))
    };
    table.refuse(
        DAMPING_BAND,
        allowed,
        "give the lowest and the highest damping ratio that was measured",
    );
    None
}

/// Returns the remedy for a mode above half the sample rate.
fn above_half_remedy(mode_hz: f64, sample_hz: f64) -> String {
    let right = |hz: f64| sample_hz < LIKELY_SAMPLE_HZ && hz > 2.0 * mode_hz;
    let otherwise = format!(
        "raise clock.sample_hz above {} Hz, twice the mode's frequency, or leave the mode out",
        short(2.0 * mode_hz)
    );
    match hint::in_other_unit("clock.sample_hz", sample_hz, &KILO, right) {
        Some(hint) => format!("{hint}; else {otherwise}"),
        None => otherwise,
    }
}
