//! `[[axis]]` and `[[axis.mode]]`, and which of an axis's blocks need each other.

use super::hint::{self, KILO};
use super::key::{Default, Key, Values};
use super::range::{COUNTS_PER_UNIT, NumberRange};
use super::table::Table;
use super::{
    AxisMode, AxisSection, ClockSection, FixedPoint, ScaleUse, controller, drive, encoder, limits, pwm, scale, shaper,
    trace,
};
use crate::mode::Mode;
use crate::rtl::shaper::MOTION_WORD_BITS;
use crate::unit::{AxisUnit, short};

/// Modes of an axis: with five impulses each their convolution has 390,625, far more than any table holds.
const MAX_MODES: usize = 8;
/// A frequency before it is compared with the sample rate; below this a shaper would last for hours.
const FREQUENCY_HZ: NumberRange = NumberRange::closed(1e-3, 1e9).unit("Hz");
/// Damping ratio of a mode that rings.
const DAMPING: NumberRange = NumberRange::closed(0.0, 1.0).open_above();
/// Where the figures of a mode come from.
pub(super) const MEASURE: &str = "docs/modes.md says how to measure frequency and damping";
/// A sample rate below this is most likely given in kHz.
const LIKELY_SAMPLE_HZ: f64 = 100.0;
/// Weights of the modes.
const PARTICIPATION: NumberRange = NumberRange::closed(0.0, 1e9);

/// The keys of `[[axis]]`.
pub(super) const KEYS: &[Key] = &[
    Key::new("name", Values::Name, "Name of the axis, unique in the machine.").required(),
    Key::new(
        "counts_per_unit",
        Values::Counts(COUNTS_PER_UNIT),
        "Encoder counts per unit of the axis.",
    )
    .required(),
    Key::new(
        "unit",
        Values::Word(|| AxisUnit::ALL.map(|(_, name)| name).to_vec()),
        "What the figures of the axis are in, its counts among them.",
    )
    .default(Default::Word("m")),
    Key::switch(
        "modulo",
        "The position counts on across the word's end: a rotary axis without an end.",
    ),
    Key::new(
        "shaper",
        Values::Table(shaper::KEYS),
        "One shaper for the axis; absent where every mode has `shaper`.",
    ),
    Key::new(
        "mode",
        Values::Tables(MODE_KEYS, MAX_MODES),
        "The modes of vibration; none is allowed with kind custom or none.",
    ),
    Key::new(
        "encoder",
        Values::Table(encoder::KEYS),
        "Reads the position from an encoder.",
    ),
    Key::new("scale", Values::Table(scale::KEYS), "Reads a linear scale at the load."),
    Key::new("pwm", Values::Table(pwm::KEYS), "Drives the pins."),
    Key::new(
        "drive",
        Values::Table(drive::KEYS),
        "What the duty of the PWM commands.",
    ),
    Key::new("controller", Values::Table(controller::KEYS), "Closes the loop."),
    Key::new(
        "limits",
        Values::Table(limits::KEYS),
        "What moves may ask for, and what the supervisor of the axis watches.",
    ),
    Key::new("trace", Values::Table(trace::KEYS), "Records signals of the loop."),
];

/// The keys of `[[axis.mode]]`.
const MODE_KEYS: &[Key] = &[
    Key::new(
        "frequency_hz",
        Values::Number(FREQUENCY_HZ),
        "Undamped natural frequency in Hz, below half of `sample_hz`.",
    ),
    Key::new(
        "damped_frequency_hz",
        Values::Number(FREQUENCY_HZ),
        "In place of `frequency_hz`: the frequency of the ringing, f·√(1−ζ²).",
    )
    .instead_of("frequency_hz"),
    Key::new("damping", Values::Number(DAMPING), "Damping ratio ζ.").required(),
    Key::new(
        "shaper",
        Values::Word(shaper::of_modes),
        "Kind of shaper for this mode, instead of the axis's.",
    ),
    Key::new(
        "tolerance",
        Values::Number(shaper::TOLERANCE),
        "As in [axis.shaper], for this mode; else the axis's.",
    ),
    shaper::ORDER,
    Key::new(
        "participation",
        Values::Number(PARTICIPATION),
        "Weight of the mode in what the tool does; only ratios count.",
    )
    .default(Default::Number(1.0)),
];

