//! `optimal`: the shortest possible shaper on the sample grid, for modes that are not known exactly.
//!
//! The mathematics is in the crate `posicast_optimal`: a cone program per duration, bisection over the durations, the dual solution as the
//! proof. Here the machine file's modes become its bands, its taps become impulses, and its rounding replaces that by largest remainder:
//! units move between taps until the residual of the *integer* table is within every tolerance over the whole bands.

use super::kind::{Design, KindRow, Promise, ShaperKind};
use super::{AxisDesign, DesignError, Findings, JointError};
use crate::axis::ShapedAxis;
use crate::digitise::{DELAY_MAX_SAMPLES, Digitised, TAPS_MAX, quantise};
use crate::impulse::{Impulse, ImpulseSequence};
use posicast_optimal::{
    Band, Command, LowerBound, Partner, Request, Shortest, Together, round_taps, shortest, together,
};
use posicast_taps::{Tap, TapTable};

/// `optimal`.
pub(super) const OPTIMAL: KindRow = KindRow::new(
    "optimal",
    Promise::Unsaid,
    Design::Axis(|axis, sample_hz| {
        design(axis, sample_hz).map(|(impulses, found)| (impulses, Findings::Optimal(found)))
    }),
    "the shortest shaper on the sample grid for the bands of all modes, with a proof ([optimal](optimal.md))",
)
.keys(&["command", "amplitude_bounds", "taps", "prefer"]);

/// Results of the design of `optimal` besides its impulses.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimal {
    /// The request.
    pub request: Request,
    /// Least duration in samples, for any number of taps and without the other axes.
    pub least_samples: u32,
    /// Proof that a shaper with one sample less breaks a tolerance.
    pub shorter: Option<LowerBound>,
    /// Whether the taps are those of a joint design, which may last longer.
    pub is_together: bool,
}

/// The joint design of all axes.
#[derive(Debug, Clone, PartialEq)]
pub struct TogetherDesign {
    /// The request: the axes, each with its own shortest shaper.
    pub partners: Vec<Partner>,
    /// The solution, with its proofs.
    pub found: Together,
}

/// Returns the request of the machine file.
pub fn request(axis: ShapedAxis<'_>, sample_hz: f64) -> Request {
    let given = axis.shaper;
    let bands = axis.modes.iter().map(|mode| {
        let band = mode.band();
        Band {
            frequency_hz: band.frequency_hz,
            damping: band.damping,
            tolerance: axis.tolerance_of(mode),
        }
    });
    Request {
        sample_hz,
        bands: bands.collect(),
        command: given.and_then(|shaper| shaper.command).unwrap_or(Command::Positive),
        prefer: given.and_then(|shaper| shaper.prefer).unwrap_or_default(),
        most_taps: given
            .and_then(|shaper| shaper.taps)
            .map_or(TAPS_MAX, |taps| taps as usize),
        longest_samples: DELAY_MAX_SAMPLES,
        delay_samples: None,
    }
}

/// Designs the shaper of an axis.
///
/// # Errors
/// [`DesignError::Mode`] for a mode that rings at no frequency; [`JointError::Optimal`] where the bands have no shaper.
pub fn design(axis: ShapedAxis<'_>, sample_hz: f64) -> Result<(ImpulseSequence, Optimal), DesignError> {
    for mode in axis.modes {
        DesignError::check_mode(&mode.mode)?;
    }
    let request = request(axis, sample_hz);
    let found = shortest(&request).map_err(JointError::from)?;
    let impulses = impulses_of_taps(axis.name, &found.taps, sample_hz)?;
    let findings = Optimal {
        request,
        least_samples: found.least_samples,
        shorter: found.shorter,
        is_together: false,
    };
    Ok((impulses, findings))
}

