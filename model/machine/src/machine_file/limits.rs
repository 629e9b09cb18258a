//! `[axis.limits]`: limits of moves, and what the supervisor of the axis monitors and how it reacts.
//!
//! Values are in m, rad and s; the file has them in the axis's unit. [`crate::control::supervision`] turns them into
//! the words of the hardware, and refuses values that do not fit. `docs/machine-file.md` has every key with its
//! default.

use super::key::{Default as Absent, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, FixedPoint};
use crate::unit::AxisUnit;
use posicast_blocks::axis::{ALWAYS_OFF, Cause};
use posicast_blocks::shaper::WORD_BITS;
use posicast_shaper::unit::short;

/// Range of positions.
const POSITION: NumberRange = NumberRange::closed(-1e9, 1e9);
/// Range of velocity, acceleration, jerk and distances: far above any machine, and products of them stay finite.
const MOTION: NumberRange = NumberRange::positive(1e9);
/// Range of the brake's times and of the monitors' time limits, which may be 0.
const SECONDS: NumberRange = NumberRange::closed(0.0, 60.0).unit("s");
/// Largest number of ticks of a time of the supervisor, whose word has 16 bits.
const TICKS_MAX: f64 = u16::MAX as f64;
/// Range of times that must be above 0.
const LASTING: NumberRange = NumberRange::positive(60.0).unit("s");
/// Range of fractions of full scale.
const PART: NumberRange = NumberRange::closed(0.0, 1.0);
/// Range of command levels that must stay below full scale.
const PART_BELOW: NumberRange = PART.open_above();

/// Causes whose reaction the file may choose.
const CHOICES: [Cause; 13] = [
    Cause::DriveLost,
    Cause::LimitPlus,
    Cause::LimitMinus,
    Cause::SoftLimitPlus,
    Cause::SoftLimitMinus,
    Cause::FollowingError,
    Cause::Deviation,
    Cause::Saturation,
    Cause::EncoderLost,
    Cause::EncoderError,
    Cause::Segments,
    Cause::Watchdog,
    Cause::Schedule,
];

/// Causes that switch off by default. They put in doubt what a quick stop needs: a drive that obeys, a position that
/// is true, and a controller that is in time.
const DEFAULT_OFF: [Cause; 6] = [
    Cause::DriveLost,
    Cause::FollowingError,
    Cause::Deviation,
    Cause::EncoderLost,
    Cause::EncoderError,
    Cause::Schedule,
];

/// Default fraction of full scale above which the encoder must count: friction and weight take less.
const DEFAULT_LOST_COMMAND: f64 = 0.5;
/// Default of the largest manual duty, as a fraction of full duty.
const DEFAULT_DIRECT_DUTY: f64 = 0.1;

/// `[axis.limits]`, in m (or rad) and s. [`LimitsSection::default`] stands for an axis without the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitsSection {
    /// Largest velocity, m/s.
    pub velocity: Option<f64>,
    /// Largest acceleration, m/s².
    pub acceleration: Option<f64>,
    /// Largest jerk, m/s³.
    pub jerk: Option<f64>,
    /// Soft limits of the position, m.
    pub travel: Option<[f64; 2]>,
    /// Whether the soft limits act only once the host has homed the axis. Default false.
    pub soft_limits_after_homing: bool,
    /// Deceleration of a quick stop, m/s²; `None`: `acceleration` is used.
    pub stop_deceleration: Option<f64>,
    /// Largest distance of the position from the shaped command, m.
    pub following_error: Option<f64>,
    /// Largest distance of the motor's position from the scale's, m; only with `[axis.scale]`.
    pub deviation: Option<f64>,
    /// Longest time that the deviation may be larger, s; 0: it acts at once.
    pub deviation_s: f64,
    /// Longest time that the command may be clamped, s; 0 disables the check.
    pub saturation_s: f64,
    /// Longest time that the encoder may stand still under a command, s; 0 disables the check.
    pub encoder_lost_s: f64,
    /// Fraction of full scale, 0 to below 1, above which a command must move the encoder. Default 0.5.
    pub encoder_lost_command: f64,
    /// Longest silence of the host, s; 0 disables the watchdog.
    pub watchdog_s: f64,
    /// Time from releasing the brake until it is open, s. Default 0.
    pub brake_release_s: f64,
    /// Time from applying the brake until it holds, s. Default 0.
    pub brake_apply_s: f64,
    /// Pulses of up to this length on the axis's lines are ignored, s. Default 0.
    pub line_filter_s: f64,
    /// Word of [`Cause`] bits: 1 switches off, 0 leads to a quick stop. The causes that always switch off are set in
    /// it.
    pub off_causes: u16,
    /// Largest manual duty, as a fraction of full duty. Default 0.1.
    pub direct_duty: f64,
    /// Time that a manual duty stays applied without a new request, s.
    pub direct_hold_s: Option<f64>,
    /// Largest amplitude of test signals, m.
    pub excitation: Option<f64>,
}