/// Reads one axis under a name that was read before. Without a valid clock or number format the checks that need them
/// are left out.
pub(super) fn read(
    table: &Table<'_, '_>,
    name: Option<String>,
    clock: Option<ClockSection>,
    fixed_point: Option<FixedPoint>,
) -> Option<AxisSection> {
    table.allow(KEYS);
    let unit = read_unit(table);
    let counts_per_unit = table.required_counts("counts_per_unit", COUNTS_PER_UNIT, unit);
    let choice = table
        .table("shaper")
        .map(|t| shaper::read(&t, clock).map(|choice| (t, choice)));
    let modes = read_modes(table, clock);
    // A shaper that was refused is not compared with the modes: what it lacks would be reported twice.
    if let Some(modes) = modes.as_ref().filter(|_| !matches!(choice, Some(None))) {
        shaper::check(table, choice.as_ref().and_then(Option::as_ref), modes);
    }
    let modulo = read_modulo(table, fixed_point);
    let encoder = table.table("encoder").map(|t| encoder::read(&t));
    let pwm = table.table("pwm").map(|t| pwm::read(&t, clock));
    let drive = table.table("drive").map(|t| drive::read(&t, unit));
    let controller = table.table("controller").map(|t| controller::read(&t, unit));
    let scale = table.table("scale").map(|t| scale::read(table, &t, unit));
    let trace = table.table("trace").map(|t| trace::read(&t));
    let loop_counts_per_unit = match scale {
        Some(Some(scale)) if scale.usage == ScaleUse::Position => Some(scale.counts_per_unit),
        _ => counts_per_unit,
    };
    // The position of a modulo axis wraps: any travel fits.
    let word = loop_counts_per_unit.zip(fixed_point).filter(|_| !modulo);
    let limits = table.table("limits").map(|t| limits::read(table, &t, word, unit));
    check_needs(table);
    let shaper = match choice {
        Some(choice) => Some(choice?.1),
        None => None,
    };
    Some(AxisSection {
        name: name?,
        unit,
        counts_per_unit: counts_per_unit?,
        modulo,
        shaper,
        modes: modes?.into_iter().map(|(_, mode)| mode).collect(),
        encoder: not_refused(encoder)?,
        pwm: not_refused(pwm)?,
        drive: not_refused(drive)?,
        controller: not_refused(controller)?,
        limits,
        scale: not_refused(scale)?,
        trace: not_refused(trace)?,
    })
}

/// A table that may be absent; `None` where it is there and refused.
fn not_refused<T>(read: Option<Option<T>>) -> Option<Option<T>> {
    match read {
        Some(value) => value.map(Some),
        None => Some(None),
    }
}

/// The unit of the axis's figures; metres where the file has none, or one that is refused.
fn read_unit(table: &Table<'_, '_>) -> AxisUnit {
    let word = table.choice("unit", &AxisUnit::ALL.map(|(_, name)| name));
    let unit = AxisUnit::ALL.into_iter().find(|(_, name)| Some(*name) == word);
    unit.map_or(AxisUnit::default(), |(unit, _)| unit)
}

/// Whether the axis is rotary: its shaper is then the one for motion, which not every word width has.
fn read_modulo(table: &Table<'_, '_>, fixed_point: Option<FixedPoint>) -> bool {
    let modulo = table.boolean("modulo") == Some(true);
    let bits = fixed_point.map(|format| format.command_bits);
    if let Some(bits) = bits.filter(|bits| modulo && !MOTION_WORD_BITS.contains(bits)) {
        let (least, most) = (MOTION_WORD_BITS.start(), MOTION_WORD_BITS.end());
        let found = format!("modulo = true with command words of {bits} bits");
        let allowed = format!("modulo = true with fixed_point.command_bits = {least} to {most}");
        let remedy = format!("set fixed_point.command_bits = {least}");
        table.contradiction("modulo", found, allowed, remedy);
    }
    modulo
}

/// A block of an axis that others must be there for.
pub(super) struct Need {
    pub(super) block: &'static str,
    pub(super) others: &'static [&'static str],
    allowed: &'static str,
}

/// Which blocks of an axis cannot work without others.
pub(super) const NEEDS: [Need; 4] = [
    Need {
        block: "scale",
        others: &["encoder"],
        allowed: "a scale with [axis.encoder], the motor's, which it is compared with",
    },
    Need {
        block: "drive",
        others: &["pwm"],
        allowed: "a drive with its [axis.pwm], which commands it",
    },
    Need {
        block: "controller",
        others: &["encoder", "pwm", "drive"],
        allowed: "a controller with [axis.encoder], [axis.pwm] and [axis.drive]: the position, the pins, and what they command",
    },
    Need {
        block: "trace",
        others: &["controller"],
        allowed: "a trace with [axis.controller], whose loop it records",
    },
];

