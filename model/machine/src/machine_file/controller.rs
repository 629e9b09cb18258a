//! `[axis.controller]`: the control law that turns the position error into the drive's command.

use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;
use posicast_shaper::unit::trimmed;

/// Range of the gains that are required and must be above 0.
const POSITIVE: NumberRange = NumberRange::positive(1e12);
/// Range of the gains of the sliding-mode law that may be 0.
const NOT_NEGATIVE: NumberRange = NumberRange::closed(0.0, 1e12);

/// `[axis.controller]`, with the position error in m (or rad). The law's output is a velocity in m/s for a velocity
/// drive, and for a torque drive the acceleration in m/s² that its force shall produce.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Controller {
    /// Sliding mode with a boundary layer: `s = de + c·e`, reaching law `−ε·sat(s/φ) − k·s`.
    SlidingMode {
        /// Slope of the sliding line, 1/s.
        c: f64,
        /// Rate at which `s` decays, 1/s.
        k: f64,
        /// Strength of the switching term, m/s².
        epsilon: f64,
        /// Half width φ of the boundary layer, m/s.
        boundary: f64,
    },
    /// Proportional and derivative gain with feed-forward; a gain that the file leaves out is computed from the
    /// drive.
    Pd {
        /// Proportional gain: in 1/s for a velocity drive, in 1/s² for a torque drive.
        proportional: Option<f64>,
        /// Derivative gain: without unit for a velocity drive, in 1/s for a torque drive.
        derivative: Option<f64>,
    },
    /// PD with an integral term, which is frozen while the command is clamped.
    Pid {
        /// Proportional gain, as for PD.
        proportional: Option<f64>,
        /// Derivative gain, as for PD.
        derivative: Option<f64>,
        /// Integral gain: in 1/s² for a velocity drive, in 1/s³ for a torque drive.
        integral: Option<f64>,
    },
}

/// Names of the control laws.
const KINDS: [&str; 3] = ["sliding-mode", "pd", "pid"];

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new("kind", Values::Word(|| KINDS.to_vec()), "Control law.").required(),
    Key::new(
        "c",
        Values::Number(POSITIVE),
        "Slope of the sliding line, in 1/s. `sliding-mode` needs it.",
    ),
    Key::new(
        "k",
        Values::Number(NOT_NEGATIVE),
        "Decay rate of the distance from the line, in 1/s. `sliding-mode` needs it.",
    ),
    Key::new(
        "epsilon",
        Values::Quantity(NOT_NEGATIVE),
        "Strength of the switching term, in unit/s². `sliding-mode` needs it.",
    ),
    Key::new(
        "boundary",
        Values::Quantity(POSITIVE),
        "Half width of the boundary layer, in unit/s. `sliding-mode` needs it.",
    ),
    Key::new(
        "proportional",
        Values::Number(POSITIVE),
        "Proportional gain of `pd` and `pid`, in 1/s (velocity drive) or 1/s² (torque drive). Absent: computed.",
    ),
    Key::new(
        "derivative",
        Values::Number(POSITIVE),
        "Derivative gain of `pd` and `pid`, a number (velocity drive) or in 1/s (torque drive). Absent: computed.",
    ),
    Key::new(
        "integral",
        Values::Number(POSITIVE),
        "Integral gain of `pid`, in 1/s² (velocity drive) or 1/s³ (torque drive). Absent: computed.",
    ),
];

/// The gains, each with the control laws that have it.
const GAINS: [(&str, &[&str]); 7] = [
    ("c", &["sliding-mode"]),
    ("k", &["sliding-mode"]),
    ("epsilon", &["sliding-mode"]),
    ("boundary", &["sliding-mode"]),
    ("proportional", &["pd", "pid"]),
    ("derivative", &["pd", "pid"]),
    ("integral", &["pid"]),
];

/// The gains that may be 0.
const NOT_NEGATIVE_GAINS: [&str; 2] = ["k", "epsilon"];

/// Returns the remedy for a missing gain of the sliding-mode law, on an axis of this unit.
fn sliding_mode_remedy(unit: AxisUnit) -> String {
    let [epsilon, boundary] = [4.0, 0.05].map(|figure| trimmed(unit.from_si(figure), 3));
    format!(
        "sliding mode needs the gains `c`, `k`, `epsilon` and `boundary`: begin with c = 150.0, k = 50.0, and in {unit}/s² and {unit}/s \
         epsilon = {epsilon}, boundary = {boundary} (docs/controllers.md says how they act); `kind = \"pd\"` computes its own gains"
    )
}

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<Controller> {
    table.allow(KEYS);
    let kind = table.required_choice("kind", &KINDS);
    let gain = |key| {
        // The other gains are rates or plain numbers, which are the same in every unit.
        match key {
            "epsilon" => table.quantity(key, NOT_NEGATIVE, unit),
            "boundary" => table.quantity(key, POSITIVE, unit),
            "k" => table.number(key, NOT_NEGATIVE),
            _ => table.number(key, POSITIVE),
        }
    };
    let [c, k, epsilon, boundary, proportional, derivative, integral] = GAINS.map(|(key, _)| gain(key));
    let kind = kind?;
    for (key, kinds) in GAINS {
        if kinds == ["sliding-mode"] && kind == "sliding-mode" {
            let range = if NOT_NEGATIVE_GAINS.contains(&key) {
                NOT_NEGATIVE
            } else {
                POSITIVE
            };
            table.require_with(key, range, sliding_mode_remedy(unit));
        } else if table.has(key) && !kinds.contains(&kind) {
            let found = format!("{key} with kind = \"{kind}\"");
            let kinds: Vec<String> = kinds.iter().map(|kind| format!("\"{kind}\"")).collect();
            let allowed = format!("{key} with kind = {} only", kinds.join(" or "));
            table.contradiction(key, found, allowed, format!("remove `{key}`"));
        }
    }
    Some(match kind {
        "sliding-mode" => Controller::SlidingMode {
            c: c?,
            k: k?,
            epsilon: epsilon?,
            boundary: boundary?,
        },
        "pd" => Controller::Pd {
            proportional,
            derivative,
        },
        _ => Controller::Pid {
            proportional,
            derivative,
            integral,
        },
    })
}