impl Default for LimitsSection {
    fn default() -> Self {
        Self {
            velocity: None,
            acceleration: None,
            jerk: None,
            travel: None,
            soft_limits_after_homing: false,
            stop_deceleration: None,
            following_error: None,
            deviation: None,
            deviation_s: 0.0,
            saturation_s: 0.0,
            encoder_lost_s: 0.0,
            encoder_lost_command: DEFAULT_LOST_COMMAND,
            watchdog_s: 0.0,
            brake_release_s: 0.0,
            brake_apply_s: 0.0,
            line_filter_s: 0.0,
            off_causes: word_of(DEFAULT_OFF),
            direct_duty: DEFAULT_DIRECT_DUTY,
            direct_hold_s: None,
            excitation: None,
        }
    }
}

/// The word with the bits of these causes and of those that always switch off.
fn word_of(causes: impl IntoIterator<Item = Cause>) -> u16 {
    // The bits from 16 up are causes whose reaction cannot be chosen.
    causes.into_iter().fold(ALWAYS_OFF, |word, cause| word | cause.bit()) as u16
}

/// The keys of the table: first the limits of moves, which the tools use without a supervisor too, then those of the
/// supervisor.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "velocity",
        Values::Quantity(MOTION),
        "Largest velocity of a move, in unit/s.",
    ),
    Key::new(
        "acceleration",
        Values::Quantity(MOTION),
        "Largest acceleration of a move, in unit/s².",
    ),
    Key::new("jerk", Values::Quantity(MOTION), "Largest jerk of a move, in unit/s³."),
    Key::new(
        "travel",
        Values::Pair(POSITION),
        "[low, high] position in the axis's unit; with a controller, the soft limits.",
    )
    .rule("`low` below `high`; without `modulo`, both within the position word"),
    Key::switch(
        "soft_limits_after_homing",
        "The soft limits act only once the host has homed the axis.",
    )
    .rule("needs `travel`"),
    Key::new(
        "stop_deceleration",
        Values::Quantity(MOTION),
        "Deceleration of a quick stop, in unit/s². Absent: `acceleration`.",
    )
    .rule("at most 127.99 counts per tick²"),
    Key::new(
        "following_error",
        Values::Quantity(MOTION),
        "Largest distance of the position from the shaped command, in the axis's unit. Absent: not checked.",
    )
    .rule("2^−16 to 32767.99 counts"),
    Key::new(
        "deviation",
        Values::Quantity(MOTION),
        "Largest distance of the motor from the scale, in the axis's unit; needs [axis.scale].",
    )
    .rule("1 to 2,147,483,646 counts"),
    Key::or_zero(
        "deviation_s",
        SECONDS,
        "How long the deviation may be larger; needs `deviation`. 0: the axis stops at once.",
    )
    .rule("at most 65,535 ticks"),
    Key::or_zero(
        "saturation_s",
        SECONDS,
        "How long the controller's command may be clamped. 0: not checked.",
    )
    .rule("at most 65,535 ticks"),
    Key::or_zero(
        "encoder_lost_s",
        SECONDS,
        "How long the encoder may stand still or go the wrong way under a command. 0: not checked.",
    )
    .rule("at most 65,535 ticks"),
    Key::new(
        "encoder_lost_command",
        Values::Number(PART_BELOW),
        "Fraction of full scale above which a command must move the encoder; needs `encoder_lost_s`.",
    )
    .rule("below `current_limit_a`/`full_scale_a`")
    .default(Absent::Number(DEFAULT_LOST_COMMAND)),
    Key::or_zero(
        "watchdog_s",
        SECONDS,
        "How long the host may be silent. 0: no watchdog.",
    )
    .rule("at most 65,535 ticks"),
    Key::or_zero(
        "brake_release_s",
        SECONDS,
        "Time from releasing the brake until it is open.",
    )
    .rule("at most 65,535 ticks"),
    Key::or_zero("brake_apply_s", SECONDS, "Time from applying the brake until it holds.").rule("at most 65,535 ticks"),
    Key::or_zero(
        "line_filter_s",
        SECONDS,
        "Longest ignored pulse on emergency stop, limit switches, home, drive ready.",
    )
    .rule("at most 63 clocks"),
    Key::new(
        "off",
        Values::Words(|| CHOICES.map(Cause::name).to_vec()),
        "Causes that switch the outputs off at once; the others make a quick stop. The list replaces the default.",
    )
    .rule("[causes](#axislimits) below; may be empty"),
    Key::new(
        "direct_duty",
        Values::Number(PART),
        "Bring-up: largest manual duty, as a fraction of full duty.",
    )
    .default(Absent::Number(DEFAULT_DIRECT_DUTY)),
    Key::new(
        "direct_hold_s",
        Values::Number(LASTING),
        "Bring-up: how long a manual duty lasts without a new request.",
    )
    .rule("1 to 65,535 ticks; absent: 0.2 s, or the longest that fits"),
    Key::new(
        "excitation",
        Values::Quantity(MOTION),
        "Bring-up: largest amplitude of test signals, in the axis's unit.",
    )
    .rule("2^−8 to 255.99 counts; absent: 4 counts"),
];
/// Keys about a loop, which an axis with steps does not have.
const OF_A_LOOP: [&str; 6] = [
    "following_error",
    "saturation_s",
    "encoder_lost_s",
    "encoder_lost_command",
    "direct_duty",
    "direct_hold_s",
];
/// Number of keys, from the first one, that limit moves.
const OF_MOVES: usize = 4;

