//! `[[axis]]`: reading one axis, and checking that each of its blocks finds the others that it needs.

use super::key::{Default, Key, Values};
use super::range::COUNTS_PER_UNIT;
use super::table::Table;
use super::{
    AxisSection, ClockSection, FixedPoint, ScaleUse, absolute, compare, controller, correction, drive, encoder,
    error_table, input, limits, mechanics, mode, moving, probe, pwm, scale, shaper, stepper, steps, trace,
};
use crate::unit::AxisUnit;
use posicast_blocks::shaper::MOTION_WORD_BITS;

/// The keys of `[[axis]]`.
pub(super) const KEYS: &[Key] = &[
    Key::new("name", Values::Name, "Unique name of the axis.").required(),
    Key::new(
        "counts_per_unit",
        Values::Counts(COUNTS_PER_UNIT),
        "Encoder counts per unit; with [axis.steps], steps per unit.",
    )
    .required(),
    Key::new(
        "unit",
        Values::Word(|| AxisUnit::ALL.map(|(_, name)| name).to_vec()),
        "Unit of the axis's lengths or angles.",
    )
    .default(Default::Word("m")),
    Key::switch(
        "modulo",
        "Rotary axis without end stops: the position wraps at the end of its word.",
    )
    .rule("needs words of 18 to 32 bits"),
    Key::new(
        "shaper",
        Values::Table(shaper::KEYS),
        "Shaper of the axis; optional if every mode has `shaper`.",
    ),
    Key::new(
        "mode",
        Values::Tables(mode::KEYS, mode::MAX_MODES),
        "Modes of vibration; optional with kind `custom` or `none`.",
    ),
    Key::new(
        "mechanics",
        Values::Table(mechanics::KEYS),
        "Data sheet of a ball screw, in place of `[[axis.mode]]`.",
    )
    .rule("the `unit` must be a length"),
    Key::new(
        "family",
        Values::Table(moving::KEYS),
        "Tap tables of an axis whose modes move.",
    )
    .rule("needs a mode with `points`"),
    Key::new("encoder", Values::Table(encoder::KEYS), "Position encoder."),
    Key::new("scale", Values::Table(scale::KEYS), "Linear scale at the load."),
    Key::new("pwm", Values::Table(pwm::KEYS), "Pulse width modulator."),
    Key::new("drive", Values::Table(drive::KEYS), "Drive behind the PWM."),
    Key::new(
        "controller",
        Values::Table(controller::KEYS),
        "Controller of the position loop.",
    ),
    Key::new(
        "steps",
        Values::Table(steps::KEYS),
        "Lines of a drive with step inputs, in place of encoder, PWM, drive and controller.",
    )
    .rule("needs `[axis.limits]` with `velocity`"),
    Key::new(
        "stepper",
        Values::Table(stepper::KEYS),
        "Stepper motor behind the steps, for the simulation. Absent: a drive that is always at its steps.",
    ),
    Key::new(
        "probe",
        Values::Table(probe::KEYS),
        "Touch switch at which the axis is homed.",
    ),
    Key::new(
        "compare",
        Values::Table(compare::KEYS),
        "Line that pulses where the axis passes positions.",
    ),
    Key::new(
        "correction",
        Values::Table(correction::KEYS),
        "Missing steps that a host gives while the axis rests.",
    ),
    Key::new(
        "input",
        Values::Table(input::KEYS),
        "Lines of a controller whose step pulses are shaped, in place of a host's commands.",
    )
    .rule("needs `[axis.steps]`, on every axis of the machine"),
    Key::new(
        "limits",
        Values::Table(limits::KEYS),
        "Limits of moves, and settings of the supervisor.",
    ),
    Key::new(
        "trace",
        Values::Table(trace::KEYS),
        "Memory that records signals of the loop.",
    )
    .rule("with `[axis.input]` needs `[link]`"),
    Key::new(
        "error_table",
        Values::Table(error_table::KEYS),
        "Compensation of a measured position error.",
    ),
];

