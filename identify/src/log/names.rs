//! What the names of columns mean, and the units in them.

/// Meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    Time,
    /// Number of the sample.
    Index,
    /// Samples per second, in a column.
    Rate,
    /// How often the sensor's memory has overflowed so far.
    Overflows,
    /// Frequency of a line of a spectrum.
    Frequency,
    Command,
    Response,
    /// Difference between motor and scale.
    Deviation,
    /// Command of a drive.
    Drive,
    Acceleration,
    /// Only the letter of an axis, for an acceleration or a position.
    Axis,
    /// A length or an angle under another name.
    Length,
}

/// A column's name, and its meaning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    /// The name in lower case, its words joined by `_`.
    pub(super) text: String,
    pub(super) meaning: Option<Meaning>,
    /// Factor to SI units, if the name has a unit.
    pub(super) factor: Option<f64>,
}

/// The names of the columns with one meaning, and the units with which these names may end.
struct Known {
    meaning: Meaning,
    names: &'static [&'static str],
    units: &'static [(&'static str, f64)],
}

const LENGTH_UNITS: [(&str, f64); 12] = [
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("in", 0.0254),
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("deg", std::f64::consts::PI / 180.0),
    ("counts", 1.0),
    ("v", 1.0),
    ("volt", 1.0),
];

/// Number of the first length units that have no other meaning than a length or an angle.
const LENGTHS: usize = 9;

const TIME_UNITS: [(&str, f64); 15] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("secs", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("msec", 1e-3),
    ("milliseconds", 1e-3),
    ("us", 1e-6),
    ("usec", 1e-6),
    ("microseconds", 1e-6),
    ("ns", 1e-9),
    ("nsec", 1e-9),
    ("nanoseconds", 1e-9),
    ("min", 60.0),
];

/// Units of a drive's command. The scale does not matter, only how the command changes.
const DRIVE_UNITS: [(&str, f64); 9] = [
    ("n", 1.0),
    ("nm", 1.0),
    ("a", 1.0),
    ("ma", 1e-3),
    ("v", 1.0),
    ("percent", 1.0),
    ("m_s", 1.0),
    ("rad_s", 1.0),
    ("rpm", 1.0),
];

/// Standard acceleration of free fall in m/s².
pub(super) const GRAVITY: f64 = 9.806_65;

/// Number of the first [`ACCELERATION_UNITS`] that have no other meaning than an acceleration.
const ACCELERATIONS: usize = 31;

const ACCELERATION_UNITS: [(&str, f64); 37] = [
    ("mm_s2", 1e-3),
    ("mm_s_2", 1e-3),
    ("mm_s_s", 1e-3),
    ("mm_sec2", 1e-3),
    ("mms2", 1e-3),
    ("mms_2", 1e-3),
    ("cm_s2", 1e-2),
    ("cm_s_2", 1e-2),
    ("gal", 1e-2),
    ("um_s2", 1e-6),
    ("m_s2", 1.0),
    ("m_s_2", 1.0),
    ("m_s_s", 1.0),
    ("m_sec2", 1.0),
    ("m_sec_2", 1.0),
    ("ms2", 1.0),
    ("ms_2", 1.0),
    ("mps2", 1.0),
    ("in_s2", 0.0254),
    ("ft_s2", 0.3048),
    ("g", GRAVITY),
    ("gs", GRAVITY),
    ("g_s", GRAVITY),
    ("gn", GRAVITY),
    ("g0", GRAVITY),
    ("g_force", GRAVITY),
    ("gforce", GRAVITY),
    ("mg", 1e-3 * GRAVITY),
    ("milli_g", 1e-3 * GRAVITY),
    ("millig", 1e-3 * GRAVITY),
    ("ug", 1e-6 * GRAVITY),
    // These are raw values of the sensor's converter; the modes do not depend on their scale.
    ("counts", 1.0),
    ("count", 1.0),
    ("raw", 1.0),
    ("lsb", 1.0),
    ("v", 1.0),
    ("mv", 1e-3),
];

