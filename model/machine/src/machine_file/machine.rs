//! The tables that stand once in a machine file: its name, `[clock]`, `[fixed_point]`, `[target]`, and the list of
//! its axes.

use super::axis::not_refused;
use super::error::ProblemCause;
use super::hint::{self, KILO, MEGA_OR_KILO};
use super::key::{Default, Key, Values};
use super::range::{NumberRange, RATIO_ROUNDING};
use super::table::Table;
use super::{
    AxisSection, CaptureSection, ClockSection, FixedPoint, LinkSection, Machine, StageSection, Target, axis, capture,
    link, stage,
};
use crate::spelling::same_letters;
use posicast_blocks::bus_component::BridgedBus;
use posicast_blocks::shaper::WORD_BITS;
use posicast_shaper::digitise::Digitise;
use posicast_shaper::unit::short;
use posicast_taps::COEFFICIENT_FRACTION_MAX;

/// Largest number of axes of one stage.
const MAX_AXES: usize = 4;
/// Range of fabric clock and sample tick: up to what any device of the families reaches.
const CLOCK_HZ: NumberRange = NumberRange::positive(1e9).unit("Hz");
/// Longest sample period in clocks: 100 Hz from 100 MHz. Simulators step through every clock of it.
const MAX_CLOCKS_PER_SAMPLE: f64 = 1e6;
/// Fewest clocks per sample of any machine: a shaper with one tap takes that many.
const LEAST_CLOCKS_PER_SAMPLE: f64 = 9.0;
/// Device families: the allowed values of [`Target::family`].
pub const FAMILIES: [&str; 5] = ["cyclone2", "cyclone4e", "cyclone10lp", "cyclone5", "max10"];
/// Boards for which projects are written: the allowed values of [`Target::board`].
pub const BOARDS: [&str; 2] = ["de1", "de1soc"];
/// Ways to turn an impulse between two samples into taps.
const DIGITISE: [&str; 3] = ["modal", "linear", "nearest"];

/// The keys of the whole file.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "name",
        Values::Name,
        "Name of the top module, from which file and Verilog names derive.",
    )
    .required(),
    Key::new("clock", Values::Table(CLOCK_KEYS), "Clock and sample tick.").required(),
    Key::new("fixed_point", Values::Table(FIXED_POINT_KEYS), "Number formats."),
    Key::new(
        "target",
        Values::Table(TARGET_KEYS),
        "Device for the synthesis estimate.",
    ),
    Key::new("axis", Values::Tables(axis::KEYS, MAX_AXES), "The axes.").required(),
    Key::new(
        "stage",
        Values::Table(stage::KEYS),
        "Settings of all axes; even empty, it makes their delays equal.",
    ),
    Key::new(
        "capture",
        Values::Table(capture::KEYS),
        "Line whose edges take the positions of all axes, such as that of a touch probe.",
    )
    .rule("needs encoder, PWM, drive and controller, or steps, on every axis"),
    Key::new("link", Values::Table(link::KEYS), "Serial line or SPI to a host.")
        .rule("needs encoder, PWM, drive and controller on every axis, or `[axis.input]`"),
];

const CLOCK_KEYS: &[Key] = &[
    Key::new("frequency_hz", Values::Number(CLOCK_HZ), "Fabric clock.").required(),
    Key::new(
        "sample_hz",
        Values::Number(CLOCK_HZ),
        "Rate of shaped positions; divides `frequency_hz`.",
    )
    .rule("1 to 1,000,000 clocks per sample")
    .required(),
];

/// Fraction bits of the widest word; a narrower word allows fewer.
const FRACTION: Values = Values::Integer(0, *WORD_BITS.end() - 1);

