//! `design --json`: the document of the command line's contract.

use super::certificate::CertificateDocument;
use super::delay::{DelayDocument, StageDocument};
use super::error_table::ErrorTableDocument;
use super::family::FamilyDocument;
use super::front::FrontDocument;
use super::given_move::MoveDocument;
use crate::control::ControlDocument;
use crate::text::UnitDocument;
use posicast_machine::mechanics::ScrewDrive;
use posicast_shaper::design::periodic::Solution;
use posicast_shaper::design::ratios::Class;
use posicast_taps::TapTable;
use schemars::JsonSchema;
use serde::Serialize;

/// `design --json`: the command line's contract.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Design")]
pub struct Document {
    pub(super) name: String,
    pub(super) axes: Vec<AxisDocument>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) fronts: Vec<FrontDocument>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) moves: Vec<MoveDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) stage: Option<StageDocument>,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "DesignAxis")]
pub(super) struct AxisDocument {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) unit: UnitDocument,
    pub(super) kind: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) solutions: Option<Vec<SolutionDocument>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) classes: Option<Vec<ClassDocument>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) time_optimal: Option<bool>,
    pub(super) impulses: Vec<ImpulseDocument>,
    pub(super) duration_s: f64,
    pub(super) delay_s: f64,
    pub(super) partial_sum_min: f64,
    pub(super) partial_sum_max: f64,
    pub(super) peak_command: f64,
    pub(super) cross_gains: Vec<CrossGainDocument>,
    pub(super) warnings: Vec<String>,
    pub(super) modes: Vec<ModeDocument>,
    pub(super) quantised: QuantisedDocument,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) certificate: Option<CertificateDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) family: Option<FamilyDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error_table: Option<ErrorTableDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) delay: Option<DelayDocument>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) control: Option<ControlDocument>,
}

/// An interval of frequencies that `periodic` may take.
#[derive(Serialize, JsonSchema)]
pub(super) struct SolutionDocument {
    pub(super) low_hz: f64,
    pub(super) high_hz: f64,
    pub(super) n: Vec<u32>,
}

impl SolutionDocument {
    pub(super) fn new(solution: &Solution) -> Self {
        Self {
            low_hz: solution.low_hz,
            high_hz: solution.high_hz,
            n: solution.n.clone(),
        }
    }
}

/// Modes of `antisymmetric` that share an antiperiod; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
pub(super) struct ClassDocument {
    pub(super) modes: Vec<usize>,
    pub(super) divisor_hz: f64,
    pub(super) multiples: Vec<u64>,
    pub(super) ratio_error: f64,
}

impl ClassDocument {
    pub(super) fn new(class: &Class) -> Self {
        Self {
            modes: class.members.iter().map(|index| index + 1).collect(),
            divisor_hz: class.multiples.divisor,
            multiples: class.multiples.multiples.clone(),
            ratio_error: class.multiples.error,
        }
    }
}

#[derive(Serialize, JsonSchema)]
pub(super) struct ImpulseDocument {
    pub(super) time_s: f64,
    pub(super) amplitude: f64,
}

/// Residual of the shaper for one mode at another mode.
#[derive(Serialize, JsonSchema)]
pub(super) struct CrossGainDocument {
    pub(super) kind: &'static str,
    pub(super) shaper_hz: f64,
    pub(super) at_hz: f64,
    pub(super) gain: f64,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "DesignMode")]
pub(super) struct ModeDocument {
    pub(super) frequency_hz: f64,
    pub(super) damping: f64,
    /// The mode as it was measured with the motor free.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) free: Option<FreeDocument>,
    /// What `[axis.mechanics]` makes it from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mechanics: Option<MechanicsDocument>,
    pub(super) residual: f64,
    pub(super) insensitivity: Option<(f64, Option<f64>)>,
}

/// A mode from data sheets.
#[derive(Serialize, JsonSchema)]
pub(super) struct MechanicsDocument {
    /// Whether the motor is `held` or `free` in this mode.
    motor: &'static str,
    stiffness_n_per_m: f64,
    table_mass_kg: f64,
    turning_inertia_kg_m2: f64,
    motor_mass_kg: f64,
}

impl MechanicsDocument {
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
pub(super) struct FreeDocument {
    pub(super) frequency_hz: f64,
    pub(super) damping: f64,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct QuantisedDocument {
    pub(super) sample_hz: f64,
    pub(super) coefficient_fraction: u32,
    pub(super) digitise: String,
    pub(super) fits: bool,
    pub(super) taps: Vec<TapDocument>,
    pub(super) modes: Vec<ResidualDocument>,
}

#[derive(Serialize, JsonSchema)]
pub(super) struct TapDocument {
    delay_samples: u32,
    coefficient: i32,
}

impl TapDocument {
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
pub(super) struct ResidualDocument {
    pub(super) residual: f64,
    /// Upper bound over the whole band of the mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) certified_residual: Option<f64>,
}