/// Reads the limits of an axis. `word` has the loop's counts per unit and the number format that the travel must fit;
/// `None` where one of them is invalid. The supervisor counts most times in ticks of `clock`.
pub(super) fn read(
    axis: &Table<'_, '_>,
    table: &Table<'_, '_>,
    word: Option<(f64, FixedPoint)>,
    unit: AxisUnit,
    clock: Option<ClockSection>,
) -> LimitsSection {
    table.allow(KEYS);
    check_needs(axis, table);
    let reason = "the 65,535 ticks that its word counts: a lower clock.sample_hz allows more";
    let in_ticks = |range: NumberRange| match clock {
        Some(clock) => range.at_most(TICKS_MAX / clock.sample_hz, reason),
        None => range,
    };
    let default = LimitsSection::default();
    let quantity = |key| table.quantity(key, MOTION, unit);
    let seconds = |key| table.number(key, in_ticks(SECONDS)).unwrap_or(0.0);
    LimitsSection {
        velocity: quantity("velocity"),
        acceleration: quantity("acceleration"),
        jerk: quantity("jerk"),
        travel: read_travel(table, word, unit, axis.has("controller") || axis.has("steps")),
        soft_limits_after_homing: table.boolean("soft_limits_after_homing").unwrap_or(false),
        stop_deceleration: quantity("stop_deceleration"),
        following_error: quantity("following_error"),
        deviation: quantity("deviation"),
        deviation_s: seconds("deviation_s"),
        saturation_s: seconds("saturation_s"),
        encoder_lost_s: seconds("encoder_lost_s"),
        encoder_lost_command: table
            .number("encoder_lost_command", PART_BELOW)
            .unwrap_or(default.encoder_lost_command),
        watchdog_s: seconds("watchdog_s"),
        brake_release_s: seconds("brake_release_s"),
        brake_apply_s: seconds("brake_apply_s"),
        line_filter_s: table.number("line_filter_s", SECONDS).unwrap_or(0.0),
        off_causes: table
            .choices("off", &CHOICES.map(|cause| (cause.name(), cause)))
            .map_or(default.off_causes, word_of),
        direct_duty: table.number("direct_duty", PART).unwrap_or(default.direct_duty),
        direct_hold_s: table.number("direct_hold_s", in_ticks(LASTING)),
        excitation: quantity("excitation"),
    }
}

