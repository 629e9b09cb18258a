//! Effect of convolution on bounds that each shaper keeps by itself.
//!
//! Pole sums multiply: at mode `j` the axis leaves `V_j = Π_i g_ij`, with `g_ij` the residual of mode `i`'s shaper at
//! mode `j`, its *cross gain*. Positive shapers have `g ≤ 1`, so a tolerance can only get better. Negative ones reach
//! 3 and more: the 5 % that an EI leaves at its own mode become 17 % (negative-impulse paper, table 5 and its notes).
//! Partial sums multiply as well: two shapers within −1 … 1 make one within −3 … 5, which asks the drive for five
//! times the step.
//!
//! Both cause a warning with a remedy. Neither is an error, because the machine may have the reserve.

use std::fmt;

use super::kind::ShaperKind;
use super::{AxisDesign, ShaperParts};
use crate::analysis::residual_vibration;
use crate::axis::ShapedAxis;
use crate::impulse::PartialSums;
use crate::mode::Mode;

/// A partial sum or residual that exceeds its bound by less than this fraction is a rounding error.
const ROUNDING: f64 = 1e-6;

/// An axis's shaper as the convolution of its modes' shapers.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvolutionFigures {
    /// Range of the shaped unit step.
    pub partial_sums: PartialSums,
    /// Largest magnitude of a partial sum, in steps: the peak that the drive is asked for.
    pub peak_command: f64,
    /// Residual of each mode's shaper at every other mode; empty for a shaper that treats all modes together.
    pub cross_gains: Vec<CrossGain>,
    /// Bounds that the convolution breaks.
    pub warnings: Vec<ConvolutionWarning>,
}

/// Residual of one mode's shaper at another mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossGain {
    /// Index, from 0 in the order of the file, of the mode that the shaper is designed for.
    pub shaper: usize,
    /// Kind of that shaper.
    pub kind: ShaperKind,
    /// Index, from 0 in the order of the file, of the mode at which the residual is taken.
    pub at: usize,
    /// Residual vibration there. It multiplies the residual of the other shapers.
    pub gain: f64,
}

/// A bound that a convolution breaks, with what to do about it: the text is for the user.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvolutionWarning {
    /// The shaped step leaves the range −1 … 1.
    PartialSums {
        /// Name of the axis.
        axis: String,
        /// The kinds that are convolved, joined by `+`.
        kind: String,
        /// Range of the shaped unit step.
        sums: PartialSums,
    },
    /// The shapers of other modes raise the residual of a mode's own shaper above its tolerance.
    Tolerance {
        /// Name of the axis.
        axis: String,
        /// The mode whose tolerance is exceeded.
        mode: Mode,
        /// Kind of its shaper.
        kind: ShaperKind,
        /// Residual of the whole axis at the mode.
        residual: f64,
        /// Its tolerance.
        tolerance: f64,
        /// Product of the cross gains at the mode.
        gain: f64,
    },
}

/// The figures of `design`, which must be the design of `axis`.
pub fn convolution_figures(axis: ShapedAxis<'_>, design: &AxisDesign) -> ConvolutionFigures {
    let partial_sums = design.impulses.partial_sums();
    let mut figures = ConvolutionFigures {
        partial_sums,
        peak_command: partial_sums.min.abs().max(partial_sums.max.abs()),
        cross_gains: Vec::new(),
        warnings: Vec::new(),
    };
    let ShaperParts::PerMode(parts) = &design.parts else {
        return figures;
    };
    let negative = parts
        .iter()
        .any(|part| part.impulses.impulses().iter().any(|impulse| impulse.amplitude < 0.0));
    if negative && figures.peak_command > 1.0 + ROUNDING {
        figures.warnings.push(ConvolutionWarning::PartialSums {
            axis: axis.name.to_owned(),
            kind: design.kind.clone(),
            sums: partial_sums,
        });
    }
    for (at, (part, axis_mode)) in parts.iter().zip(axis.modes).enumerate() {
        let mut product = 1.0;
        for (shaper, other) in parts.iter().enumerate().filter(|(shaper, _)| *shaper != at) {
            let gain = residual_vibration(other.impulses.impulses(), &part.mode);
            product *= gain;
            figures.cross_gains.push(CrossGain {
                shaper,
                kind: other.kind,
                at,
                gain,
            });
        }
        let tolerance = axis.tolerance_of(axis_mode);
        let own = residual_vibration(part.impulses.impulses(), &part.mode);
        let residual = residual_vibration(design.impulses.impulses(), &part.mode);
        let bound = tolerance * (1.0 + ROUNDING);
        if own <= bound && residual > bound {
            figures.warnings.push(ConvolutionWarning::Tolerance {
                axis: axis.name.to_owned(),
                mode: part.mode,
                kind: part.kind,
                residual,
                tolerance,
                gain: product,
            });
        }
    }
    figures
}

impl fmt::Display for ConvolutionWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PartialSums { axis, kind, sums } => write!(
                f,
                "axis {axis}: after the convolved {kind} a step reaches {:.4} to {:.4} of its height, beyond -1 … 1: the drive must have \
                 that room; otherwise use kind \"simultaneous\", or positive kinds for all modes but one",
                sums.min, sums.max
            ),
            Self::Tolerance {
                axis,
                mode,
                kind,
                residual,
                tolerance,
                gain,
            } => write!(
                f,
                "axis {axis}, mode {} Hz: the other modes' shapers multiply the residual of {kind} by {gain:.4}, to {:.4} %, above its \
                 tolerance of {:.4} %: set tolerance = {:.6} for this mode to make up for that, or use kind \"simultaneous\"",
                mode.frequency_hz,
                100.0 * residual,
                100.0 * tolerance,
                (1e6 * tolerance / gain).floor() / 1e6,
            ),
        }
    }
}