const KNOWN: [Known; 11] = [
    Known {
        meaning: Meaning::Time,
        names: &[
            "timestamp",
            "time_stamp",
            "time",
            "t",
            "elapsed",
            "elapsed_time",
            "time_elapsed",
            "chiptime",
            "chip_time",
            "datetime",
            "date_time",
            "x_axis",
            "zeit",
        ],
        units: &TIME_UNITS,
    },
    Known {
        meaning: Meaning::Index,
        names: &[
            "sample",
            "samples",
            "sample_number",
            "sample_no",
            "index",
            "idx",
            "no",
            "nr",
            "n",
            "count",
            "row",
            "seq",
            "",
        ],
        units: &[],
    },
    Known {
        meaning: Meaning::Rate,
        names: &["datarate", "data_rate"],
        units: &[("hz", 1.0)],
    },
    Known {
        meaning: Meaning::Overflows,
        names: &["overflows", "overflow"],
        units: &[],
    },
    Known {
        meaning: Meaning::Frequency,
        names: &[
            "freq",
            "frequency",
            "frequencies",
            "freqs",
            "freq_bins",
            "f",
            "frequenz",
        ],
        units: &[("hz", 1.0), ("khz", 1e3)],
    },
    Known {
        meaning: Meaning::Command,
        names: &[
            "command",
            "commanded_position",
            "commanded",
            "reference",
            "ref",
            "setpoint",
            "target",
            "demand",
            "input",
            "u",
        ],
        units: &LENGTH_UNITS,
    },
    Known {
        meaning: Meaning::Response,
        names: &[
            "response",
            "captured_position",
            "actual_position",
            "actual",
            "position",
            "displacement",
            "deflection",
            "measured",
            "feedback",
            "encoder",
            "output",
        ],
        units: &LENGTH_UNITS,
    },
    Known {
        meaning: Meaning::Drive,
        names: &["drive_command", "drive", "torque", "force", "current", "duty"],
        units: &DRIVE_UNITS,
    },
    Known {
        meaning: Meaning::Deviation,
        names: &["deviation"],
        units: &LENGTH_UNITS,
    },
    Known {
        meaning: Meaning::Acceleration,
        names: &DIRECTIONS,
        units: &ACCELERATION_UNITS,
    },
    Known {
        meaning: Meaning::Axis,
        names: &["x", "y", "z"],
        units: &[],
    },
];

/// Names that include their unit.
const TIMES_WITH_UNIT: [(&str, f64); 9] = [
    ("seconds_elapsed", 1.0),
    ("seconds", 1.0),
    ("sec", 1.0),
    ("milliseconds", 1e-3),
    ("millis", 1e-3),
    ("ms", 1e-3),
    ("microseconds", 1e-6),
    ("micros", 1e-6),
    ("nanoseconds", 1e-9),
];

/// The directions of an accelerometer, by the names that printer firmware gives them.
const DIRECTIONS: [&str; 3] = ["accel_x", "accel_y", "accel_z"];

/// Other names for the directions, without the letter of the direction.
const OTHER_DIRECTIONS: [(&str, &str); 23] = [
    ("acceleration_", "_axis"),
    ("acceleration_", ""),
    ("accelerometer_", ""),
    ("linear_acceleration_", ""),
    ("linear_accelerometer_", ""),
    ("linear_accel_", ""),
    ("lin_acc_", ""),
    ("total_acceleration_", ""),
    ("raw_acceleration_", ""),
    ("accelerometeracceleration", ""),
    ("acceleration", ""),
    ("beschleunigung_", ""),
    ("accel", ""),
    ("acc_", ""),
    ("acc", ""),
    ("a_", ""),
    ("a", ""),
    ("gf", ""),
    ("g_force_", ""),
    ("", "_axis_acceleration"),
    ("", "_acceleration"),
    ("", "_accel"),
    ("", "_acc"),
];

/// Other names of an axis that consist of its letter and no quantity.
const OTHER_AXES: [(&str, &str); 7] = [
    ("", "_axis"),
    ("axis_", ""),
    ("", "_value"),
    ("", "_data"),
    ("", "0"),
    ("", "1"),
    ("", "2"),
];

