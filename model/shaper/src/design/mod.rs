//! Shaper design: from the modes and the kind of an axis to impulses, and from these to the tap tables of the
//! machine.
//!
//! ```text
//! Axis ─► design_axis ─► AxisDesign (float, exact) ─► digitise ─► quantise ─► TapTable     design_machine does all axes
//! ```
//!
//! One file per kind of design. For one mode: [`zv`], [`hump_ei`], [`negative`], [`bias_point`], [`vibrationless`], [`smooth`]; for all
//! modes of an axis together: [`periodic`], [`simultaneous`], [`antisymmetric`], [`optimal`], [`custom`]. Every design is checked by its own
//! residual before it is returned: the result is a shaper that keeps its kind's promise at the mode, or an error with the limit of the
//! kind.

pub mod antisymmetric;
pub mod bias_point;
mod constraint;
mod convolution;
pub mod custom;
mod equations;
mod error;
pub mod front;
pub mod hump_ei;
mod joint;
mod joint_error;
pub mod kind;
pub mod negative;
mod newton;
pub mod optimal;
mod path;
pub mod periodic;
pub mod ratios;
pub mod simultaneous;
pub mod smooth;
mod time_optimal;
pub mod vibrationless;
pub mod zv;

pub use convolution::{ConvolutionFigures, ConvolutionWarning, CrossGain, convolution_figures};
pub use error::DesignError;
pub use joint::Findings;
pub use joint_error::JointError;

use crate::analysis::residual_vibration;
use crate::axis::AxisMode;
use crate::axis::ShapedAxis;
use crate::impulse::ImpulseSequence;
use crate::mode::Mode;
use kind::{Design, ShaperKind};
use smooth::Kernel;

/// Largest number of impulses of a convolution. A tap table holds 256, so more than this is a mistake in the machine
/// file.
pub const IMPULSES_MAX: usize = 4096;

/// Largest deviation of a design's residual from what its kind promises.
const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// The shaper of one axis in continuous time.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisDesign {
    /// Name of the axis.
    pub name: String,
    /// Kind as reports name it; the kinds of the modes, joined by `+`, where they have their own.
    pub kind: String,
    /// The impulses of the whole axis.
    pub impulses: ImpulseSequence,
    /// The shapers that the impulses are made of, which digitising needs.
    pub parts: ShaperParts,
    /// Further results of the design.
    pub findings: Findings,
}

/// The shapers that an axis's impulses are made of.
#[derive(Debug, Clone, PartialEq)]
pub enum ShaperParts {
    /// One shaper per mode, in the order of the file; the axis has their convolution.
    PerMode(Vec<ShaperPart>),
    /// One shaper for all modes.
    Joint {
        /// The first mode of the file, at whose pole the impulses are digitised; `None` without modes.
        reference: Option<Mode>,
    },
}

/// The shaper of one mode.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaperPart {
    /// The mode that it is designed for.
    pub mode: Mode,
    /// Its kind.
    pub kind: ShaperKind,
    /// Its impulses.
    pub impulses: ImpulseSequence,
}

/// Designs the shaper of one axis for samples at `sample_hz`: `optimal` and the smooth kinds have their impulses on them, the others do not
/// look at them.
///
/// # Errors
/// [`DesignError`] where a kind does not exist for a mode, or is given what it cannot take.
pub fn design_axis(axis: ShapedAxis<'_>, sample_hz: f64) -> Result<AxisDesign, DesignError> {
    let (impulses, parts, findings) = match axis.joint_kind() {
        Some(kind) => {
            let reference = axis.modes.first().map(|m| m.mode);
            let (impulses, findings) = joint::design(axis, kind, sample_hz)?;
            (impulses, ShaperParts::Joint { reference }, findings)
        }
        None => {
            let (impulses, parts) = per_mode(axis, sample_hz)?;
            let findings = if axis.is_cascade() {
                Findings::HalfSums(vibrationless::axis_half_sums_s(axis)?)
            } else {
                Findings::None
            };
            (impulses, parts, findings)
        }
    };
    Ok(AxisDesign {
        name: axis.name.to_owned(),
        kind: axis.kind_name(),
        impulses,
        parts,
        findings,
    })
}