/// Checks that every block finds the others that it cannot work without.
fn check_needs(axis: &Table<'_, '_>) {
    for Need { block, others, allowed } in NEEDS {
        let missing: Vec<String> = others
            .iter()
            .filter(|other| axis.lacks(other))
            .map(|other| format!("[axis.{other}]"))
            .collect();
        if axis.has(block) && !missing.is_empty() {
            let missing = listed(&missing);
            let found = format!("[axis.{block}] without {missing}");
            let remedy = format!("add {missing}, or remove [axis.{block}]");
            axis.contradiction(block, found, allowed, remedy);
        }
    }
}

/// `a, b and c`.
fn listed(words: &[String]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        words => words.concat(),
    }
}

/// Reads the modes, each with its table; `None` where one of them is refused.
fn read_modes<'r, 't>(axis: &Table<'r, 't>, clock: Option<ClockSection>) -> Option<Vec<(Table<'r, 't>, AxisMode)>> {
    let tables = axis.tables("mode", MAX_MODES);
    // All are read before the first refusal ends it: every mode's problems are to be shown.
    let modes: Vec<Option<(Table, AxisMode)>> = tables
        .into_iter()
        .enumerate()
        .map(|(index, table)| {
            let table = table.at(format!("{}, mode {}", axis.place(), index + 1));
            read_mode(&table, clock).map(|mode| (table, mode))
        })
        .collect();
    let modes: Vec<(Table, AxisMode)> = modes.into_iter().collect::<Option<_>>()?;
    if !modes.is_empty() && modes.iter().all(|(_, mode)| mode.participation == 0.0) {
        let found = "participation 0 in every mode";
        let remedy = "give the mode that is seen most a participation of 1";
        axis.contradiction("mode", found, "at least one mode with a participation above 0", remedy);
    }
    Some(modes)
}

fn read_mode(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<AxisMode> {
    table.allow(MODE_KEYS);
    let remedy = format!("add `damping`, the part of critical damping: a steel frame has 0.005 to 0.05; {MEASURE}");
    table.require_with("damping", DAMPING, remedy);
    let damping = table.number("damping", DAMPING);
    let frequency = read_frequency(table, damping, clock);
    let kind = shaper::kind(table, "shaper");
    let tolerance = table.number("tolerance", shaper::TOLERANCE);
    let order = shaper::order(table);
    let participation = table.number("participation", PARTICIPATION).unwrap_or(1.0);
    Some(AxisMode {
        mode: Mode {
            frequency_hz: frequency?,
            damping: damping?,
        },
        shaper: kind,
        tolerance,
        order,
        participation,
    })
}

/// The undamped natural frequency in Hz, from the one of the two keys that the file gives.
///
/// It must lie below half the sample rate: then so does the damped frequency, where the ringing and the pole are, and
/// `ω_d·T_s < π`, without which two taps cannot place an impulse between two samples.
fn read_frequency(table: &Table<'_, '_>, damping: Option<f64>, clock: Option<ClockSection>) -> Option<f64> {
    let (undamped, damped) = ("frequency_hz", "damped_frequency_hz");
    let key = match (table.has(undamped), table.has(damped)) {
        (true, true) => {
            let found = "both frequency_hz and damped_frequency_hz";
            table.contradiction(damped, found, "one of the two", "remove one of them");
            return None;
        }
        (false, false) => {
            // Whichever of the two is misspelt is there.
            if table.lacks(undamped) && table.lacks(damped) {
                let allowed = format!("{FREQUENCY_HZ}, or damped_frequency_hz in its place");
                table.require_with(undamped, allowed, format!("add `frequency_hz`; {MEASURE}"));
            }
            return None;
        }
        (true, false) => undamped,
        (false, true) => damped,
    };
    let given = table.number(key, FREQUENCY_HZ)?;
    let frequency_hz = if key == damped {
        given / (1.0 - damping? * damping?).sqrt()
    } else {
        given
    };
    let half = clock?.sample_hz / 2.0;
    if frequency_hz >= half {
        let converted = if key == damped {
            format!(", an undamped frequency of {} Hz", short(frequency_hz))
        } else {
            String::new()
        };
        let found = format!("{}{converted}", table.quote(key));
        let allowed = format!("below {} Hz, half of clock.sample_hz", short(half));
        table.contradiction(key, found, allowed, above_half_remedy(frequency_hz, 2.0 * half));
        return None;
    }
    Some(frequency_hz)
}

/// What to do about a mode that the samples cannot follow.
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
