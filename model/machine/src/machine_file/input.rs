//! `[axis.input]`: the step pulses of a controller, which an inline shaper takes as its command.
//!
//! The file has seconds, as a controller's manual; the hardware counts clocks. A pulse passes the filter if it lasts for more
//! than `filter_clocks`, and one more clock, because the lines are asynchronous.

use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, LimitsSection};
use posicast_blocks::inline_axis::InlineLinesActiveLow;
use posicast_blocks::pulse_counter::FILTER_CLOCKS_MAX;
use posicast_blocks::step_generator::StepMode;
use posicast_shaper::unit::{short, show_seconds};

/// Range of pulse and space.
const LASTING_S: NumberRange = NumberRange::positive(1.0).unit("s");
/// Clocks that a level must last beyond the filter, to be seen at any phase of the clock.
const SEEN_CLOCKS: u32 = 2;
/// Largest step rate of an input in steps per second.
pub const MOST_INPUT_HZ: f64 = 2e6;

/// What happens where a command is faster than the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BeyondLimits {
    /// The axes stop with a fault.
    Stop,
    /// The command passes, as far as the lines of the drive are fast enough; beyond, the axes stop with a fault.
    Pass,
}

impl BeyondLimits {
    /// Every choice with its name in the machine file.
    pub const ALL: [(Self, &str); 2] = [(Self::Stop, "stop"), (Self::Pass, "pass")];
}

/// `[axis.input]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputSection {
    /// What the two lines show.
    pub kind: StepMode,
    /// Pulses of up to this many clocks are ignored.
    pub filter_clocks: u32,
    /// Shortest pulse of the controller in s; in quadrature, shortest time between two edges.
    pub pulse_s: f64,
    /// Shortest time between two pulses in s.
    pub space_s: f64,
    /// The lines that are active low.
    pub active_low: InlineLinesActiveLow,
    /// What happens where the command is faster than the limits.
    pub beyond_limits: BeyondLimits,
}

fn lines_of(kind: StepMode) -> [&'static str; 2] {
    kind.line_names()
}

fn line_names() -> Vec<&'static str> {
    StepMode::ALL.iter().flat_map(|kind| lines_of(*kind)).collect()
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "kind",
        Values::Word(|| StepMode::ALL.map(StepMode::name).to_vec()),
        "What the controller's two lines show: steps and their direction; steps up and steps down; or quadrature, a step per edge.",
    )
    .required(),
    Key::new(
        "filter_clocks",
        Values::Integer(0, FILTER_CLOCKS_MAX),
        "Longest ignored pulse on both lines. 0: no filter.",
    )
    .default(Default::Integer(0)),
    Key::new(
        "pulse_s",
        Values::Number(LASTING_S),
        "Shortest pulse of the controller; in quadrature, shortest time between two edges.",
    )
    .rule("two clocks longer than the filter")
    .required(),
    Key::new(
        "space_s",
        Values::Number(LASTING_S),
        "Shortest time between two of its pulses. Absent: `pulse_s`.",
    )
    .rule("two clocks longer than the filter"),
    Key::new(
        "active_low",
        Values::Words(line_names),
        "Lines that are on at a low level. Absent: none.",
    )
    .rule("lines of the `kind`"),
    Key::new(
        "beyond_limits",
        Values::Word(|| BeyondLimits::ALL.map(|(_, name)| name).to_vec()),
        "A command faster than `limits.velocity` stops the axes with a fault, or passes as far as the drive's lines allow.",
    )
    .default(Default::Word("stop")),
];