/// Reads one axis, whose name has been read already. Checks that need a valid clock or number format are skipped
/// without one.
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
    let kind = choice
        .as_ref()
        .and_then(|choice| choice.as_ref())
        .map(|(_, choice)| choice.kind);
    let screw = table.has("mechanics").then(|| mechanics::read(table, clock, unit));
    let given = mode::read_all(table, clock, kind);
    let (mut modes, mechanics) = match screw {
        None => (given, None),
        Some(None) => (None, None),
        Some(Some((screw_table, mode, screw))) => (given.map(|_| vec![(screw_table, mode)]), Some(screw)),
    };
    let family = modes.as_mut().and_then(|modes| moving::read_family(table, modes, unit));
    let modulo = read_modulo(table, fixed_point);
    // A shaper that was refused is not compared with the modes, so that its fault is not reported twice.
    if let Some(modes) = modes.as_ref().filter(|_| !matches!(choice, Some(None))) {
        shaper::check(table, choice.as_ref().and_then(Option::as_ref), modes, modulo);
    }
    let encoder = table.table("encoder").map(|t| (encoder::read(&t), t));
    let pwm = table.table("pwm").map(|t| pwm::read(&t, clock));
    let drive = table.table("drive").map(|t| drive::read(&t, unit));
    let controller = table.table("controller").map(|t| controller::read(&t, unit));
    let steps = table.table("steps").map(|t| (steps::read(&t, clock), t));
    let stepper = table.table("stepper").map(|t| stepper::read(&t, unit));
    let probe = table.table("probe").map(|t| (probe::read(&t, unit, clock), t));
    let compare = table.table("compare").map(|t| (compare::read(&t, unit), t));
    let correction = table.table("correction").map(|t| (correction::read(&t, unit), t));
    let input = table.table("input").map(|t| (input::read(&t, clock), t));
    let scale = table.table("scale").map(|t| scale::read(table, &t, unit));
    let trace = table.table("trace").map(|t| trace::read(&t));
    let loop_counts_per_unit = match scale {
        Some(Some(scale)) if scale.usage == ScaleUse::Position => Some(scale.counts_per_unit),
        _ => counts_per_unit,
    };
    // The position of a modulo axis wraps: any travel fits.
    let word = loop_counts_per_unit.zip(fixed_point).filter(|_| !modulo);
    let limits = table
        .table("limits")
        .map(|t| limits::read(table, &t, word, unit, clock));
    let error_table = table.table("error_table").map(|t| {
        let of_axis = error_table::OfAxis {
            unit,
            counts_per_unit: loop_counts_per_unit,
            limits: limits.as_ref(),
            modulo,
            on_scale: scale.is_some_and(|scale| scale.is_some_and(|scale| scale.usage == ScaleUse::Position)),
        };
        error_table::read(&t, of_axis)
    });
    check_needs(table);
    if let Some((Some(encoder), inner)) = &encoder
        && let Some(absolute) = &encoder.absolute
    {
        let of_axis = absolute::OfAxis {
            unit,
            counts_per_unit,
            limits: limits.as_ref(),
            clock,
            fixed_point,
            modulo,
        };
        absolute::check(inner, absolute, &of_axis);
        check_beside_absolute(table);
    }
    if let Some((Some(steps), table)) = &steps {
        let of_axis = steps::OfAxis {
            counts_per_unit,
            limits: limits.as_ref(),
            clock,
            fixed_point,
        };
        steps::check(table, steps, &of_axis);
    }
    if let Some((Some(probe), table)) = &probe {
        probe::check(table, probe, limits.as_ref(), unit);
    }
    if let Some((Some(compare), table)) = &compare {
        let of_axis = compare::OfAxis {
            unit,
            counts_per_unit,
            limits: limits.as_ref(),
            clock,
        };
        compare::check(table, compare, &of_axis);
    }
    if let Some((Some(correction), table)) = &correction {
        correction::check(table, correction, limits.as_ref(), (unit, counts_per_unit));
    }
    if let Some((Some(input), table)) = &input {
        input::check(table, input, limits.as_ref(), counts_per_unit);
    }
    if let Some(family) = family.as_ref().and_then(Option::as_ref) {
        moving::check(table, family, kind, limits.as_ref(), modulo, unit);
    }
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
        mechanics,
        family: family?,
        encoder: not_refused(encoder.map(|(encoder, _)| encoder))?,
        pwm: not_refused(pwm)?,
        drive: not_refused(drive)?,
        controller: not_refused(controller)?,
        steps: not_refused(steps.map(|(steps, _)| steps))?,
        input: not_refused(input.map(|(input, _)| input))?,
        stepper: not_refused(stepper)?,
        probe: not_refused(probe.map(|(probe, _)| probe))?,
        limits,
        scale: not_refused(scale)?,
        compare: not_refused(compare.map(|(compare, _)| compare))?,
        correction: not_refused(correction.map(|(correction, _)| correction))?,
        error_table: not_refused(error_table)?,
        trace: not_refused(trace)?,
    })
}

