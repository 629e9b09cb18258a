//! Kinds that treat all modes of an axis together: what their designs have in common.

use super::antisymmetric::Antisymmetric;
use super::kind::{Design, ShaperKind};
use super::optimal::Optimal;
use super::periodic::Periodic;
use super::simultaneous::Simultaneous;
use super::{DesignError, RESIDUAL_TOLERANCE};
use crate::analysis::residual_vibration;
use crate::axis::ShapedAxis;
use crate::impulse::ImpulseSequence;

/// Results of a design beside its impulses.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Findings {
    /// The kind has no further results.
    #[default]
    None,
    /// All solutions of `periodic`.
    Periodic(Periodic),
    /// The sets of modes of `antisymmetric`, their multiples and errors.
    Antisymmetric(Antisymmetric),
    /// Whether the impulses of `simultaneous` are proven to be the shortest.
    Simultaneous(Simultaneous),
    /// Conditions of `optimal`, and the proof that no shorter shaper exists.
    Optimal(Optimal),
    /// Delays in s of the half sums that compute the axis, all modes' in the order of the file.
    HalfSums(Vec<f64>),
}

/// Designs the shaper of an axis whose kind serves all modes, and checks it at every mode where the kind promises a zero.
///
/// # Errors
/// [`DesignError::JointOfAxis`] with the axis and the cause; [`DesignError::NoModes`] without modes to design for.
pub(super) fn design(
    axis: ShapedAxis<'_>,
    kind: ShaperKind,
    sample_hz: f64,
) -> Result<(ImpulseSequence, Findings), DesignError> {
    let design = match kind.row().design {
        Design::Fixed(design) => return Ok((design(axis)?, Findings::None)),
        Design::Axis(design) => design,
        Design::Mode(_) | Design::Kernel(_) => return Err(DesignError::OtherFamily { kind }),
    };
    if axis.modes.is_empty() {
        return Err(DesignError::NoModes {
            axis: axis.name.to_owned(),
            kind: kind.to_string(),
        });
    }
    design(axis, sample_hz).map_err(|cause| DesignError::JointOfAxis {
        axis: axis.name.to_owned(),
        kind,
        cause: Box::new(cause),
    })
}

/// Checks that a shaper leaves no vibration of any mode of the axis.
pub(super) fn check_zeros(
    kind: ShaperKind,
    impulses: &ImpulseSequence,
    axis: ShapedAxis<'_>,
) -> Result<(), DesignError> {
    for mode in axis.modes.iter().map(|m| m.mode) {
        let found = residual_vibration(impulses.impulses(), &mode);
        if found.is_nan() || found > RESIDUAL_TOLERANCE {
            return Err(DesignError::Unverified {
                kind,
                mode,
                found,
                promised: 0.0,
            });
        }
    }
    Ok(())
}
