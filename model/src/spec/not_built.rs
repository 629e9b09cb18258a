//! The blocks that the schema has and that this version builds no hardware for: checked as all others are, then refused.
//!
//! Nothing is kept of them but `[stage]`, which has a type of its own.

use super::machine::RATIO_ROUNDING;
use super::range::NumberRange;
use super::table::Table;
use super::{Clock, Stage};

/// Short times: dead time, minimum pulse, delays.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// What must be there to divide by.
const POSITIVE: NumberRange = NumberRange::positive(1e12);
/// What may be absent in the machine.
const NOT_NEGATIVE: NumberRange = NumberRange::closed(0.0, 1e12);
const FREQUENCY_HZ: NumberRange = NumberRange::positive(1e9).unit("Hz");
/// Delay line of the encoder's input filter, in clocks.
const MAX_FILTER_CLOCKS: u32 = 255;

/// Checks `[axis.encoder]` to `[axis.trace]` and the key `modulo`, and records each that is there.
pub(super) fn read_axis_blocks(axis: &Table<'_, '_>, clock: Option<Clock>) {
    for name in ["encoder", "scale", "pwm", "drive", "controller", "trace"] {
        let Some(table) = axis.table(name) else {
            continue;
        };
        match name {
            "encoder" => check_encoder(&table),
            "scale" => check_scale(&table),
            "pwm" => check_pwm(&table, clock),
            "drive" => check_drive(&table),
            "controller" => check_controller(&table),
            _ => check_trace(&table),
        }
        axis.not_built(name, name, None, &format!("leave the table [axis.{name}] out"));
    }
    if axis.boolean("modulo") == Some(true) {
        axis.not_built(
            "modulo",
            "modulo",
            None,
            "leave the key out, and keep the travel within the position word",
        );
    }
}

/// Reads `[stage]`, and records it.
pub(super) fn read_stage(root: &Table<'_, '_>, table: &Table<'_, '_>) -> Option<Stage> {
    table.allow(&["extra_delay_s", "contour_speed"]);
    root.not_built("stage", "stage", None, "leave the table [stage] out");
    Some(Stage {
        extra_delay_s: table.number("extra_delay_s", SHORT_S).unwrap_or(0.0),
        contour_speed: table.number("contour_speed", POSITIVE),
    })
}

fn check_encoder(table: &Table<'_, '_>) {
    table.allow(&["filter_clocks", "index"]);
    table.integer("filter_clocks", 0, MAX_FILTER_CLOCKS);
    table.boolean("index");
}

fn check_scale(table: &Table<'_, '_>) {
    table.allow(&["counts_per_unit", "use"]);
    table.required_number("counts_per_unit", POSITIVE);
    table.choice("use", &["monitor", "position"]);
}

fn check_pwm(table: &Table<'_, '_>, clock: Option<Clock>) {
    table.allow(&["mode", "frequency_hz", "dead_time_s", "minimum_pulse_s", "active_low"]);
    table.required_choice("mode", &["direction", "half-bridge", "full-bridge", "locked-antiphase"]);
    let frequency_hz = table.required_number("frequency_hz", FREQUENCY_HZ);
    let dead_time_s = table.number("dead_time_s", SHORT_S).unwrap_or(0.0);
    let minimum_pulse_s = table.number("minimum_pulse_s", SHORT_S).unwrap_or(0.0);
    table.boolean("active_low");
    let Some((pwm_hz, clock)) = frequency_hz.zip(clock) else {
        return;
    };
    check_pwm_frequency(table, pwm_hz, clock);
    let period_s = 1.0 / pwm_hz;
    if dead_time_s + minimum_pulse_s >= period_s {
        let found = format!(
            "a dead time and a minimum pulse of {} s together",
            dead_time_s + minimum_pulse_s
        );
        let key = if table.has("dead_time_s") {
            "dead_time_s"
        } else {
            "minimum_pulse_s"
        };
        let allowed = format!("below {period_s} s, the PWM period");
        table.contradiction(key, found, allowed, "shorten both, or lower the PWM frequency");
    }
}

