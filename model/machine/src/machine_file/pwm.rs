//! `[axis.pwm]`: the pulse width modulator, in clocks.
//!
//! The file has seconds; the hardware counts clocks. The period must be a whole number of clocks. Dead time and
//! minimum pulse are rounded **up**, so that they are never shorter at the pins than in the file.

use super::ClockSection;
use super::hint::{self, KILO};
use super::key::{Key, Values};
use super::range::{NumberRange, RATIO_ROUNDING};
use super::table::Table;
use posicast_blocks::pwm::{SHORTEST_PERIOD_CLOCKS, TIME_BITS};
use posicast_shaper::unit::{short, show_seconds};

/// Range of dead time and minimum pulse.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
const FREQUENCY_HZ: NumberRange = NumberRange::positive(1e9).unit("Hz");
/// Shortest and longest PWM period that the hardware counts, in clocks.
const PERIOD_CLOCKS_MIN: u32 = SHORTEST_PERIOD_CLOCKS;
const PERIOD_CLOCKS_MAX: u32 = 1 << 16;
/// Longest dead time and minimum pulse that the hardware counts, in clocks.
const TIME_CLOCKS_MAX: u32 = (1 << TIME_BITS) - 1;

/// Ways in which the duty drives the pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PwmMode {
    /// A pulse width and a direction.
    Direction,
    /// Upper and lower switch of one leg.
    HalfBridge,
    /// Four gates, one leg switching at a time.
    FullBridge,
    /// Four gates, both legs in antiphase: a command of zero is a duty of 50 %.
    LockedAntiphase,
}

/// `[axis.pwm]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PwmSection {
    /// The way in which the duty drives the pins.
    pub mode: PwmMode,
    /// PWM frequency in Hz: it divides the clock, and the sample tick divides it.
    pub frequency_hz: f64,
    /// Time for which both switches of a leg are off, in s. Default 0.
    pub dead_time_s: f64,
    /// Shortest pulse that is output, in s; shorter ones are left out. Default 0.
    pub minimum_pulse_s: f64,
    /// Whether the pins are active low, which is fixed when the hardware is built. Default false.
    pub active_low: bool,
}

impl PwmMode {
    /// Every mode with its name in the machine file.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Direction, "direction"),
        (Self::HalfBridge, "half-bridge"),
        (Self::FullBridge, "full-bridge"),
        (Self::LockedAntiphase, "locked-antiphase"),
    ];
}

impl PwmSection {
    /// Clocks of a PWM period. The quotient is exact: validation makes sure of it.
    pub fn period_clocks(&self, clock: &ClockSection) -> u32 {
        (clock.frequency_hz / self.frequency_hz).round() as u32
    }

    /// Dead time in clocks, rounded up.
    pub fn dead_time_clocks(&self, clock: &ClockSection) -> u32 {
        clock.clocks_up(self.dead_time_s)
    }

    /// Shortest pulse in clocks, rounded up.
    pub fn minimum_pulse_clocks(&self, clock: &ClockSection) -> u32 {
        clock.clocks_up(self.minimum_pulse_s)
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "mode",
        Values::Word(|| PwmMode::ALL.map(|(_, name)| name).to_vec()),
        "How the duty drives the pins.",
    )
    .required(),
    Key::new(
        "frequency_hz",
        Values::Number(FREQUENCY_HZ),
        "PWM frequency: a divisor of the clock, a multiple of `sample_hz`.",
    )
    .rule("2 to 65,536 clocks per period")
    .required(),
    Key::or_zero(
        "dead_time_s",
        SHORT_S,
        "Time for which both switches of a leg are off, rounded up to clocks.",
    )
    .rule("with `minimum_pulse_s` below half the period"),
    Key::or_zero(
        "minimum_pulse_s",
        SHORT_S,
        "Shortest pulse, rounded up to clocks; shorter ones are left out.",
    ),
    Key::switch("active_low", "The pins are active low."),
];

/// Reads the table; `None` where a value is refused. Checks that need a valid clock are skipped without one.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> Option<PwmSection> {
    table.allow(KEYS);
    table.require("mode", PwmMode::ALL.map(|(_, name)| name).join(", "));
    let mode = table.word("mode", &PwmMode::ALL);
    let frequency_hz = table.required_number("frequency_hz", FREQUENCY_HZ);
    let pwm = PwmSection {
        mode: mode.unwrap_or(PwmMode::Direction),
        frequency_hz: frequency_hz?,
        dead_time_s: table.number("dead_time_s", SHORT_S).unwrap_or(0.0),
        minimum_pulse_s: table.number("minimum_pulse_s", SHORT_S).unwrap_or(0.0),
        active_low: table.boolean("active_low").unwrap_or(false),
    };
    // Checks that build on a refused period would report consequences of it.
    if let Some(clock) = clock.filter(|clock| check_frequency(table, pwm.frequency_hz, clock)) {
        check_pulse(table, &pwm, &clock);
        check_counters(table, &pwm, &clock);
    }
    mode.map(|_| pwm)
}