/// Reads the table; `None` where a value is refused. Checks that need a valid clock are skipped without one.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<InputSection> {
    table.allow(KEYS);
    let kind = table.required_choice("kind", &StepMode::ALL.map(StepMode::name));
    let kind = StepMode::ALL.into_iter().find(|of| Some(of.name()) == kind);
    let filter_clocks = if table.has("filter_clocks") {
        table.integer("filter_clocks", 0, FILTER_CLOCKS_MAX)
    } else {
        Some(0)
    };
    let pulse_s = table.required_number("pulse_s", LASTING_S);
    let space_s = table.number("space_s", LASTING_S);
    let low = table.choices(
        "active_low",
        &line_names().into_iter().map(|name| (name, name)).collect::<Vec<_>>(),
    );
    let beyond = table.word("beyond_limits", &BeyondLimits::ALL);
    let kind = kind?;
    let low = low.unwrap_or_default();
    if let Some(other) = low.iter().find(|line| !lines_of(kind).contains(line)) {
        let [a, b] = lines_of(kind);
        let found = format!("`{other}` with kind = \"{}\"", kind.name());
        let allowed = format!("the lines of that kind, `{a}` and `{b}`");
        table.contradiction("active_low", found, allowed, format!("write `{a}`, `{b}`, or both"));
    }
    let [a, b] = lines_of(kind).map(|name| low.contains(&name));
    let input = InputSection {
        kind,
        filter_clocks: filter_clocks?,
        pulse_s: pulse_s?,
        space_s: space_s.or(pulse_s)?,
        active_low: InlineLinesActiveLow { a, b },
        beyond_limits: beyond.unwrap_or(BeyondLimits::Stop),
    };
    if let Some(clock) = clock {
        check_filter(table, &input, &clock);
    }
    Some(input)
}

/// Checks that every pulse of the controller passes the filter.
fn check_filter(table: &Table<'_, '_>, input: &InputSection, clock: &ClockSection) {
    let least = input.filter_clocks + SEEN_CLOCKS;
    let least_s = f64::from(least) / clock.frequency_hz;
    let listed = [("pulse_s", input.pulse_s), ("space_s", input.space_s)];
    for (key, seconds) in listed.into_iter().filter(|(key, _)| table.has(key)) {
        if seconds < least_s * (1.0 - 1e-9) {
            let found = format!(
                "{key} = {} with filter_clocks = {}",
                table.quote(key),
                input.filter_clocks
            );
            let allowed = format!(
                "at least {}, {least} clocks: the filter and two, or steps are lost",
                show_seconds(least_s, 4)
            );
            table.contradiction(
                key,
                found,
                allowed,
                "lower filter_clocks, raise the clock, or set the controller to longer pulses",
            );
        }
    }
}

/// Checks the lines against the axis: its largest velocity must be a rate that the controller's times allow.
pub(super) fn check(
    table: &Table<'_, '_>,
    input: &InputSection,
    limits: Option<&LimitsSection>,
    counts_per_unit: Option<f64>,
) {
    let (Some(velocity), Some(counts_per_unit)) = (limits.and_then(|limits| limits.velocity), counts_per_unit) else {
        // A missing velocity is reported for [axis.steps].
        return;
    };
    let rate_hz = velocity * counts_per_unit;
    if rate_hz > MOST_INPUT_HZ * (1.0 + 1e-9) {
        let found = format!("{} steps/s at limits.velocity", short(rate_hz));
        let allowed = format!("at most {} steps/s", short(MOST_INPUT_HZ));
        table.contradiction("kind", found, allowed, "lower the velocity or the microsteps");
        return;
    }
    let period_s = match input.kind {
        StepMode::Quadrature => input.pulse_s,
        StepMode::StepDirection | StepMode::UpDown => input.pulse_s + input.space_s,
    };
    if rate_hz * period_s > 1.0 + 1e-9 {
        let found = format!(
            "a period of {} with {} steps/s at limits.velocity",
            show_seconds(period_s, 4),
            short(rate_hz)
        );
        let allowed = format!("at most {}", show_seconds(1.0 / rate_hz, 4));
        let remedy = "check the unit of the times, set the controller to shorter pulses, or lower the velocity or the microsteps";
        table.contradiction("pulse_s", found, allowed, remedy);
    }
}
