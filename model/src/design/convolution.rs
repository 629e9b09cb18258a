//! What becomes of shapers that are good alone, once they are convolved.
//!
//! Pole sums multiply: at mode `j` the axis leaves `V_j = Π_i g_ij`, with `g_ij` the residual of mode `i`'s shaper at mode
//! `j`, its *cross gain*. Positive shapers have `g ≤ 1`, so a tolerance can only get better. Negative ones reach 3 and more:
//! the 5 % that an EI leaves at its own mode become 17 % (negative-impulse paper, table 5 and its notes). Partial sums
//! multiply as well: two shapers within −1 … 1 make one within −3 … 5, and the drive is asked for five times the step.
//!
//! Both are warned of, with what to do; neither is an error, for a machine may have the room.

use std::fmt;

use super::kind::ShaperKind;
use super::{AxisDesign, ShaperParts};
use crate::analysis::residual_vibration;
use crate::impulse::PartialSums;
use crate::machine_file::AxisSection;
use crate::mode::Mode;

/// A sum or residual beyond its bound by less than this share is rounding.
const ROUNDING: f64 = 1e-6;

/// An axis's shaper as the convolution of its modes' shapers.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvolutionFigures {
    /// Range of the shaped unit step.
    pub partial_sums: PartialSums,
    /// Largest magnitude of a partial sum: what the drive is asked for, in steps.
    pub peak_command: f64,
    /// What each mode's shaper does at every other mode; empty for a shaper that treats all modes together.
    pub cross_gains: Vec<CrossGain>,
    /// What the convolution spoils.
    pub warnings: Vec<ConvolutionWarning>,
}

/// What the shaper of one mode does at another mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossGain {
    /// Mode that the shaper is for, as a position in the file, from 0.
    pub shaper: usize,
    /// Kind of that shaper.
    pub kind: ShaperKind,
    /// Mode at which its residual vibration is taken, as a position in the file, from 0.
    pub at: usize,
    /// Residual vibration there: factor by which it scales what the other shapers leave.
    pub gain: f64,
}

/// What a convolution spoils, and what to do about it: the text is for the user.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvolutionWarning {
    /// A shaped step moves beyond −1 … 1.
    PartialSums {
        /// The axis.
        axis: String,
        /// The kinds that are convolved.
        kind: String,
        /// Range of the shaped unit step.
        sums: PartialSums,
    },
    /// Other modes' shapers lift what a mode's own shaper leaves above the tolerance.
    Tolerance {
        /// The axis.
        axis: String,
        /// The mode.
        mode: Mode,
        /// Its kind.
        kind: ShaperKind,
        /// Residual of the whole axis there.
        residual: f64,
        /// Its tolerance.
        tolerance: f64,
        /// Product of the cross gains there.
        gain: f64,
    },
}

/// The figures of `design`, which is that of `axis`.
pub fn convolution_figures(axis: &AxisSection, design: &AxisDesign) -> ConvolutionFigures {
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
            axis: axis.name.clone(),
            kind: design.kind.clone(),
            sums: partial_sums,
        });
    }
    for (at, (part, axis_mode)) in parts.iter().zip(&axis.modes).enumerate() {
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
                axis: axis.name.clone(),
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
                "axis {axis}: {kind} convolved take a step to between {:.4} and {:.4} of its height, beyond -1 … 1: the drive \
                 must have that room; else use kind \"simultaneous\", or positive kinds for all modes but one",
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
                "axis {axis}, mode {} Hz: the other modes' shapers multiply what {kind} leaves by {gain:.4}, to {:.4} %, above \
                 its tolerance of {:.4} %: design it with tolerance = {:.6} to leave that much, or use kind \"simultaneous\"",
                mode.frequency_hz,
                100.0 * residual,
                100.0 * tolerance,
                (1e6 * tolerance / gain).floor() / 1e6,
            ),
        }
    }
}
