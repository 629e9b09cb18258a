//! Kinds that treat all modes of an axis together: reads the keys of the machine file and designs the shaper.

use super::antisymmetric::{self, Antisymmetric, AntisymmetricMethod, Participant};
use super::constraint::{Amplitudes, Constraint};
use super::joint_error::JointError;
use super::kind::ShaperKind;
use super::optimal::{self, Optimal};
use super::periodic::{self, Base, Periodic};
use super::simultaneous::{self, Simultaneous};
use super::{DesignError, RESIDUAL_TOLERANCE, custom};
use crate::analysis::residual_vibration;
use crate::axis::ShapedAxis;
use crate::axis::{DEFAULT_CHEBYSHEV_ORDER, DEFAULT_TOLERANCE};
use crate::impulse::ImpulseSequence;
use crate::mode::Mode;

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
    /// What `optimal` was designed for, and why nothing is shorter.
    Optimal(Optimal),
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
    let given = axis.shaper;
    match kind {
        ShaperKind::None => return Ok((ImpulseSequence::unity(), Findings::None)),
        ShaperKind::Custom => {
            let impulses = given.map_or(&[][..], |s| &s.impulses);
            return Ok((custom::design(axis.name, impulses)?, Findings::None));
        }
        _ => {}
    }
    if axis.modes.is_empty() {
        return Err(DesignError::NoModes {
            axis: axis.name.to_owned(),
            kind: kind.to_string(),
        });
    }
    let found = match kind {
        ShaperKind::Periodic => design_periodic(axis),
        ShaperKind::Antisymmetric => design_antisymmetric(axis),
        ShaperKind::Simultaneous => design_simultaneous(axis),
        ShaperKind::Optimal => {
            optimal::design(axis, sample_hz).map(|(impulses, found)| (impulses, Findings::Optimal(found)))
        }
        _ => return Err(DesignError::NotBuilt { kind }),
    };
    found.map_err(|cause| DesignError::JointOfAxis {
        axis: axis.name.to_owned(),
        kind,
        cause: Box::new(cause),
    })
}

fn design_periodic(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let base = Base {
        kind: given.and_then(|s| s.base).unwrap_or(ShaperKind::MultiEi),
        order: given.and_then(|s| s.order).unwrap_or(DEFAULT_CHEBYSHEV_ORDER),
        tolerance: given.and_then(|s| s.tolerance).unwrap_or(DEFAULT_TOLERANCE),
    };
    let modes: Vec<(Mode, f64)> = axis.modes.iter().map(|m| (m.mode, axis.tolerance_of(m))).collect();
    let found = periodic::design(&modes, base, axis.lowest_frequency_hz())?;
    Ok((found.impulses.clone(), Findings::Periodic(found)))
}

fn design_antisymmetric(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let method = given
        .and_then(|s| s.method.as_deref())
        .and_then(AntisymmetricMethod::from_name);
    let method = method.unwrap_or_default();
    let ratio_tolerance = given.and_then(|s| s.ratio_tolerance).unwrap_or(0.0);
    let participants = axis.modes.iter().map(|m| Participant {
        mode: m.mode,
        participation: m.participation,
    });
    let participants: Vec<Participant> = participants.collect();
    let found = antisymmetric::design(&participants, method, ratio_tolerance)?;
    // The paper's damped impulses, and ratios with a tolerance, leave a residual that is only reported.
    if method == AntisymmetricMethod::Exact && ratio_tolerance == 0.0 {
        check_zeros(ShaperKind::Antisymmetric, &found.impulses, axis)?;
    }
    Ok((found.impulses.clone(), Findings::Antisymmetric(found)))
}

fn design_simultaneous(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let amplitudes = match given.and_then(|s| s.amplitude.as_deref()) {
        Some("um") => Amplitudes::UnitMagnitude,
        _ => Amplitudes::PartialSum,
    };
    let constraints = axis.modes.iter().map(|m| match axis.kind_of(m) {
        ShaperKind::Zv => Ok((m.mode, Constraint::Zv)),
        ShaperKind::Zvd => Ok((m.mode, Constraint::Zvd)),
        other => Err(JointError::Constraint(other)),
    });
    let constraints: Vec<(Mode, Constraint)> = constraints.collect::<Result<_, _>>()?;
    let found = simultaneous::design(&constraints, amplitudes)?;
    check_zeros(ShaperKind::Simultaneous, &found.impulses, axis)?;
    Ok((found.impulses.clone(), Findings::Simultaneous(found)))
}

fn check_zeros(kind: ShaperKind, impulses: &ImpulseSequence, axis: ShapedAxis<'_>) -> Result<(), DesignError> {
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
