//! Bias-point extra-insensitive shapers: `zv-ei`, `zv-ei-2`, `zvd-ei`, `multi-ei`, `chebyshev-ei`, in closed form
//! with damping.
//!
//! The impulses stand at whole half periods. Pairs of zeros are spread round the mode so that the residual ripples
//! between them up to the tolerance (Zhang and Li 2010, equations 7, 20 to 27; equal ripple of any order: Dolph
//! 1946). With `T = π/ω_d` and `K = e^{−ζπ/√(1−ζ²)}` a pair of zeros with cosine `c` is
//!
//! ```text
//! [1, −2cK, K²] / (1 − 2cK + K²)  at 0, T, 2T
//!
//! n pairs of equal ripple:   c_k = ((1 + x_e) cos((2k−1)π/2n) − 1 + x_e) / 2,   k = 1…n      2n + 1 impulses, span 2nT
//! undamped:                  x_e = (3 − X)/(1 + X),  X = cosh(acosh(1/V) / n)                 x_e: cosine of the edge
//! λ = (2/π) asin √(2/(1 + X)):  V is kept on (1 ± λ)·ω_sys, and as far round 3, 5, 7, … times ω_sys
//! ```
//!
//! | kind | pairs of equal ripple | in series, each with `V^(1/series)` |
//! |---|---|---|
//! | `zv-ei` (undamped: the classical `ei`) | 1 | 1 |
//! | `zv-ei-2` | 1 | 2 |
//! | `zvd-ei` | 1 | 4 |
//! | `multi-ei` (undamped: the three-hump `ei`) | 2 | 1 |
//! | `chebyshev-ei` | the order, 1 to 5 | 1 |
//!
//! **Damping** weighs the impulses of an undamped design for `V′` by `K^k`, with the `V′` for which the residual at
//! the mode is the tolerance. No search is needed for `V′`: the residual of one factor in series is the ratio of two
//! values of the ripple polynomial `T_n`,
//!
//! ```text
//! V = K^{2n} V′ / Σ A_k(V′) K^k = K^n / T_n(z),     z = (2x + 1 − x_e)/(1 + x_e),   x = (K + 1/K)/2
//! V = tolerance:  z = cosh(acosh(K^n/tolerance) / n),   x_e = (2x + 1 − z)/(1 + z)
//! ```
//!
//! `V` falls as `z` grows, and `z` falls as `x_e` does, so there is one solution or none: `V′ < 1` needs `z > x`,
//! which is `tolerance < 2K^{2n}/(1 + K^{2n})`. All amplitudes are positive, at every tolerance and order.

use std::f64::consts::PI;

use super::DesignError;
use super::kind::{Design, KindRow, Promise, ShaperKind};
use crate::axis::DEFAULT_CHEBYSHEV_ORDER;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `zv-ei`.
pub(super) const ZV_EI: KindRow = row(
    "zv-ei",
    "`tolerance` at the mode, one pair of zeros; impulses at whole half periods",
);

/// `zv-ei-2`.
pub(super) const ZV_EI_2: KindRow = row("zv-ei-2", "two `zv-ei` in series, each for the root of `tolerance`");

/// `zvd-ei`.
pub(super) const ZVD_EI: KindRow = row(
    "zvd-ei",
    "four `zv-ei` in series, each for the fourth root of `tolerance`",
);

/// `multi-ei`.
pub(super) const MULTI_EI: KindRow = row("multi-ei", "two pairs of zeros of equal ripple");

/// `chebyshev-ei`.
pub(super) const CHEBYSHEV_EI: KindRow = row(
    "chebyshev-ei",
    "`order` pairs of zeros of equal ripple: the widest band for the length",
)
.keys(&["order"])
.order(DEFAULT_CHEBYSHEV_ORDER);

const fn row(name: &'static str, about: &'static str) -> KindRow {
    let design = Design::Mode(|kind, mode, settings| design(kind, settings.order, mode, settings.tolerance));
    KindRow::new(name, Promise::Tolerance, design, about).source("Zhang and Li 2010")
}

/// Largest order of `chebyshev-ei`.
pub const ORDER_MAX: u32 = 5;

/// An undamped bias-point shaper, impulses at `k·π/ω_sys`: what `periodic` repeats over its modes.
#[derive(Debug, Clone, PartialEq)]
pub struct BiasPoint {
    /// Amplitudes, symmetric and with sum 1; the impulses are `π/ω_sys` apart.
    pub amplitudes: Vec<f64>,
    /// One-sided relative tolerance: the largest `λ` with `V ≤ tolerance` on `[1 − λ, 1 + λ]·ω_sys`.
    pub lambda: f64,
    /// Angles `ω·π/ω_sys` in (0, π) of the zeros below `ω_sys`, repeated by multiplicity; the zeros above are their
    /// mirror images.
    pub zeros_theta: Vec<f64>,
}

