//! An axis whose drive takes steps: what is wired otherwise than with a controller, and its registers.
//!
//! The pulse counter counts the axis's own lines, as the drive does. So position, index, velocity and the host's registers are those
//! of every axis, and the count is taken from the pins' own signals, independently of the step generator's.

use super::axis::{Nets, counter as of_every_counter, on};
use crate::composition::Part;
use crate::registers::{Access, Field, Register};
use crate::step_generator::{StepGeneratorConfig, StepMode};

/// Pulses of up to this many clocks on the lines of an encoder that watches the steps are ignored.
pub(super) const SCALE_FILTER_CLOCKS: u32 = 8;

/// Net of the contact of a probe.
pub(super) const TOUCHED: &str = "probe_touched";

/// Signals of the trace that only a controller has; they are recorded as 0.
pub(super) const LACKS_SIGNALS: [&str; 3] = ["error", "sliding", "command"];

const GENERATOR: Nets = &[
    ("enable", "steps_enable"),
    ("tick", "control"),
    ("clear_flags", "clear_sources"),
    ("count", "given_steps"),
    ("owed", "owed_steps"),
    ("active", "steps_active"),
    ("too_fast", "steps_too_fast"),
    ("owed_exceeded", "steps_owed_exceeded"),
    ("tripped", "steps_tripped"),
];

/// Wires the step generator to `reference`, the net of the shaped position. It takes the position when the controllers start, a fixed
/// time after the tick.
pub(super) fn generator(config: &StepGeneratorConfig, reference: &str, part: Part) -> Part {
    let [a, b] = config.mode().line_names();
    on(part, GENERATOR).on("position", reference).on("a", a).on("b", b)
}

/// Wires the pulse counter to the axis's own lines, and its index to a probe, if there is one. An active-low line is the complement: a step then counts at the end of its pulse.
pub(super) fn counter(config: &StepGeneratorConfig, probes: bool, part: Part) -> Part {
    let [a, b] = config.mode().line_names();
    let low = config.lines_active_low();
    let (mode, reversed) = match config.mode() {
        StepMode::StepDirection => (3, low.b),
        StepMode::UpDown => (4, false),
        StepMode::Quadrature => (0, low.a != low.b),
    };
    of_every_counter(part)
        .on("a", a)
        .on("b", b)
        .on("z", if probes { TOUCHED } else { "z" })
        .tied("filter_clocks", 0)
        .tied("mode", mode)
        .tied("invert", reversed.into())
}

/// Wires the supervisor: the causes of a controller and a PWM cannot occur, and the step generator's own trip switches off at once.
pub(super) fn supervisor(part: Part) -> Part {
    let zeros = [
        "error",
        "command",
        "following_error_limit",
        "limited_ticks",
        "saturated_high",
        "saturated_low",
        "controller_overrun",
    ];
    zeros
        .iter()
        .fold(part, |part, port| part.tied(port, 0))
        .on("pwm_tripped", "steps_tripped")
        .on("pwm_enable", "steps_enable")
        .on("pwm_trip_n", "steps_trip_n")
}

/// Registers that only an axis with a controller has.
const LACKS_REGISTERS: [&str; 18] = [
    "pwm_period_clocks",
    "direct",
    "setting_address",
    "setting",
    "setting_read",
    "setting_loaded",
    "law",
    "following_error_limit",
    "encoder",
    "pwm_trigger",
    "saturations",
    "self_test",
    "error",
    "command",
    "duty",
    "generator",
    "generator_rate",
    "generated_count",
];

/// Fields that only an axis with a controller has.
const LACKS_FIELDS: [&str; 14] = [
    "direct_enable",
    "self_test",
    "direct_active",
    "pwm_running",
    "trip_causes",
    "setting_read_waits",
    "encoder_disagreement",
    "controller_overrun",
    "limited_high",
    "limited_low",
    "pwm_saturated",
    "pwm_unaligned",
    "setting_refused",
    "direct_expired",
];

/// The registers of an axis with steps, made from those of an axis with a controller.
pub(super) fn registers(config: &StepGeneratorConfig, probes: bool, mut all: Vec<Register>) -> Vec<Register> {
    all.retain(|register| !LACKS_REGISTERS.contains(&register.name.as_str()));
    for register in &mut all {
        register
            .fields
            .retain(|field| !LACKS_FIELDS.contains(&field.name.as_str()));
        if register.name == "status" {
            for field in register.fields.iter_mut().filter(|of| probes && of.name == "level_z") {
                field.meaning = "the probe touches".to_owned();
            }
            register
                .fields
                .push(Field::flag("steps_active", 7, "the steps follow the shaped position"));
        }
        if register.name == "flags" {
            register.fields.extend([
                Field::flag(
                    "steps_too_fast",
                    25,
                    "a tick demanded more steps than the largest rate gives",
                ),
                Field::flag("steps_owed_exceeded", 26, "more steps were owed than are allowed"),
            ]);
        }
    }
    all.extend([
        Register::new(
            "step_period_clocks",
            0x00,
            Access::Constant,
            "parameter of the build",
            vec![
                Field::new("step_period_clocks", 0, 18, "shortest time from step to step")
                    .with_unit("clocks")
                    .with_reset(config.period_clocks() as u32),
            ],
        ),
        Register::new(
            "given_steps",
            0x38,
            Access::Live,
            "steps given since reset",
            vec![
                Field::new("given_steps", 0, 32, "steps given, up less down")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
        Register::new(
            "owed_steps",
            0x39,
            Access::Live,
            "steps that the shaped position has demanded and that are still to come",
            vec![
                Field::new("owed_steps", 0, 16, "steps owed, up less down")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
        Register::new(
            "snapshot_given_steps",
            0x42,
            Access::Shadow {
                of: "given_steps".to_owned(),
            },
            "steps given at the snapshot",
            vec![],
        ),
    ]);
    all
}