/// A PWM period is a whole number of clocks, and a sample a whole number of PWM periods: of the frequencies that are
/// both, the message names the nearest.
fn check_pwm_frequency(table: &Table<'_, '_>, pwm_hz: f64, clock: Clock) {
    let clocks_per_sample = clock.clocks_per_sample();
    let frequencies = (1..=clocks_per_sample)
        .filter(|periods| clocks_per_sample.is_multiple_of(*periods))
        .map(|periods| f64::from(periods) * clock.sample_hz);
    let Some(nearest) = frequencies.min_by(|a, b| (a - pwm_hz).abs().total_cmp(&(b - pwm_hz).abs())) else {
        return;
    };
    if (nearest - pwm_hz).abs() > RATIO_ROUNDING * pwm_hz {
        let Clock {
            frequency_hz,
            sample_hz,
        } = clock;
        let allowed = format!(
            "what divides clock.frequency_hz = {frequency_hz} Hz and is a multiple of clock.sample_hz = {sample_hz} Hz; \
             the nearest is {nearest}"
        );
        table.refuse("frequency_hz", allowed, format!("write `frequency_hz = {nearest}`"));
    }
}

fn check_drive(table: &Table<'_, '_>) {
    let (current, velocity) = ("full_scale_a", "full_scale_velocity");
    table.allow(&[
        "mode",
        "equivalent_mass",
        "force_constant",
        "current_limit_a",
        current,
        velocity,
        "bandwidth_hz",
        "viscous",
        "coulomb",
    ]);
    let mode = table.required_choice("mode", &["torque", "velocity"]);
    let positive = [
        "equivalent_mass",
        "force_constant",
        "current_limit_a",
        current,
        velocity,
        "bandwidth_hz",
    ];
    let [_, _, limit_a, full_scale_a, _, _] = positive.map(|key| table.number(key, POSITIVE));
    table.number("viscous", NOT_NEGATIVE);
    table.number("coulomb", NOT_NEGATIVE);
    let (needed, refused): (&[&str], &str) = match mode {
        Some("torque") => (
            &["equivalent_mass", "force_constant", "current_limit_a", current],
            velocity,
        ),
        Some(_) => (&[velocity], current),
        None => return,
    };
    for key in needed {
        table.require(key, POSITIVE);
    }
    if table.has(refused) {
        let found = format!("{refused} with mode = {}", table.quote("mode"));
        let allowed = format!("{current} with mode torque, {velocity} with mode velocity");
        table.contradiction(refused, found, allowed, format!("remove `{refused}`"));
    }
    if let Some((limit_a, full_scale_a)) = limit_a.zip(full_scale_a).filter(|(limit, full)| limit > full) {
        let found = format!("a current limit of {limit_a} A");
        let allowed = format!("at most full_scale_a = {full_scale_a} A");
        table.contradiction(
            "current_limit_a",
            found,
            allowed,
            "lower current_limit_a: no command reaches it",
        );
    }
}

fn check_controller(table: &Table<'_, '_>) {
    let gains = ["c", "k", "epsilon", "boundary"];
    let [c, k, epsilon, boundary] = gains;
    table.allow(&["kind", c, k, epsilon, boundary]);
    let kind = table.required_choice("kind", &["sliding-mode", "pd", "pid"]);
    table.number(c, POSITIVE);
    table.number(k, NOT_NEGATIVE);
    table.number(epsilon, NOT_NEGATIVE);
    table.number(boundary, POSITIVE);
    for gain in gains {
        match kind {
            Some("sliding-mode") => table.require(gain, POSITIVE),
            Some(other) if table.has(gain) => {
                let found = format!("{gain} with kind = \"{other}\"");
                let allowed = format!("{gain} with kind = \"sliding-mode\" only");
                table.contradiction(gain, found, allowed, format!("remove `{gain}`"));
            }
            _ => {}
        }
    }
}

fn check_trace(table: &Table<'_, '_>) {
    let sizes = [256, 512, 1024, 2048];
    table.allow(&["samples"]);
    let list = sizes.map(|size| size.to_string()).join(", ");
    table.require("samples", &list);
    if table
        .integer("samples", 1, u32::MAX)
        .is_some_and(|samples| !sizes.contains(&samples))
    {
        table.refuse("samples", list, "choose one of the list");
    }
}