/// Turns what a reader returned round, so that `?` ends at a refusal: `Some(None)` where the table is absent, `None`
/// where it was refused.
pub(super) fn not_refused<T>(read: Option<Option<T>>) -> Option<Option<T>> {
    match read {
        Some(value) => value.map(Some),
        None => Some(None),
    }
}

/// The unit of the axis's figures; metres where the file has none, or one that is refused.
fn read_unit(table: &Table<'_, '_>) -> AxisUnit {
    let names = AxisUnit::ALL.map(|(_, name)| name);
    let word = table.choice_else(
        "unit",
        &names,
        "write lengths in mm (an inch is 25.4 mm), angles in deg or rad",
    );
    let unit = AxisUnit::ALL.into_iter().find(|(_, name)| Some(*name) == word);
    unit.map_or(AxisUnit::default(), |(unit, _)| unit)
}

/// Reads whether the axis is rotary. A rotary axis needs the shaper for motion, which not every word width has.
fn read_modulo(table: &Table<'_, '_>, fixed_point: Option<FixedPoint>) -> bool {
    let modulo = table.boolean("modulo") == Some(true);
    let bits = fixed_point.map(|format| format.command_bits);
    if let Some(bits) = bits.filter(|bits| modulo && !MOTION_WORD_BITS.contains(bits)) {
        let (least, most) = (MOTION_WORD_BITS.start(), MOTION_WORD_BITS.end());
        let found = format!("modulo = true with command words of {bits} bits");
        let allowed = format!("modulo = true with fixed_point.command_bits = {least} to {most}");
        let remedy = if table.has("controller") {
            format!("set fixed_point.command_bits = {most}, which a stage needs")
        } else {
            format!("set fixed_point.command_bits = {least}")
        };
        table.contradiction("modulo", found, allowed, remedy);
    }
    modulo
}

/// A block of an axis, with the other blocks that it needs.
pub(super) struct Need {
    pub(super) block: &'static str,
    pub(super) others: &'static [&'static str],
    /// A block that does in place of the others.
    pub(super) or: Option<&'static str>,
    allowed: &'static str,
}

/// Blocks of an axis that need other blocks.
pub(super) const NEEDS: [Need; 11] = [
    Need {
        block: "scale",
        others: &["encoder"],
        or: Some("steps"),
        allowed: "a scale with [axis.encoder], the motor's, which it is compared with, or with [axis.steps]",
    },
    Need {
        block: "drive",
        others: &["pwm"],
        or: None,
        allowed: "a drive with its [axis.pwm], which commands it",
    },
    Need {
        block: "controller",
        others: &["encoder", "pwm", "drive"],
        or: None,
        allowed: "a controller with [axis.encoder], [axis.pwm] and [axis.drive]: the position, the pins, and what they command",
    },
    Need {
        block: "steps",
        others: &["limits"],
        or: None,
        allowed: "steps with [axis.limits], whose velocity is their largest rate",
    },
    Need {
        block: "stepper",
        others: &["steps"],
        or: None,
        allowed: "a stepper motor with [axis.steps], which turn its field",
    },
    Need {
        block: "probe",
        others: &["steps"],
        or: None,
        allowed: "a probe with [axis.steps]; an axis with an encoder is homed by its index",
    },
    Need {
        block: "compare",
        others: &["controller"],
        or: Some("steps"),
        allowed: "a compare with [axis.controller] or [axis.steps], whose count it compares",
    },
    Need {
        block: "correction",
        others: &["steps", "scale"],
        or: None,
        allowed: "a correction with [axis.steps] and [axis.scale], which shows the missing steps",
    },
    Need {
        block: "input",
        others: &["steps"],
        or: None,
        allowed: "an input with [axis.steps], the lines of the drive that get its shaped steps",
    },
    Need {
        block: "error_table",
        others: &["controller"],
        or: Some("steps"),
        allowed: "an error table with [axis.controller] or [axis.steps], whose position it corrects",
    },
    Need {
        block: "trace",
        others: &["controller"],
        or: Some("steps"),
        allowed: "a trace with [axis.controller] or [axis.steps], whose signals it records",
    },
];