impl Name {
    /// Interprets a field of a header: `Accel X (m/s²)` is the acceleration `accel_x_m_s2`.
    pub(super) fn of(field: &str) -> Self {
        let text = canonical(&plain(field));
        // `x-axis` alone may be a direction or the abscissa of an oscilloscope.
        let is_direction = text != "x_axis" && !text.starts_with("x_axis_");
        let as_axis = is_direction.then(|| axis(&text)).flatten();
        if let Some((meaning, factor)) = as_axis.or_else(|| known(&text)).or_else(|| bracketed(field)) {
            return Self {
                text,
                meaning: Some(meaning),
                factor,
            };
        }
        Self {
            text,
            meaning: None,
            factor: None,
        }
    }

    /// The letter of the axis in a name such as `accel_x_g` or `y`.
    pub(super) fn letter(&self) -> Option<char> {
        let text = self.text.strip_prefix("accel_").unwrap_or(&self.text);
        let text = text.strip_prefix("axis_").unwrap_or(text);
        text.chars().next().filter(|letter| matches!(letter, 'x' | 'y' | 'z'))
    }

    /// Whether the name is that of a column of a spectrum.
    pub(super) fn is_spectral(&self) -> bool {
        const BEGINNINGS: [&str; 5] = ["psd", "fft", "amplitude_spectr", "power_spectr", "magnitude_db"];
        self.meaning == Some(Meaning::Frequency) || BEGINNINGS.iter().any(|begin| self.text.starts_with(begin))
    }
}

/// A name without what writers put around it: `Command [mm]` is `command_mm`.
fn plain(name: &str) -> String {
    let name = name.trim_start_matches(['#', ';', '%']).trim().to_lowercase();
    let name = name
        .replace("^2", "2")
        .replace('²', "2")
        .replace("⁻2", "_2")
        .replace(['µ', 'μ'], "u")
        .replace('°', "deg");
    let words = name
        .split(|letter: char| " \t[](){}<>_/-.:*·,;'\"^=#".contains(letter))
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// Replaces another name of a direction by the firmware's: `acc_x_g` becomes `accel_x_g`.
fn canonical(name: &str) -> String {
    for (letter, direction) in ["x", "y", "z"].into_iter().zip(DIRECTIONS) {
        for (before, behind) in OTHER_DIRECTIONS {
            if let Some(rest) = between(name, before, letter, behind) {
                return format!("{direction}{rest}");
            }
        }
    }
    name.to_owned()
}

/// Returns the rest of a name after these three parts, if it is empty or begins a new word.
fn between<'a>(name: &'a str, before: &str, letter: &str, behind: &str) -> Option<&'a str> {
    let rest = name.strip_prefix(before)?.strip_prefix(letter)?.strip_prefix(behind)?;
    (rest.is_empty() || rest.starts_with('_')).then_some(rest)
}

fn known(name: &str) -> Option<(Meaning, Option<f64>)> {
    if let Some((_, factor)) = TIMES_WITH_UNIT.iter().find(|(time, _)| *time == name) {
        return Some((Meaning::Time, Some(*factor)));
    }
    KNOWN.iter().find_map(|known| {
        let factor = known.names.iter().find_map(|stem| {
            let rest = name.strip_prefix(stem)?;
            if rest.is_empty() {
                return Some(None);
            }
            factor(known.units, rest.strip_prefix('_')?).map(Some)
        })?;
        Some((known.meaning, factor))
    })
}

fn factor(units: &[(&str, f64)], unit: &str) -> Option<f64> {
    units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
}

/// Interprets a unit of acceleration, length or angle.
fn meaning_of_unit(unit: &str) -> Option<(Meaning, Option<f64>)> {
    if let Some(factor) = factor(&ACCELERATION_UNITS[..ACCELERATIONS], unit) {
        return Some((Meaning::Acceleration, Some(factor)));
    }
    factor(&LENGTH_UNITS[..LENGTHS], unit).map(|factor| (Meaning::Length, Some(factor)))
}