fn impulses_of_taps(axis: &str, taps: &[(u32, f64)], sample_hz: f64) -> Result<ImpulseSequence, DesignError> {
    // A sequence begins at 0; a shaper that has to be late may begin with samples without an amplitude.
    let begin = taps.first().filter(|tap| tap.0 > 0).map(|_| (0, 0.0));
    let impulses = begin
        .into_iter()
        .chain(taps.iter().copied())
        .map(|(sample, amplitude)| Impulse {
            time_s: f64::from(sample) / sample_hz,
            amplitude,
        });
    ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::NoSequence {
        what: format!("axis {axis}: shaper \"optimal\""),
        cause,
    })
}

/// Designs the `optimal` shapers of all axes as one, in place of those that they have alone. `mode_lags_s` has the lag of each axis's
/// modes behind its shaped command at low frequencies, in seconds.
///
/// # Errors
/// [`DesignError::JointOfAxis`] with the axis and the cause.
pub fn arrive_together(
    mode_lags_s: &[f64],
    designs: &mut [AxisDesign],
    sample_hz: f64,
) -> Result<Option<TogetherDesign>, DesignError> {
    let partners: Option<Vec<Partner>> = mode_lags_s
        .iter()
        .zip(designs.iter())
        .map(|(lag_s, design)| partner(*lag_s, design, sample_hz))
        .collect();
    let Some(partners) = partners else {
        return Ok(None);
    };
    let found = together(&partners).map_err(|error| DesignError::JointOfAxis {
        axis: designs
            .get(error.axis)
            .map_or_else(String::new, |design| design.name.clone()),
        kind: ShaperKind::Optimal,
        cause: Box::new(JointError::from(error.cause).into()),
    })?;
    for (design, taps) in designs.iter_mut().zip(&found.taps) {
        design.impulses = impulses_of_taps(&design.name, taps, sample_hz)?;
        if let Findings::Optimal(optimal) = &mut design.findings {
            optimal.is_together = true;
        }
    }
    Ok(Some(TogetherDesign { partners, found }))
}

fn partner(lag_s: f64, design: &AxisDesign, sample_hz: f64) -> Option<Partner> {
    let Findings::Optimal(optimal) = &design.findings else {
        return None;
    };
    let taps = design.impulses.impulses().iter();
    Some(Partner {
        request: optimal.request.clone(),
        alone: Shortest {
            taps: taps
                .map(|impulse| ((impulse.time_s * sample_hz).round() as u32, impulse.amplitude))
                .collect(),
            least_samples: optimal.least_samples,
            shorter: optimal.shorter.clone(),
        },
        lag_samples: lag_s * sample_hz,
    })
}

/// The integer tables of shapers with one `F`: by largest remainder, those of `optimal` by their residual.
///
/// # Errors
/// Those of [`quantise`].
pub fn tables(shapers: &[(&AxisDesign, &Digitised)], fraction: Option<u32>) -> Result<Vec<TapTable>, DesignError> {
    let named: Vec<(&str, &Digitised)> = shapers
        .iter()
        .map(|(design, digitised)| (design.name.as_str(), *digitised))
        .collect();
    let rounded = quantise(&named, fraction)?;
    let tables = rounded
        .into_iter()
        .zip(shapers)
        .map(|(table, (design, digitised))| match &design.findings {
            Findings::Optimal(found) => by_residual(&found.request, digitised, &table).unwrap_or(table),
            _ => table,
        });
    Ok(tables.collect())
}

/// The table whose residual is within the tolerances; `None` where it does not fit the coefficients.
fn by_residual(request: &Request, digitised: &Digitised, rounded: &TapTable) -> Option<TapTable> {
    let taps: Vec<(u32, f64)> = digitised
        .taps
        .iter()
        .map(|tap| (tap.delay_samples, tap.weight))
        .collect();
    let fraction = rounded.coefficient_fraction();
    let units = round_taps(request, &taps, fraction);
    let taps = units.into_iter().map(|(delay_samples, units)| {
        Some(Tap {
            delay_samples,
            coefficient: i32::try_from(units).ok()?,
        })
    });
    TapTable::new(fraction, taps.collect::<Option<_>>()?).ok()
}