/// Designs one shaper per mode and convolves them.
fn per_mode(axis: ShapedAxis<'_>, sample_hz: f64) -> Result<(ImpulseSequence, ShaperParts), DesignError> {
    if axis.modes.is_empty() {
        return Err(DesignError::NoModes {
            axis: axis.name.to_owned(),
            kind: axis.kind_name(),
        });
    }
    let cell_s = cell_s(axis, sample_hz)?;
    let mut whole = ImpulseSequence::unity();
    let mut parts = Vec::with_capacity(axis.modes.len());
    for axis_mode in axis.modes {
        let impulses = mode_impulses(axis, axis_mode, cell_s)?;
        // Impulses on one grid coincide in their convolution, which has few more than its factors.
        let count = if axis.kind_of(axis_mode).is_smooth() {
            whole.impulses().len()
        } else {
            whole.impulses().len() * impulses.impulses().len()
        };
        if count > IMPULSES_MAX {
            return Err(DesignError::TooManyImpulses {
                axis: axis.name.to_owned(),
                found: count,
            });
        }
        whole = whole.convolve(&impulses).map_err(|cause| DesignError::NoSequence {
            what: format!("axis {}: the convolution of its modes' shapers", axis.name),
            cause,
        })?;
        parts.push(ShaperPart {
            mode: axis_mode.mode,
            kind: axis.kind_of(axis_mode),
            impulses,
        });
    }
    Ok((whole, ShaperParts::PerMode(parts)))
}

/// Length in seconds of the cells in which the smooth kernels of an axis are sampled: one for all, so that they coincide.
fn cell_s(axis: ShapedAxis<'_>, sample_hz: f64) -> Result<f64, DesignError> {
    let smooth = axis.modes.iter().filter(|mode| axis.kind_of(mode).is_smooth());
    let kernels = smooth.map(|mode| Kernel::new(axis.kind_of(mode), &mode.mode, axis.tolerance_of(mode)));
    let kernels: Vec<Kernel> = kernels.collect::<Result<_, _>>()?;
    Ok(smooth::samples_per_cell(&kernels, sample_hz) / sample_hz)
}

/// Designs the impulses of one mode's shaper, and checks them at the mode.
fn mode_impulses(axis: ShapedAxis<'_>, axis_mode: &AxisMode, cell_s: f64) -> Result<ImpulseSequence, DesignError> {
    let (kind, mode) = (axis.kind_of(axis_mode), axis_mode.mode);
    if kind.is_smooth() {
        return Kernel::new(kind, &mode, axis.tolerance_of(axis_mode))?.sampled(kind, cell_s);
    }
    // A shaper that serves all modes of an axis cannot be one factor of a convolution.
    if kind.treats_modes_together() && kind != ShaperKind::None {
        return Err(DesignError::JointKindOfOneMode {
            axis: axis.name.to_owned(),
            kind,
            mode,
        });
    }
    let settings = ModeSettings {
        tolerance: axis.tolerance_of(axis_mode),
        order: axis.order_of(axis_mode),
        epsilon: axis.epsilon(),
    };
    design_mode(kind, &mode, &settings)
}

/// Parameters of a mode's shaper beside the mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeSettings {
    /// Residual vibration that the kinds with a tolerance promise, in (0, 1).
    pub tolerance: f64,
    /// Order, for the kinds that have one.
    pub order: u32,
    /// Bound `ε` of the residual in the band of `vibrationless`.
    pub epsilon: f64,
}

/// Designs the shaper of one mode, and checks it at the mode.
///
/// # Errors
/// [`DesignError::OtherFamily`] where the kind treats modes together or is a smooth one, which needs the sample grid
/// ([`smooth::Kernel`]); [`DesignError`] where it does not exist for the mode, or misses its promise.
pub fn design_mode(kind: ShaperKind, mode: &Mode, settings: &ModeSettings) -> Result<ImpulseSequence, DesignError> {
    let row = kind.row();
    let impulses = match row.design {
        Design::Mode(design) => design(kind, mode, settings)?,
        _ if kind == ShaperKind::None => ImpulseSequence::unity(),
        _ => return Err(DesignError::OtherFamily { kind }),
    };
    if let Some(promised) = kind.promised(settings.tolerance) {
        let found = residual_vibration(impulses.impulses(), mode);
        DesignError::verify(kind, mode, found, promised, RESIDUAL_TOLERANCE)?;
    }
    Ok(impulses)
}