/// Designs the undamped base of `kind`; `order` is the number of zero pairs of `chebyshev-ei` and ignored by other
/// kinds.
///
/// # Errors
/// [`DesignError::BiasPoint`] for a tolerance outside (0, 1), an order outside 1..=[`ORDER_MAX`], or a kind of
/// another family.
pub fn undamped(kind: ShaperKind, order: u32, tolerance: f64) -> Result<BiasPoint, DesignError> {
    let ripple = Ripple::of(kind, order, tolerance)?;
    let edge = (ripple.factor_tolerance.recip().acosh() / f64::from(ripple.pairs)).cosh();
    let cosines = ripple.cosines((3.0 - edge) / (1.0 + edge));
    Ok(BiasPoint {
        amplitudes: ripple.amplitudes(&cosines, 1.0),
        lambda: 2.0 / PI * (2.0 / (1.0 + edge)).sqrt().asin(),
        zeros_theta: cosines.iter().map(|c| c.acos()).collect(),
    })
}

/// Designs a bias-point shaper that leaves `tolerance` at the mode.
///
/// # Errors
/// [`DesignError::BiasPoint`] as for [`undamped`]; [`DesignError::NoSolution`] where no `V′` below 1 leaves the tolerance:
/// from ζ .504 on at 5 % for `zv-ei`, .31 `zv-ei-2`, .28 `multi-ei`, .19 order 3, .18 `zvd-ei`, .12 order 5.
pub fn design(kind: ShaperKind, order: u32, mode: &Mode, tolerance: f64) -> Result<ImpulseSequence, DesignError> {
    DesignError::check_mode(mode)?;
    let ripple = Ripple::of(kind, order, tolerance)?;
    let ratio = mode.half_swing_ratio();
    let edge_cosine = ripple.damped_edge(ratio).ok_or_else(|| DesignError::NoSolution {
        kind,
        mode: *mode,
        tolerance,
        largest_damping: ripple.largest_damping(),
        largest_tolerance: Some(ripple.largest_tolerance(ratio)),
    })?;
    let spacing_s = mode.damped_period_s() / 2.0;
    let amplitudes = ripple.amplitudes(&ripple.cosines(edge_cosine), ratio);
    let impulses = amplitudes.iter().enumerate().map(|(index, &amplitude)| Impulse {
        time_s: index as f64 * spacing_s,
        amplitude,
    });
    ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::no_sequence(kind, mode, cause))
}

/// Structure of a kind: `series` factors, each with the same equal ripple of `pairs` pairs of zeros.
#[derive(Debug, Clone, Copy)]
struct Ripple {
    pairs: u32,
    series: u32,
    /// Tolerance of one of the factors in series.
    factor_tolerance: f64,
}

impl Ripple {
    fn of(kind: ShaperKind, order: u32, tolerance: f64) -> Result<Self, DesignError> {
        let structure = match kind {
            ShaperKind::ZvEi => Some((1, 1)),
            ShaperKind::ZvEi2 => Some((1, 2)),
            ShaperKind::ZvdEi => Some((1, 4)),
            ShaperKind::MultiEi => Some((2, 1)),
            ShaperKind::ChebyshevEi if (1..=ORDER_MAX).contains(&order) => Some((order, 1)),
            _ => None,
        };
        match structure {
            Some((pairs, series)) if tolerance > 0.0 && tolerance < 1.0 => Ok(Self {
                pairs,
                series,
                factor_tolerance: tolerance.powf(f64::from(series).recip()),
            }),
            _ => Err(DesignError::BiasPoint { kind, order, tolerance }),
        }
    }

    /// Cosine of the edge at which the damped residual is the tolerance; `None` where there is none.
    fn damped_edge(&self, ratio: f64) -> Option<f64> {
        let pairs = f64::from(self.pairs);
        let pole = f64::midpoint(ratio, ratio.recip());
        let image = ((ratio.powf(pairs) / self.factor_tolerance).acosh() / pairs).cosh();
        // The image is NaN where the tolerance exceeds what K^n alone leaves: then there is no solution either.
        (image > pole && image.is_finite()).then(|| (2.0 * pole + 1.0 - image) / (1.0 + image))
    }

    /// Cosines of the zeros' angles, of all factors together.
    fn cosines(&self, edge_cosine: f64) -> Vec<f64> {
        let one = (1..=self.pairs).map(|k| {
            let ripple = (f64::from(2 * k - 1) * PI / f64::from(2 * self.pairs)).cos();
            f64::midpoint((1.0 + edge_cosine) * ripple, edge_cosine - 1.0)
        });
        let one: Vec<f64> = one.collect();
        one.repeat(self.series as usize)
    }

    /// Amplitudes of the pairs convolved; `ratio` is `K`.
    fn amplitudes(&self, cosines: &[f64], ratio: f64) -> Vec<f64> {
        let mut amplitudes = vec![1.0];
        for cosine in cosines {
            let pair = [1.0, -2.0 * cosine * ratio, ratio * ratio];
            let sum: f64 = pair.iter().sum();
            let mut next = vec![0.0; amplitudes.len() + 2];
            for (index, amplitude) in amplitudes.iter().enumerate() {
                for (offset, weight) in pair.iter().enumerate() {
                    next[index + offset] += amplitude * weight / sum;
                }
            }
            amplitudes = next;
        }
        amplitudes
    }

