//! The delays of a stage's axes.

use super::together::{Together, TogetherReport};
use posicast_machine::plan::{AxisDelay, MachineDesign, StageDelay};
use schemars::JsonSchema;
use serde::Serialize;

/// `stage` in `design --json` and `report.json`.
#[derive(Serialize, JsonSchema)]
pub struct EqualDelays {
    /// Total delay of every axis, before the coefficients are rounded.
    pub total_delay_s: f64,
    /// Largest difference between two axes, after rounding.
    pub mismatch_s: f64,
    /// Speed along a contour, if the machine file has one, in m/s or rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour_speed: Option<f64>,
    /// Distance that this speed makes of the difference, in µm or µrad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mismatch_um: Option<f64>,
    /// The joint design of the axes, if they have one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub together: Option<Together>,
}

impl EqualDelays {
    pub(super) fn new(stage: &StageDelay, design: &MachineDesign) -> Self {
        Self {
            total_delay_s: stage.total_s,
            mismatch_s: stage.mismatch_s,
            contour_speed: stage.contour_speed,
            mismatch_um: stage.mismatch_um(),
            together: TogetherReport::new(design).map(|together| together.json()),
        }
    }
}

/// `delay` of an axis there: its parts and their sum.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Delay")]
pub struct DelayParts {
    /// Mean delay of the shaper, before anything is added.
    pub shaper_s: f64,
    /// Lag of the modes, `Σ 2ζ/ω`.
    pub mode_lag_s: f64,
    /// Delay that was added.
    pub added_samples: f64,
    /// Change by the rounding of the coefficients.
    pub rounding_s: f64,
    /// Total delay of the integer table.
    pub total_s: f64,
}

impl DelayParts {
    pub(super) fn new(delay: &AxisDelay) -> Self {
        Self {
            shaper_s: delay.shaper_s,
            mode_lag_s: delay.mode_lag_s,
            added_samples: delay.added_samples,
            rounding_s: delay.rounding_s,
            total_s: delay.total_s(),
        }
    }
}
