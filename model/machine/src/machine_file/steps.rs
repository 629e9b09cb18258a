//! `[axis.steps]`: the lines of a drive with step inputs, their times, and the steps that may be owed.
//!
//! The file has seconds, as a drive's datasheet; the hardware counts clocks. All times are minima and are rounded **up**.

use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, FixedPoint, LimitsSection};
use posicast_blocks::step_generator::{
    MOST_LINE_CLOCKS, MOST_OWED_STEPS, StepGeneratorConfig, StepGeneratorConfigError, StepLinesActiveLow, StepMode,
    StepTimes, StepTimesInSeconds,
};
use posicast_shaper::unit::{short, show_seconds};

/// Range of pulse and space.
const LASTING_S: NumberRange = NumberRange::positive(1.0).unit("s");
/// Range of direction setup and hold.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");

/// `[axis.steps]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepsSection {
    /// What the two lines show.
    pub mode: StepMode,
    /// Minima of the lines in s.
    pub times: StepTimesInSeconds,
    /// The lines that are active low.
    pub active_low: StepLinesActiveLow,
    /// Largest number of steps that may be owed; `None`: [`StepsSection::generator`] chooses it.
    pub owed_limit: Option<u32>,
}

impl StepsSection {
    /// The step generator for this clock, with positions of `fraction_bits`. Where the file gives no `owed_limit`, it is what two
    /// reversals and a tick at the largest rate leave owed.
    ///
    /// # Errors
    /// [`StepGeneratorConfigError`] for what does not fit the hardware.
    pub fn generator(
        &self,
        clock: &ClockSection,
        fraction_bits: u32,
    ) -> Result<StepGeneratorConfig, StepGeneratorConfigError> {
        let times = StepTimes::from_seconds(self.times, clock.frequency_hz)?;
        let tick_clocks = u64::from(clock.clocks_per_sample());
        let with_limit = |limit: u64| {
            StepGeneratorConfig::new(tick_clocks, fraction_bits, self.mode, times, limit)
                .map(|config| config.active_low(self.active_low))
        };
        match self.owed_limit {
            Some(limit) => with_limit(limit.into()),
            None => {
                let least = with_limit(1)?;
                let of_a_tick = tick_clocks / least.period_clocks() + 1;
                with_limit((2 * least.reversal_steps() + of_a_tick).min(MOST_OWED_STEPS))
            }
        }
    }
}

fn line_names() -> Vec<&'static str> {
    StepMode::ALL.iter().flat_map(|mode| mode.line_names()).collect()
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "mode",
        Values::Word(|| StepMode::ALL.map(StepMode::name).to_vec()),
        "What the two lines show: steps and their direction; steps up and steps down (CW, CCW); or quadrature, a step per edge.",
    )
    .required(),
    Key::new(
        "pulse_s",
        Values::Number(LASTING_S),
        "Shortest pulse that the drive takes, rounded up to clocks.",
    )
    .rule("with `space_s` at most a period at `limits.velocity`")
    .required(),
    Key::new(
        "space_s",
        Values::Number(LASTING_S),
        "Shortest time between two pulses. Absent: `pulse_s`.",
    ),
    Key::new(
        "direction_setup_s",
        Values::Number(SHORT_S),
        "Shortest time from a change of direction to the next pulse.",
    )
    .required(),
    Key::new(
        "direction_hold_s",
        Values::Number(SHORT_S),
        "Shortest time from the end of a pulse to a change of direction. Absent: `direction_setup_s`.",
    ),
    Key::new(
        "active_low",
        Values::Words(line_names),
        "Lines that are on at a low level. Absent: none.",
    )
    .rule("lines of the `mode`"),
    Key::new(
        "owed_limit",
        Values::Integer(1, MOST_OWED_STEPS as u32),
        "Steps that may be owed, for example after a reversal; more stop the axis. Absent: those of two reversals and a tick.",
    ),
];