    /// Largest damping ratio at which the tolerance can be reached: `K^{2n} = tolerance/(2 − tolerance)` for one
    /// factor.
    fn largest_damping(&self) -> f64 {
        let power = self.factor_tolerance / (2.0 - self.factor_tolerance);
        let decrement = -power.ln() / f64::from(2 * self.pairs) / PI;
        decrement / (1.0 + decrement * decrement).sqrt()
    }

    /// Largest tolerance for which a solution exists at this damping.
    fn largest_tolerance(&self, ratio: f64) -> f64 {
        let power = ratio.powi(2 * self.pairs as i32);
        (2.0 * power / (1.0 + power)).powi(self.series as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;

    const KINDS: [(ShaperKind, u32); 9] = [
        (ShaperKind::ZvEi, 1),
        (ShaperKind::ZvEi2, 1),
        (ShaperKind::ZvdEi, 1),
        (ShaperKind::MultiEi, 1),
        (ShaperKind::ChebyshevEi, 1),
        (ShaperKind::ChebyshevEi, 2),
        (ShaperKind::ChebyshevEi, 3),
        (ShaperKind::ChebyshevEi, 4),
        (ShaperKind::ChebyshevEi, 5),
    ];

    fn mode(damping: f64) -> Mode {
        Mode {
            frequency_hz: 3.0,
            damping,
        }
    }

    #[test]
    fn closed_forms_of_the_paper() {
        let v = 0.05f64;
        let zv_ei = undamped(ShaperKind::ZvEi, 1, v).unwrap();
        for (found, expected) in zv_ei.amplitudes.iter().zip([0.2625, 0.475, 0.2625]) {
            assert!((found - expected).abs() < 1e-15);
        }
        let root = (2.0 * (v * v + v)).sqrt();
        let first = (1.0 + 3.0 * v + 2.0 * root) / 16.0;
        let second = (1.0 - v) / 4.0;
        let multi = undamped(ShaperKind::MultiEi, 1, v).unwrap();
        for (found, expected) in multi
            .amplitudes
            .iter()
            .zip([first, second, 1.0 - 2.0 * (first + second)])
        {
            assert!((found - expected).abs() < 1e-15);
        }
        assert_eq!(multi, undamped(ShaperKind::ChebyshevEi, 2, v).unwrap());
    }

    #[test]
    fn the_largest_damping_is_where_the_design_ends() {
        // The limits at 5 %, found independently.
        let known = [0.50, 0.31, 0.18, 0.28, 0.50, 0.28, 0.19, 0.144, 0.12];
        for ((kind, order), known) in KINDS.into_iter().zip(known) {
            let Err(DesignError::NoSolution {
                largest_damping,
                largest_tolerance,
                ..
            }) = design(kind, order, &mode(0.6), 0.05)
            else {
                panic!("no {kind} leaves 5 % at damping 0.6");
            };
            assert!(
                (largest_damping - known).abs() < 0.0051,
                "{kind} {order}: {largest_damping}"
            );
            let largest_tolerance = largest_tolerance.unwrap();
            for (damping, tolerance) in [(largest_damping, 0.05), (0.6, largest_tolerance)] {
                let near = |share: f64| design(kind, order, &mode(damping), tolerance * share);
                let impulses = near(1.0 - 1e-9).unwrap();
                let residual = residual_vibration(impulses.impulses(), &mode(damping));
                assert!((residual - tolerance).abs() < 2e-9 * tolerance, "{kind} {order}");
                assert!(near(1.0 + 1e-9).is_err(), "{kind} {order}");
            }
        }
    }

    #[test]
    fn amplitudes_are_positive_at_every_tolerance() {
        for (kind, order) in KINDS {
            for percent in 1..100 {
                let base = undamped(kind, order, f64::from(percent) / 100.0).unwrap();
                assert!(base.amplitudes.iter().all(|a| *a > 0.0), "{kind} {order} {percent}");
            }
        }
    }

    #[test]
    fn what_the_family_does_not_have_is_an_error() {
        for (kind, order, tolerance) in [
            (ShaperKind::Zv, 1, 0.05),
            (ShaperKind::ChebyshevEi, 0, 0.05),
            (ShaperKind::ChebyshevEi, 6, 0.05),
            (ShaperKind::ZvEi, 1, 0.0),
            (ShaperKind::ZvEi, 1, 1.0),
            (ShaperKind::ZvEi, 1, f64::NAN),
            (ShaperKind::ZvEi, 1, f64::INFINITY),
        ] {
            assert!(matches!(
                undamped(kind, order, tolerance),
                Err(DesignError::BiasPoint { .. })
            ));
            assert!(matches!(
                design(kind, order, &mode(0.1), tolerance),
                Err(DesignError::BiasPoint { .. })
            ));
        }
        // Damping ratios at which K, or tolerances at which 1/V, cannot be represented in f64.
        assert!(design(ShaperKind::ZvEi, 1, &mode(1.0 - 1e-16), 0.05).is_err());
        assert!(design(ShaperKind::ChebyshevEi, 5, &mode(0.9), 1e-300).is_ok());
    }
}