const FIXED_POINT_KEYS: &[Key] = &[
    Key::new(
        "command_bits",
        Values::Integer(*WORD_BITS.start(), *WORD_BITS.end()),
        "Width of a command word: at least 18 for a motion shaper, 32 for a stage.",
    )
    .default(Default::Integer(DEFAULT_COMMAND_BITS)),
    Key::new(
        "command_fraction",
        FRACTION,
        "Fraction bits of position (counts), below `command_bits`.",
    )
    .default(Default::Integer(DEFAULT_POSITION_FRACTION)),
    Key::new(
        "velocity_fraction",
        FRACTION,
        "Fraction bits of velocity (counts/sample), below `command_bits`.",
    )
    .default(Default::Integer(DEFAULT_VELOCITY_FRACTION)),
    Key::new(
        "acceleration_fraction",
        FRACTION,
        "Fraction bits of acceleration (counts/sample²), below `command_bits`.",
    )
    .default(Default::Integer(DEFAULT_ACCELERATION_FRACTION)),
    Key::new(
        "coefficient_fraction",
        Values::Integer(1, COEFFICIENT_FRACTION_MAX),
        "Fraction bits of the 18-bit coefficients. Absent: the most that fit.",
    ),
    Key::new(
        "digitise",
        Values::Word(|| DIGITISE.to_vec()),
        "Taps of an impulse: modal (two, exact at the mode's pole), linear (two, by distance), nearest (one).",
    )
    .default(Default::Word("modal")),
];

const TARGET_KEYS: &[Key] = &[
    Key::new(
        "family",
        Values::Word(|| FAMILIES.to_vec()),
        "Device family of the estimates. Absent: Cyclone 10 LP.",
    )
    .rule("required beside `board`"),
    Key::new(
        "board",
        Values::Word(|| BOARDS.to_vec()),
        "Board of this family. Absent: `generate` writes a project for every known board.",
    ),
    Key::new(
        "bus",
        Values::Word(|| BUSES.map(|(word, _)| word).to_vec()),
        "Bus of the registers: a further top module per component, with its bridge.",
    )
    .default(Default::Word("avalon")),
];

/// The buses of `[target]`.
const BUSES: [(&str, Option<BridgedBus>); 3] = [
    ("avalon", None),
    ("axi4-lite", Some(BridgedBus::AxiLite)),
    ("wishbone", Some(BridgedBus::Wishbone { pipelined: false })),
];

/// Reads the whole file.
pub(super) fn read(root: &Table<'_, '_>) -> Option<Machine> {
    root.allow(KEYS);
    let name = root.required_name("name");
    root.require("clock", "a table [clock] with frequency_hz and sample_hz");
    let clock = root.table("clock").and_then(|table| read_clock(&table));
    let fixed_point = match root.table("fixed_point") {
        Some(table) => read_fixed_point(&table),
        None => Some(default_fixed_point(DEFAULT_COMMAND_BITS)),
    };
    let target = root.table("target").and_then(|table| read_target(&table));
    root.require("axis", format_args!("1 to {MAX_AXES} tables [[axis]]"));
    let axes = read_axes(root, clock, fixed_point);
    let stage = root.table("stage").map(|table| {
        let stage = stage::read(&table);
        stage::check(&table, &stage, axes.as_deref().unwrap_or_default());
        stage
    });
    check_inputs(root, axes.as_deref().unwrap_or_default());
    check_cascades(root, axes.as_deref().unwrap_or_default());
    let capture = read_capture(root, clock, axes.as_deref());
    let link = read_link(root, clock, axes.as_deref());
    // The delays of an inline shaper's axes are always made equal.
    let has_inputs = axes.iter().flatten().any(|axis| axis.input.is_some());
    let stage = stage.or_else(|| has_inputs.then(StageSection::default));
    Some(Machine {
        name: name?,
        clock: clock?,
        fixed_point: fixed_point?,
        target,
        axes: axes?,
        stage,
        capture,
        link,
    })
}

/// Checks that every axis has an input, or none, and that a host can read what an axis with an input records.
fn check_inputs(root: &Table<'_, '_>, axes: &[AxisSection]) {
    let with = axes.iter().find(|axis| axis.input.is_some());
    let without = axes.iter().find(|axis| axis.input.is_none());
    if let (Some(with), Some(without)) = (with, without) {
        root.contradiction(
            "axis",
            format!("axis {} with [axis.input] and axis {} without", with.name, without.name),
            "[axis.input] on every axis, whose commands come as step pulses, or on none",
            format!("add [axis.input] to axis {}, or make two machine files", without.name),
        );
    }
    let traced = with.filter(|_| root.lacks("link"));
    if let Some(axis) = traced.and_then(|_| axes.iter().find(|axis| axis.trace.is_some())) {
        root.contradiction(
            "axis",
            format!("axis {} with [axis.input] and [axis.trace], without [link]", axis.name),
            "a trace of an inline shaper with [link], through which a host reads it",
            "add [link], or remove [axis.trace]",
        );
    }
}