/// The tables that an inline shaper has no block for.
const NOT_WITH_INPUT: [&str; 6] = ["compare", "correction", "probe", "scale", "error_table", "family"];

/// The blocks that `[axis.steps]` replaces.
pub(super) const REPLACED_BY_STEPS: [&str; 4] = ["encoder", "pwm", "drive", "controller"];

/// Checks that every block finds the others that it cannot work without, and none that it replaces.
fn check_needs(axis: &Table<'_, '_>) {
    for Need {
        block,
        others,
        or,
        allowed,
    } in NEEDS
    {
        let missing: Vec<String> = others
            .iter()
            .filter(|other| axis.lacks(other))
            .map(|other| format!("[axis.{other}]"))
            .collect();
        if axis.has(block) && !missing.is_empty() && or.is_none_or(|or| axis.lacks(or)) {
            let missing = listed(&missing);
            let found = format!("[axis.{block}] without {missing}");
            let remedy = format!("add {missing}, or remove [axis.{block}]");
            axis.contradiction(block, found, allowed, remedy);
        }
    }
    for other in NOT_WITH_INPUT
        .into_iter()
        .filter(|other| axis.has("input") && axis.has(other))
    {
        let found = format!("[axis.{other}] beside [axis.input]");
        let allowed = "an axis whose command comes from a host: an inline shaper only counts, shapes and gives steps";
        axis.contradiction(other, found, allowed, format!("remove [axis.{other}], or [axis.input]"));
    }
    for other in REPLACED_BY_STEPS
        .into_iter()
        .filter(|other| axis.has("steps") && axis.has(other))
    {
        let found = format!("[axis.{other}] beside [axis.steps]");
        let allowed = "either encoder, PWM, drive and controller, or steps, whose drive has a loop of its own; an encoder that \
                       only watches the steps is [axis.scale]";
        axis.contradiction(other, found, allowed, format!("remove [axis.{other}], or [axis.steps]"));
    }
}

/// Checks that an axis with an absolute encoder has what reads it, and nothing that needs every count or an index.
fn check_beside_absolute(axis: &Table<'_, '_>) {
    for (other, allowed) in [
        (
            "scale",
            "an absolute encoder alone: its position is that of the tick before where a scale is compared; put the absolute encoder at \
             the load",
        ),
        (
            "compare",
            "a compare with an encoder of kind \"quadrature\" or with [axis.steps]: the position of an absolute encoder comes once per tick, \
             and passes many counts at once",
        ),
    ] {
        if axis.has(other) {
            let found = format!("[axis.{other}] beside an absolute encoder");
            axis.contradiction(other, found, allowed, format!("remove [axis.{other}]"));
        }
    }
    if axis.lacks("controller") {
        let found = "an absolute encoder without [axis.controller]";
        let allowed =
            "an absolute encoder with [axis.pwm], [axis.drive] and [axis.controller]: the stage reads it at each tick";
        axis.contradiction(
            "encoder",
            found,
            allowed,
            "add [axis.controller], or remove [axis.encoder]",
        );
    }
}

/// Joins words as in `a, b and c`.
fn listed(words: &[String]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        words => words.concat(),
    }
}
