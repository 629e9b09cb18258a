//! `design --json`: the document of the command line's contract.

use super::certificate::Certificate;
use super::delay::{Delay, EqualDelays};
use super::error_table::ErrorTable;
use super::family::Family;
use super::front::Front;
use super::given_move::ComparedMove;
use crate::control::Control;
use crate::text::UnitDocument;
use posicast_machine::mechanics::ScrewDrive;
use posicast_shaper::design::{periodic, ratios};
use posicast_taps::TapTable;
use schemars::JsonSchema;
use serde::Serialize;

/// `design --json`: the command line's contract.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Design")]
pub struct Document {
    pub(super) name: String,
    pub(super) axes: Vec<Axis>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) fronts: Vec<Front>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) moves: Vec<ComparedMove>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) stage: Option<EqualDelays>,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "DesignAxis")]
pub(super) struct Axis {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) unit: UnitDocument,
    pub(super) kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) solutions: Option<Vec<Solution>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) classes: Option<Vec<Class>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) time_optimal: Option<bool>,
    pub(super) impulses: Vec<Impulse>,
    pub(super) duration_s: f64,
    pub(super) delay_s: f64,
    pub(super) partial_sum_min: f64,
    pub(super) partial_sum_max: f64,
    pub(super) peak_command: f64,
    pub(super) cross_gains: Vec<CrossGain>,
    pub(super) warnings: Vec<String>,
    pub(super) modes: Vec<Mode>,
    pub(super) quantised: Quantised,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) certificate: Option<Certificate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) family: Option<Family>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error_table: Option<ErrorTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) delay: Option<Delay>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) control: Option<Control>,
}

/// An interval of frequencies that `periodic` may take.
#[derive(Serialize, JsonSchema)]
pub(super) struct Solution {
    pub(super) low_hz: f64,
    pub(super) high_hz: f64,
    pub(super) n: Vec<u32>,
}

impl Solution {
    pub(super) fn new(solution: &periodic::Solution) -> Self {
        Self {
            low_hz: solution.low_hz,
            high_hz: solution.high_hz,
            n: solution.n.clone(),
        }
    }
}

/// Modes of `antisymmetric` that share an antiperiod; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
pub(super) struct Class {
    pub(super) modes: Vec<usize>,
    pub(super) divisor_hz: f64,
    pub(super) multiples: Vec<u64>,
    pub(super) ratio_error: f64,
}

impl Class {
    pub(super) fn new(class: &ratios::Class) -> Self {
        Self {
            modes: class.members.iter().map(|index| index + 1).collect(),
            divisor_hz: class.multiples.divisor,
            multiples: class.multiples.multiples.clone(),
            ratio_error: class.multiples.error,
        }
    }
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Impulse {
    pub(super) time_s: f64,
    pub(super) amplitude: f64,
}

/// Residual of the shaper for one mode at another mode.
#[derive(Serialize, JsonSchema)]
pub(super) struct CrossGain {
    pub(super) kind: &'static str,
    pub(super) shaper_hz: f64,
    pub(super) at_hz: f64,
    pub(super) gain: f64,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "DesignMode")]
pub(super) struct Mode {
    pub(super) frequency_hz: f64,
    pub(super) damping: f64,
    /// The mode as it was measured with the motor free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) free: Option<FreeMode>,
    /// What `[axis.mechanics]` makes it from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mechanics: Option<Mechanics>,
    pub(super) residual: f64,
    pub(super) insensitivity: Option<(f64, Option<f64>)>,
}

/// A mode from data sheets.
#[derive(Serialize, JsonSchema)]
pub(super) struct Mechanics {
    /// Whether the motor is `held` or `free` in this mode.
    motor: &'static str,
    stiffness_n_per_m: f64,
    table_mass_kg: f64,
    turning_inertia_kg_m2: f64,
    motor_mass_kg: f64,
}

impl Mechanics {
    pub(super) fn new(screw: &ScrewDrive, is_motor_free: bool) -> Self {
        Self {
            motor: if is_motor_free { "free" } else { "held" },
            stiffness_n_per_m: screw.stiffness(),
            table_mass_kg: screw.table_mass,
            turning_inertia_kg_m2: screw.turning_inertia(),
            motor_mass_kg: screw.motor_mass(),
        }
    }
}

#[derive(Serialize, JsonSchema)]
pub(super) struct FreeMode {
    pub(super) frequency_hz: f64,
    pub(super) damping: f64,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Quantised {
    pub(super) sample_hz: f64,
    pub(super) coefficient_fraction: u32,
    pub(super) digitise: String,
    pub(super) fits: bool,
    pub(super) taps: Vec<Tap>,
    pub(super) modes: Vec<Residual>,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Tap {
    delay_samples: u32,
    coefficient: i32,
}

impl Tap {
    /// The taps of a table.
    pub(super) fn of(table: &TapTable) -> Vec<Self> {
        let taps = table.taps().iter();
        taps.map(|tap| Self {
            delay_samples: tap.delay_samples,
            coefficient: tap.coefficient,
        })
        .collect()
    }
}

#[derive(Serialize, JsonSchema)]
pub(super) struct Residual {
    pub(super) residual: f64,
    /// Upper bound over the whole band of the mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) certified_residual: Option<f64>,
}