/// Checks that a machine with a cascade has shapers alone, whose delays nothing makes equal.
fn check_cascades(root: &Table<'_, '_>, axes: &[AxisSection]) {
    let Some(cascade) = axes.iter().find(|axis| axis.shaped().is_cascade()) else {
        return;
    };
    let found = |other: &str| format!("axis {} with structure = \"cascade\" beside {other}", cascade.name);
    if root.has("stage") {
        let allowed = "[stage] where every axis has taps, which can be delayed by parts of a sample";
        let remedy = format!("remove [stage], or `structure` of axis {}", cascade.name);
        root.contradiction("stage", found("[stage]"), allowed, remedy);
    }
    if let Some(other) = axes.iter().find(|axis| !axis.shaped().is_cascade() && axis.has_loop()) {
        let found = found(&format!("axis {}, which has more than a shaper", other.name));
        let allowed = "a cascade in a machine of shapers alone";
        let remedy = format!("remove `structure` of axis {}, or make two machine files", cascade.name);
        root.contradiction("axis", found, allowed, remedy);
    }
}

/// The first axis that keeps the machine from having a stage.
fn without_a_loop(axes: &[AxisSection]) -> Option<&AxisSection> {
    axes.iter().find(|axis| {
        let whole = axis.encoder.is_some() && axis.pwm.is_some() && axis.drive.is_some() && axis.controller.is_some();
        !whole && axis.steps.is_none()
    })
}

fn read_capture(
    root: &Table<'_, '_>,
    clock: Option<ClockSection>,
    axes: Option<&[AxisSection]>,
) -> Option<CaptureSection> {
    let capture = root.table("capture").map(|table| capture::read(&table, clock))?;
    // Where the axes have a problem, it is the one to mend first.
    let axes = axes.unwrap_or_default();
    let allowed = "[capture] where every axis has encoder, pwm, drive and controller, or steps, and no input: these have the counts \
                   that are captured";
    if let Some(axis) = without_a_loop(axes) {
        let found = format!("[capture] beside axis {}, which lacks a part of its loop", axis.name);
        root.contradiction(
            "capture",
            found,
            allowed,
            "remove [capture], or add what the axis lacks",
        );
    } else if let Some(axis) = axes.iter().find(|axis| axis.input.is_some()) {
        let found = format!("[capture] beside axis {}, which has an input", axis.name);
        root.contradiction(
            "capture",
            found,
            allowed,
            "remove [capture]: the controller of the machine captures",
        );
    }
    Some(capture)
}

fn read_link(root: &Table<'_, '_>, clock: Option<ClockSection>, axes: Option<&[AxisSection]>) -> Option<LinkSection> {
    let link = root.table("link").and_then(|table| link::read(&table, clock));
    // Where the axes have a problem, it is the one to mend first.
    if let Some(axis) = without_a_loop(axes?).filter(|axis| axis.input.is_none())
        && link.is_some()
    {
        root.contradiction(
            "link",
            format!("[link] beside axis {}, which lacks a part of its loop", axis.name),
            "[link] where every axis has encoder, pwm, drive and controller, or steps: these make the stage that a host operates",
            "remove [link], or add what the axis lacks",
        );
    }
    link
}

fn read_axes(
    root: &Table<'_, '_>,
    clock: Option<ClockSection>,
    fixed_point: Option<FixedPoint>,
) -> Option<Vec<AxisSection>> {
    let mut lines: Vec<(String, usize)> = Vec::new();
    let mut axes = Some(Vec::new());
    for (index, table) in root.tables("axis", MAX_AXES).into_iter().enumerate() {
        let name = table.required_name("name");
        let place = name.clone().unwrap_or((index + 1).to_string());
        let table = table.at(format!("axis {place}"));
        if let Some(name) = &name {
            match lines.iter().find(|(other, _)| other == name) {
                Some((_, line)) => table.duplicate("name", *line, "every axis must have a different name"),
                None if lines.iter().any(|(other, _)| clash(other, name)) => table.refuse(
                    "name",
                    "not `u` where another axis is `x` or `y`: their shapers are the instances `u_x` and `u_y` in the Verilog, and the \
                     command and the output of an axis `u` would have the same names",
                    "rename one of the two",
                ),
                None => lines.push((name.clone(), table.line_of("name"))),
            }
        }
        axes = axes
            .zip(axis::read(&table, name, clock, fixed_point))
            .map(|(mut axes, axis)| {
                axes.push(axis);
                axes
            });
    }
    axes
}

