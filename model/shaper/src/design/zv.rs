//! Zero-vibration shapers: `zv`, its powers `zvd`, `zvdd`, `zvddd`, and `mzv`, which lies between the first two.
//!
//! ```text
//! K = e^{−ζπ/√(1−ζ²)}        one factor: amplitudes [1, K]/(1 + K) at 0, T_d/2
//! m factors:                 A_k = C(m, k)·K^k / (1 + K)^m at k·T_d/2,  k = 0…m
//! ```
//!
//! The second impulse excites the mode half a swing late, with the amplitude that damping has left of the first, so
//! that the two cancel (Smith's posicast, 1957; Singer and Seering 1990). Each further factor makes one more
//! derivative of the residual zero at the mode, costs another half period of delay, and allows a larger error of the
//! frequency. The shapers exist for every damping ratio in [0, 1).
//!
//! `mzv`, known from 3D printers, has three impulses 3/8 of a period apart instead of 1/2; its length and
//! insensitivity lie between those of `zv` and `zvd`. With `k = e^{−0.75ζπ/√(1−ζ²)}`, which damping leaves of a swing
//! in that time,
//!
//! ```text
//! mzv:  amplitudes ∝ [1 − 1/√2, (√2 − 1)·k, (1 − 1/√2)·k²] at 0, ⅜T_d, ¾T_d
//! ```

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::DesignError;
use super::kind::{Design, KindRow, Promise, ShaperKind};
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `zv`.
pub(super) const ZV: KindRow = KindRow::new(
    "zv",
    Promise::Zero,
    Design::Mode(|kind, mode, _| design(kind, mode, 1)),
    "no residual at the mode; the shortest with positive impulses",
)
.source("Smith 1957");

/// `zvd`.
pub(super) const ZVD: KindRow = KindRow::new(
    "zvd",
    Promise::Zero,
    Design::Mode(|kind, mode, _| design(kind, mode, 2)),
    "two `zv` in series: longer, less sensitive to a wrong frequency",
)
.source("Singer and Seering 1990");

/// `zvdd`.
pub(super) const ZVDD: KindRow = KindRow::new(
    "zvdd",
    Promise::Zero,
    Design::Mode(|kind, mode, _| design(kind, mode, 3)),
    "three `zv` in series",
)
.source("Singer and Seering 1990");

/// `zvddd`.
pub(super) const ZVDDD: KindRow = KindRow::new(
    "zvddd",
    Promise::Zero,
    Design::Mode(|kind, mode, _| design(kind, mode, 4)),
    "four `zv` in series",
)
.source("Singer and Seering 1990");

/// `mzv`.
pub(super) const MZV: KindRow = KindRow::new(
    "mzv",
    Promise::Zero,
    Design::Mode(|_, mode, _| design_mzv(mode)),
    "no residual at the mode, between `zv` and `zvd`, as in 3D printers",
);

/// Designs `factors` ZV factors in series, 1 (`zv`) to 4 (`zvddd`); `kind` is used in messages only.
///
/// # Errors
/// [`DesignError::Mode`] for an invalid mode, [`DesignError::NoSequence`] where times leave the range of `f64`.
pub fn design(kind: ShaperKind, mode: &Mode, factors: u32) -> Result<ImpulseSequence, DesignError> {
    DesignError::check_mode(mode)?;
    let weights = binomial_weights(factors, mode.half_swing_ratio());
    evenly_spaced(kind, mode, &weights, mode.damped_period_s() / 2.0)
}

/// Designs an `mzv` shaper.
///
/// # Errors
/// Those of [`design`].
pub fn design_mzv(mode: &Mode) -> Result<ImpulseSequence, DesignError> {
    DesignError::check_mode(mode)?;
    let ratio = mode.half_swing_ratio().powf(0.75);
    let outer = 1.0 - FRAC_1_SQRT_2;
    let weights = [outer, (SQRT_2 - 1.0) * ratio, outer * ratio * ratio];
    evenly_spaced(ShaperKind::Mzv, mode, &weights, 0.375 * mode.damped_period_s())
}

/// Impulses `spacing_s` apart with amplitudes in proportion to `weights`.
fn evenly_spaced(
    kind: ShaperKind,
    mode: &Mode,
    weights: &[f64],
    spacing_s: f64,
) -> Result<ImpulseSequence, DesignError> {
    let sum: f64 = weights.iter().sum();
    let impulses = weights.iter().enumerate().map(|(index, weight)| Impulse {
        time_s: index as f64 * spacing_s,
        amplitude: weight / sum,
    });
    ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::no_sequence(kind, mode, cause))
}

/// Coefficients of `(1 + ratio·x)^factors`.
fn binomial_weights(factors: u32, ratio: f64) -> Vec<f64> {
    let mut weights = vec![1.0];
    for _ in 0..factors {
        let mut next = vec![0.0; weights.len() + 1];
        for (index, weight) in weights.iter().enumerate() {
            next[index] += weight;
            next[index + 1] += weight * ratio;
        }
        weights = next;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undamped_amplitudes_are_binomial() {
        let mode = Mode {
            frequency_hz: 2.0,
            damping: 0.0,
        };
        let zvddd = design(ShaperKind::Zvddd, &mode, 4).unwrap();
        let amplitudes: Vec<f64> = zvddd.impulses().iter().map(|i| i.amplitude * 16.0).collect();
        assert_eq!(amplitudes, [1.0, 4.0, 6.0, 4.0, 1.0]);
        assert_eq!(zvddd.duration_s(), 1.0);
    }

    #[test]
    fn invalid_modes_are_errors() {
        for (frequency_hz, damping) in [
            (0.0, 0.1),
            (-1.0, 0.1),
            (f64::NAN, 0.1),
            (f64::INFINITY, 0.1),
            (1.0, 1.0),
            (1.0, -0.1),
            (1.0, f64::NAN),
        ] {
            let mode = Mode { frequency_hz, damping };
            assert!(matches!(
                design(ShaperKind::Zv, &mode, 1),
                Err(DesignError::Mode { .. })
            ));
        }
        // Valid frequencies whose period cannot be represented in f64.
        for frequency_hz in [f64::MAX, f64::MIN_POSITIVE / 1e10] {
            let mode = Mode {
                frequency_hz,
                damping: 0.0,
            };
            assert!(matches!(
                design(ShaperKind::Zv, &mode, 1),
                Err(DesignError::NoSequence { .. })
            ));
        }
    }
}