/// Interprets a name that is only the letter of an axis, with or without a unit.
fn axis(name: &str) -> Option<(Meaning, Option<f64>)> {
    ["x", "y", "z"].into_iter().find_map(|letter| {
        let forms = [("", "")].into_iter().chain(OTHER_AXES);
        let rest = forms.filter_map(|(before, behind)| between(name, before, letter, behind));
        rest.filter_map(|rest| match rest.strip_prefix('_') {
            None => Some((Meaning::Axis, None)),
            Some(unit) => meaning_of_unit(unit),
        })
        .next()
    })
}

/// Interprets an unknown name with its unit in brackets: `Channel 1 [g]`.
fn bracketed(field: &str) -> Option<(Meaning, Option<f64>)> {
    let field = field.trim().trim_end_matches([')', ']']);
    let (_, unit) = field.rsplit_once(['(', '['])?;
    meaning_of_unit(&plain(unit))
}

/// Whether a field contains only a unit.
pub(super) fn is_unit(field: &str) -> bool {
    let unit = plain(field);
    let tables = [&TIME_UNITS[..], &LENGTH_UNITS, &DRIVE_UNITS, &ACCELERATION_UNITS];
    tables.iter().any(|units| factor(units, &unit).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_field_are_understood() {
        let g = Some(GRAVITY);
        let cases = [
            ("#time", Meaning::Time, None),
            ("Time(s)", Meaning::Time, Some(1.0)),
            ("t_us", Meaning::Time, Some(1e-6)),
            ("millis", Meaning::Time, Some(1e-3)),
            ("Sample", Meaning::Index, None),
            ("", Meaning::Index, None),
            ("accel_x", Meaning::Acceleration, None),
            ("accel_z_mg", Meaning::Acceleration, Some(1e-3 * GRAVITY)),
            ("ax(g)", Meaning::Acceleration, g),
            ("a_y", Meaning::Acceleration, None),
            ("gFz", Meaning::Acceleration, None),
            ("AccX [mm/s²]", Meaning::Acceleration, Some(1e-3)),
            ("Acc.Y", Meaning::Acceleration, None),
            ("Acceleration x (m/s^2)", Meaning::Acceleration, Some(1.0)),
            ("Linear Acceleration z (m/s^2)", Meaning::Acceleration, Some(1.0)),
            ("x-acceleration", Meaning::Acceleration, None),
            ("accel_y_ms2", Meaning::Acceleration, Some(1.0)),
            ("accel_y_m_s2", Meaning::Acceleration, Some(1.0)),
            ("Accel Z (m·s⁻²)", Meaning::Acceleration, Some(1.0)),
            ("accelerometerAccelerationX(G)", Meaning::Acceleration, g),
            ("AI 1 [g]", Meaning::Acceleration, g),
            ("X (g)", Meaning::Acceleration, g),
            ("x_mm", Meaning::Length, Some(1e-3)),
            ("Laser 2 (µm)", Meaning::Length, Some(1e-6)),
            ("X", Meaning::Axis, None),
            ("z-axis", Meaning::Axis, None),
            ("y1", Meaning::Axis, None),
            ("x-axis", Meaning::Time, None),
            ("DataRate", Meaning::Rate, None),
            ("freq", Meaning::Frequency, None),
            ("Frequency (Hz)", Meaning::Frequency, Some(1.0)),
            ("u", Meaning::Command, None),
        ];
        for (field, meaning, factor) in cases {
            let name = Name::of(field);
            assert_eq!(
                (name.meaning, name.factor),
                (Some(meaning), factor),
                "{field}: {name:?}"
            );
        }
        for field in [
            "gyro_x",
            "g_x",
            "wx(deg/s)",
            "Magnetic field x (µT)",
            "TgF",
            "temperature",
            "psd_x",
        ] {
            assert_eq!(Name::of(field).meaning, None, "{field}");
        }
        assert_eq!(
            (Name::of("AccY(g)").letter(), Name::of("z1").letter()),
            (Some('y'), Some('z'))
        );
        assert!(Name::of("psd_xyz").is_spectral() && !Name::of("accel_x").is_spectral());
    }
}