/// Checks that a PWM period is a whole number of clocks and a sample a whole number of PWM periods, and returns
/// whether it is so. The message names the nearest frequency that meets both.
fn check_frequency(table: &Table<'_, '_>, pwm_hz: f64, clock: &ClockSection) -> bool {
    let clocks_per_sample = clock.clocks_per_sample();
    let frequencies = || {
        let periods = (1..=clocks_per_sample).filter(|periods| clocks_per_sample.is_multiple_of(*periods));
        periods.map(|periods| f64::from(periods) * clock.sample_hz)
    };
    let is = |frequency_hz: f64, wanted_hz: f64| (frequency_hz - wanted_hz).abs() <= RATIO_ROUNDING * wanted_hz;
    let Some(nearest) = frequencies().min_by(|a, b| (a - pwm_hz).abs().total_cmp(&(b - pwm_hz).abs())) else {
        return true;
    };
    if !is(nearest, pwm_hz) {
        let ClockSection {
            frequency_hz,
            sample_hz,
        } = clock;
        let allowed = format!(
            "what divides clock.frequency_hz = {frequency_hz} Hz and is a multiple of clock.sample_hz = {sample_hz} \
            Hz; \
             the nearest is {nearest}"
        );
        let right = |hz: f64| pwm_hz < *sample_hz && frequencies().any(|frequency_hz| is(frequency_hz, hz));
        let hint = hint::in_other_unit("frequency_hz", pwm_hz, &KILO, right);
        let otherwise = format!("write `frequency_hz = {}`", hint::written(nearest));
        table.refuse("frequency_hz", allowed, hint.unwrap_or(otherwise));
        return false;
    }
    true
}

/// Checks that a period has room for both sides' dead time and minimum pulse, and for one more clock: a leg that is
/// late once, after a change of direction or a start, catches up only where a side lasts longer than the minimum. The
/// hardware has at least one clock of each.
fn check_pulse(table: &Table<'_, '_>, pwm: &PwmSection, clock: &ClockSection) {
    let least = |clocks: u32| u64::from(clocks.max(1));
    let clocks = 2 * (least(pwm.dead_time_clocks(clock)) + least(pwm.minimum_pulse_clocks(clock)));
    let period = pwm.period_clocks(clock);
    if clocks < u64::from(period) {
        return;
    }
    let key = if table.has("dead_time_s") {
        "dead_time_s"
    } else {
        "minimum_pulse_s"
    };
    let found = format!("{clocks} clocks, twice the dead time and the minimum pulse");
    let allowed = format!("below {period} clocks, the PWM period");
    table.contradiction(key, found, allowed, "shorten both, or lower the PWM frequency");
}

/// Checks that the hardware's counters hold the period, the dead time and the shortest pulse, in clocks.
fn check_counters(table: &Table<'_, '_>, pwm: &PwmSection, clock: &ClockSection) {
    let shortest_hz = clock.frequency_hz / f64::from(PERIOD_CLOCKS_MAX);
    let period = pwm.period_clocks(clock);
    if !(PERIOD_CLOCKS_MIN..=PERIOD_CLOCKS_MAX).contains(&period) {
        let found = format!("a period of {period} clocks");
        let allowed = format!(
            "{PERIOD_CLOCKS_MIN} to {PERIOD_CLOCKS_MAX} clocks: from {} Hz on",
            short(shortest_hz)
        );
        table.contradiction("frequency_hz", found, allowed, "choose a frequency in this range");
    }
    for (key, clocks) in [
        ("dead_time_s", pwm.dead_time_clocks(clock)),
        ("minimum_pulse_s", pwm.minimum_pulse_clocks(clock)),
    ] {
        if clocks > TIME_CLOCKS_MAX {
            let longest_s = f64::from(TIME_CLOCKS_MAX) / clock.frequency_hz;
            let found = format!("{} s, {clocks} clocks", table.quote(key));
            let allowed = format!(
                "at most {}, the {TIME_CLOCKS_MAX} clocks that the hardware counts to",
                show_seconds(longest_s, 4)
            );
            table.contradiction(key, found, allowed, "shorten it, or lower the clock");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_times_are_rounded_up_to_clocks() {
        let clock = ClockSection {
            frequency_hz: 50e6,
            sample_hz: 10e3,
        };
        let cases = [
            (0.0, 0),
            (1e-12, 1),
            (20e-9, 1),
            (20.1e-9, 2),
            (500e-9, 25),
            (1e-6, 50),
            (1.0, 50_000_000),
        ];
        for (seconds, clocks) in cases {
            assert_eq!(clock.clocks_up(seconds), clocks, "{seconds} s");
        }
    }
}