/// Returns whether a port of one axis would have the name of the other's shaper.
fn clash(one: &str, other: &str) -> bool {
    [(one, other), (other, one)]
        .iter()
        .any(|(of_ports, of_shaper)| *of_ports == "u" && ["x", "y"].contains(of_shaper))
}

fn read_clock(table: &Table<'_, '_>) -> Option<ClockSection> {
    table.allow(CLOCK_KEYS);
    let frequency_hz = table.required_number("frequency_hz", CLOCK_HZ);
    let sample_hz = table.required_number("sample_hz", CLOCK_HZ);
    let (frequency_hz, sample_hz) = (frequency_hz?, sample_hz?);
    let ratio = frequency_hz / sample_hz;
    if ratio < 1.0 - RATIO_ROUNDING {
        let right = |hz: f64| CLOCK_HZ.contains(hz) && hz >= sample_hz * LEAST_CLOCKS_PER_SAMPLE;
        if let Some(hint) = hint::in_other_unit("frequency_hz", frequency_hz, &MEGA_OR_KILO, right) {
            let allowed = format!(
                "at least clock.sample_hz = {} Hz: a sample lasts a clock or more",
                short(sample_hz)
            );
            table.refuse("frequency_hz", allowed, hint);
            return None;
        }
    }
    if ratio > MAX_CLOCKS_PER_SAMPLE * (1.0 + RATIO_ROUNDING) {
        let least = frequency_hz / MAX_CLOCKS_PER_SAMPLE;
        let allowed = format!(
            "at least {} Hz, a sample of at most {MAX_CLOCKS_PER_SAMPLE} clocks",
            short(least)
        );
        let right = |hz: f64| divides(frequency_hz, hz);
        let hint = hint::in_other_unit("sample_hz", sample_hz, &KILO, right);
        let otherwise = format!("raise sample_hz to {} Hz or more, or lower the clock", short(least));
        table.refuse("sample_hz", allowed, hint.unwrap_or(otherwise));
        return None;
    }
    let whole = ratio.round();
    if (ratio - whole).abs() > RATIO_ROUNDING * ratio {
        let nearest = nearest_divisor(frequency_hz, sample_hz);
        let whole = nearest_whole_divisor(frequency_hz, sample_hz).filter(|hz| *hz != nearest);
        let also = whole.map(|hz| format!(", in whole hertz {hz}")).unwrap_or_default();
        let allowed = format!(
            "what divides clock.frequency_hz = {frequency_hz} Hz a whole number of times; the nearest is {}{also}",
            exact(nearest)
        );
        let choice = whole.map_or_else(|| exact(nearest), hint::written);
        table.refuse(
            "sample_hz",
            allowed,
            format!("write `sample_hz = {choice}`, or change clock.frequency_hz"),
        );
        return None;
    }
    Some(ClockSection {
        frequency_hz,
        sample_hz,
    })
}

/// Returns whether the clock is a whole multiple of the sample rate, and a sample no longer than allowed.
fn divides(frequency_hz: f64, sample_hz: f64) -> bool {
    let ratio = frequency_hz / sample_hz;
    (1.0..=MAX_CLOCKS_PER_SAMPLE).contains(&ratio) && (ratio - ratio.round()).abs() <= RATIO_ROUNDING * ratio
}

/// Writes a frequency with no more digits than needed to divide the clock.
fn exact(hz: f64) -> String {
    let rounded: f64 = format!("{hz:.11e}").parse().unwrap_or(hz);
    rounded.to_string()
}

/// The frequency nearest to `wanted_hz` that divides `frequency_hz` a whole number of times.
fn nearest_divisor(frequency_hz: f64, wanted_hz: f64) -> f64 {
    let ratio = frequency_hz / wanted_hz;
    let faster_hz = frequency_hz / ratio.floor().max(1.0);
    let slower_hz = frequency_hz / ratio.ceil().max(1.0);
    if (faster_hz - wanted_hz).abs() <= (wanted_hz - slower_hz).abs() {
        faster_hz
    } else {
        slower_hz
    }
}