/// Reads the table; `None` where a value is refused. Checks that need a valid clock are skipped without one.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<StepsSection> {
    table.allow(KEYS);
    let mode = table.required_choice("mode", &StepMode::ALL.map(StepMode::name));
    let mode = StepMode::ALL.into_iter().find(|of| Some(of.name()) == mode);
    let pulse_s = table.required_number("pulse_s", LASTING_S);
    let space_s = table.number("space_s", LASTING_S);
    let setup_s = table.required_number("direction_setup_s", SHORT_S);
    let hold_s = table.number("direction_hold_s", SHORT_S);
    let low = table.choices(
        "active_low",
        &line_names().into_iter().map(|name| (name, name)).collect::<Vec<_>>(),
    );
    let owed_limit = table.integer("owed_limit", 1, MOST_OWED_STEPS as u32);
    let mode = mode?;
    let low = low.unwrap_or_default();
    if let Some(other) = low.iter().find(|line| !mode.line_names().contains(line)) {
        let [a, b] = mode.line_names();
        let found = format!("`{other}` with mode = \"{}\"", mode.name());
        let allowed = format!("the lines of that mode, `{a}` and `{b}`");
        table.contradiction("active_low", found, allowed, format!("write `{a}`, `{b}`, or both"));
    }
    let [a, b] = mode.line_names().map(|name| low.contains(&name));
    let steps = StepsSection {
        mode,
        times: StepTimesInSeconds {
            pulse_s: pulse_s?,
            space_s: space_s.or(pulse_s)?,
            direction_setup_s: setup_s?,
            direction_hold_s: hold_s.or(setup_s)?,
        },
        active_low: StepLinesActiveLow { a, b },
        owed_limit,
    };
    match clock {
        Some(clock) if !check_counters(table, &steps, &clock) => None,
        _ => Some(steps),
    }
}

/// Checks that the timer of the lines holds every time, and returns whether it does.
fn check_counters(table: &Table<'_, '_>, steps: &StepsSection, clock: &ClockSection) -> bool {
    let times = steps.times;
    let listed = [
        ("pulse_s", times.pulse_s),
        ("space_s", times.space_s),
        ("direction_setup_s", times.direction_setup_s),
        ("direction_hold_s", times.direction_hold_s),
    ];
    let longest_s = MOST_LINE_CLOCKS as f64 / clock.frequency_hz;
    let mut fit = true;
    // A time that is absent is that of another key, which is reported.
    for (key, seconds) in listed.into_iter().filter(|(key, _)| table.has(key)) {
        if seconds > longest_s {
            fit = false;
            let found = format!("{} s", table.quote(key));
            let allowed = format!(
                "at most {}, the {MOST_LINE_CLOCKS} clocks that the hardware counts to",
                show_seconds(longest_s, 4)
            );
            table.contradiction(
                key,
                found,
                allowed,
                "check the unit of the datasheet, or lower the clock",
            );
        }
    }
    fit
}

/// The axis around the table.
pub(super) struct OfAxis<'a> {
    /// Steps per m or rad.
    pub(super) counts_per_unit: Option<f64>,
    /// The limits of the axis; `None` without the table.
    pub(super) limits: Option<&'a LimitsSection>,
    /// The clock, if it is valid.
    pub(super) clock: Option<ClockSection>,
    /// The number format, if it is valid.
    pub(super) fixed_point: Option<FixedPoint>,
}

/// Checks the lines against the axis: the largest velocity must be a rate that the lines can give.
pub(super) fn check(table: &Table<'_, '_>, steps: &StepsSection, axis: &OfAxis<'_>) {
    let Some(velocity) = axis.limits.and_then(|limits| limits.velocity) else {
        let found = "[axis.steps] without limits.velocity";
        let allowed = "steps with the axis's largest velocity, which the times of the lines are checked against";
        table.contradiction("mode", found, allowed, "add [axis.limits] with `velocity`");
        return;
    };
    let (Some(counts_per_unit), Some(clock), Some(format)) = (axis.counts_per_unit, axis.clock, axis.fixed_point)
    else {
        return;
    };
    let generator = match steps.generator(&clock, format.command_fraction) {
        Ok(generator) => generator,
        Err(error) => {
            let found = "[axis.steps]";
            let remedy = "change clock.sample_hz, fixed_point.command_fraction or the times of [axis.steps]";
            table.contradiction("mode", found, error.to_string(), remedy);
            return;
        }
    };
    let rate_hz = velocity * counts_per_unit;
    let largest_hz =
        f64::from(generator.largest_difference()) / 2f64.powi(format.command_fraction as i32) * clock.sample_hz;
    if rate_hz > largest_hz {
        let found = format!(
            "pulse and space of {} clocks with {} steps/s at limits.velocity",
            generator.period_clocks(),
            short(rate_hz)
        );
        let allowed = format!(
            "a period of at most {}; these lines give {} steps/s",
            show_seconds(1.0 / rate_hz, 4),
            short(largest_hz)
        );
        let remedy = "check the unit of the times, shorten them as far as the drive's datasheet allows, or lower the \
                      velocity or the microsteps";
        table.contradiction("pulse_s", found, allowed, remedy);
    } else if generator.owed_limit() as u64 <= generator.reversal_steps() {
        let found = format!("owed_limit = {}", generator.owed_limit());
        let allowed = format!(
            "more than {}, which a reversal at the largest rate leaves owed",
            generator.reversal_steps()
        );
        table.contradiction("owed_limit", found, allowed, "raise it, or remove the key");
    }
}