/// Checks that each monitored quantity exists on the axis.
fn check_needs(axis: &Table<'_, '_>, table: &Table<'_, '_>) {
    let supervised = KEYS.iter().skip(OF_MOVES).map(|key| key.name);
    for key in supervised.filter(|key| table.has(key)) {
        // A misspelt table has been reported already.
        if axis.has("input") {
            let found = format!("{key} with [axis.input]");
            let allowed =
                format!("{key} on an axis whose command comes from a host: an inline shaper has no supervisor");
            table.contradiction(key, found, allowed, format!("remove `{key}`"));
        } else if axis.lacks("controller") && axis.lacks("steps") {
            let or = if OF_A_LOOP.contains(&key) {
                ""
            } else {
                " or [axis.steps]"
            };
            let allowed = format!("{key} on an axis with [axis.controller]{or}, which has a supervisor");
            need(table, key, "[axis.controller]", allowed);
        } else if OF_A_LOOP.contains(&key) && axis.has("steps") {
            let found = format!("{key} with [axis.steps]");
            let allowed = format!("{key} on an axis with [axis.controller], whose loop it is about");
            table.contradiction(key, found, allowed, format!("remove `{key}`"));
        } else if key == "deviation" && axis.lacks("scale") {
            let allowed = "deviation on an axis with [axis.scale], from which the motor may deviate";
            need(table, key, "[axis.scale]", allowed.to_owned());
        } else if key == "deviation_s" && !table.has("deviation") {
            let allowed = "deviation_s with deviation, which it lets pass for a time";
            need(table, key, "`deviation`", allowed.to_owned());
        } else if key == "soft_limits_after_homing" && !table.has("travel") {
            let allowed = "soft_limits_after_homing with travel, which are the soft limits";
            need(table, key, "`travel`", allowed.to_owned());
        } else if key == "encoder_lost_command" && !table.has("encoder_lost_s") {
            let allowed = "encoder_lost_command with encoder_lost_s, which switches the monitor on";
            need(table, key, "`encoder_lost_s`", allowed.to_owned());
        }
    }
}

fn need(table: &Table<'_, '_>, key: &str, missing: &str, allowed: String) {
    let plain = missing.trim_matches('`');
    let remedy = format!("add {missing}, or remove `{key}`");
    table.contradiction(key, format!("{key} without {plain}"), allowed, remedy);
}

/// Reads the travel, and checks that the word holds it.
fn read_travel(
    table: &Table<'_, '_>,
    word: Option<(f64, FixedPoint)>,
    unit: AxisUnit,
    has_controller: bool,
) -> Option<[f64; 2]> {
    let travel = table
        .numbers::<2>("travel", POSITION.times(unit.per_si()).unit(unit.symbol()))?
        .map(|position| unit.to_si(position));
    if travel[0] >= travel[1] {
        table.refuse("travel", "[low, high] with low below high", "exchange the two limits");
    } else if let Some((counts_per_unit, format)) = word {
        check_travel(table, travel, counts_per_unit, format, has_controller);
    }
    Some(travel)
}

/// Checks that the whole travel fits the position word, and names the next size that holds it: that of a stage on an
/// axis with a controller.
fn check_travel(
    limits: &Table<'_, '_>,
    travel: [f64; 2],
    counts_per_unit: f64,
    format: FixedPoint,
    has_controller: bool,
) {
    let counts = travel.iter().fold(0.0, |most: f64, position| most.max(position.abs())) * counts_per_unit;
    let fits = |bits: u32, fraction: u32| counts <= largest_position(bits, fraction);
    let (bits, fraction) = (format.command_bits, format.command_fraction);
    if fits(bits, fraction) {
        return;
    }
    let next_bits = WORD_BITS.into_iter().find(|b| *b > bits && fits(*b, fraction));
    let next_fraction = (0..fraction).rev().find(|f| fits(bits, *f));
    let widest = *WORD_BITS.end();
    let remedy = match (next_bits, next_fraction) {
        (Some(_), _) if has_controller && fits(widest, fraction) => {
            format!("set fixed_point.command_bits = {widest}, which a stage needs")
        }
        (Some(bits), _) => format!("set fixed_point.command_bits = {bits}"),
        // The positions of a stage have 8 fraction bits, whatever the command's words have.
        (None, Some(fraction)) if !has_controller => format!("set fixed_point.command_fraction = {fraction}"),
        (None, _) => "lower counts_per_unit, or shorten the travel".to_owned(),
    };
    let found = format!("a travel of up to {} counts", short(counts.ceil()));
    let most = short(largest_position(bits, fraction).floor());
    let allowed = format!("at most {most} counts in {bits} bits with {fraction} fraction bits; {remedy}");
    limits.contradiction("travel", found, allowed, remedy);
}

/// Largest position in counts that a word holds.
fn largest_position(command_bits: u32, command_fraction: u32) -> f64 {
    (f64::from(command_bits - 1).exp2() - 1.0) / f64::from(command_fraction).exp2()
}