/// Returns the divided clock nearest to `wanted_hz` that is a whole number of hertz; `None` if the fabric clock itself is not one.
fn nearest_whole_divisor(frequency_hz: f64, wanted_hz: f64) -> Option<f64> {
    let clocks = (1..=MAX_CLOCKS_PER_SAMPLE as u32).map(f64::from);
    let divisors = clocks
        .filter(|clocks| frequency_hz % clocks == 0.0)
        .map(|clocks| frequency_hz / clocks);
    divisors.min_by(|a, b| (a - wanted_hz).abs().total_cmp(&(b - wanted_hz).abs()))
}

const DEFAULT_COMMAND_BITS: u32 = 32;
const DEFAULT_POSITION_FRACTION: u32 = 8;
const DEFAULT_VELOCITY_FRACTION: u32 = 16;
const DEFAULT_ACCELERATION_FRACTION: u32 = 24;

/// The number formats of a file without `[fixed_point]`. A word too narrow for a default gets the most fraction bits
/// that it holds.
fn default_fixed_point(command_bits: u32) -> FixedPoint {
    let most = command_bits - 1;
    FixedPoint {
        command_bits,
        command_fraction: DEFAULT_POSITION_FRACTION.min(most),
        velocity_fraction: DEFAULT_VELOCITY_FRACTION.min(most),
        acceleration_fraction: DEFAULT_ACCELERATION_FRACTION.min(most),
        coefficient_fraction: None,
        digitise: Digitise::default(),
    }
}

fn read_fixed_point(table: &Table<'_, '_>) -> Option<FixedPoint> {
    table.allow(FIXED_POINT_KEYS);
    let command_bits = table.integer("command_bits", *WORD_BITS.start(), *WORD_BITS.end());
    let default = default_fixed_point(command_bits.unwrap_or(DEFAULT_COMMAND_BITS));
    let fraction = |key, default| {
        table
            .integer(key, 0, command_bits.unwrap_or(DEFAULT_COMMAND_BITS) - 1)
            .unwrap_or(default)
    };
    let digitise = match table.choice("digitise", &DIGITISE) {
        Some("linear") => Digitise::Linear,
        Some("nearest") => Digitise::Nearest,
        _ => Digitise::Modal,
    };
    Some(FixedPoint {
        command_fraction: fraction("command_fraction", default.command_fraction),
        velocity_fraction: fraction("velocity_fraction", default.velocity_fraction),
        acceleration_fraction: fraction("acceleration_fraction", default.acceleration_fraction),
        coefficient_fraction: table.integer("coefficient_fraction", 1, COEFFICIENT_FRACTION_MAX),
        digitise,
        ..default
    })
}

fn read_target(table: &Table<'_, '_>) -> Option<Target> {
    table.allow(TARGET_KEYS);
    if table.has("board") {
        table.require("family", FAMILIES.join(", "));
    }
    let otherwise = "for a device of Lattice, AMD or another family leave it out: the Verilog suits every device, docs/kit.md says how to \
                     build it for those, and `posicast synth --family` takes one of the list for an estimate";
    let family = table
        .has("family")
        .then(|| table.choice_else("family", &FAMILIES, otherwise));
    let bus = table
        .has("bus")
        .then(|| table.choice("bus", &BUSES.map(|(word, _)| word)));
    let board = table.text("board", BOARDS.join(", "));
    if let Some(unknown) = board.filter(|board| !BOARDS.contains(board)) {
        // A name with another number is another board, not a misspelling.
        let meant = BOARDS.iter().find(|known| same_letters(known, unknown));
        let remedy = match meant {
            Some(known) => format!("did you mean \"{known}\"?"),
            None => {
                "leave `board` out: there are then projects for all known boards, to start from for yours".to_owned()
            }
        };
        let (found, allowed) = (table.quote("board"), BOARDS.join(", "));
        table.report("board", ProblemCause::NotAChoice { found, allowed }, remedy);
    }
    let bus = not_refused(bus)?.and_then(|word| BUSES.iter().find(|(other, _)| *other == word));
    Some(Target {
        family: not_refused(family)?.map(str::to_owned),
        board: board.map(str::to_owned),
        bus: bus.and_then(|(_, bus)| *bus),
    })
}
