//! The residual vibration over a band of frequencies: its largest value, and its map over frequency and damping.

use super::residual::{last_time_s, residual_vibration};
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// Evaluations of the residual in the ratio step in which two impulses turn once against each other.
const LOOKS_PER_TURN: f64 = 24.0;
/// Smallest and largest number of evaluations in a band.
const LOOKS: (f64, f64) = (64.0, 2e5);
/// Rounds of the golden section search: each shrinks the interval to 0.618, and 40 shrink it to rounding.
const ROUNDS: usize = 40;

/// Largest residual vibration while the mode's frequency is off by at most `band` (0.1: ±10 %) in either direction,
/// with the damping fixed. A band that reaches below 0 Hz ends there.
///
/// The residual is evaluated far more often than it can oscillate, and the highest value is refined to rounding.
pub fn worst_residual(impulses: &[Impulse], mode: &Mode, band: f64) -> f64 {
    worst(
        last_time_s(impulses),
        |mode| residual_vibration(impulses, mode),
        mode,
        band,
    )
}

/// The same for the convolution of some shapers. Its residual is the product of theirs, and a convolution of many has too many impulses to
/// sum them for each frequency.
pub fn worst_residual_of_convolution(factors: &[ImpulseSequence], mode: &Mode, band: f64) -> f64 {
    let residual = |mode: &Mode| -> f64 {
        let of_each = factors.iter().map(|factor| residual_vibration(factor.impulses(), mode));
        of_each.product()
    };
    let duration_s = factors.iter().map(|factor| last_time_s(factor.impulses())).sum();
    worst(duration_s, residual, mode, band)
}

/// Largest residual in a band of a shaper of this duration.
fn worst(duration_s: f64, residual: impl Fn(&Mode) -> f64, mode: &Mode, band: f64) -> f64 {
    let at = |ratio: f64| residual(&mode.scaled(ratio));
    let (low, high) = ((1.0 - band).max(0.0), 1.0 + band);
    let turns = duration_s * mode.frequency_hz * (high - low);
    let looks = (LOOKS_PER_TURN * turns).ceil().clamp(LOOKS.0, LOOKS.1);
    let step = (high - low) / looks;
    let (mut best, mut most) = (1.0, at(1.0));
    for look in 0..=looks as u32 {
        let ratio = low + step * f64::from(look);
        let value = at(ratio);
        if value > most {
            (best, most) = (ratio, value);
        }
    }
    let (mut from, mut to) = ((best - step).max(low), (best + step).min(high));
    let golden = (5.0f64.sqrt() - 1.0) / 2.0;
    for _ in 0..ROUNDS {
        let width = golden * (to - from);
        if at(to - width) > at(from + width) {
            to = from + width;
        } else {
            from = to - width;
        }
    }
    most.max(at(f64::midpoint(from, to)))
}

/// Map of the residual vibration over frequency and damping.
#[derive(Debug, Clone, PartialEq)]
pub struct SensitivityGrid {
    /// Frequency ratios `f/f_0` of the columns.
    pub ratios: Vec<f64>,
    /// Damping ratios of the rows.
    pub dampings: Vec<f64>,
    /// Residual vibration as `residual[row][column]`.
    pub residual: Vec<Vec<f64>>,
}

/// Residual vibration on a grid of `points.0` frequency ratios and `points.1` dampings, equally spaced in their ranges, ends
/// included. Dampings must lie in [0, 1).
pub fn sensitivity_grid(
    impulses: &[Impulse],
    mode: &Mode,
    ratios: (f64, f64),
    dampings: (f64, f64),
    points: (usize, usize),
) -> SensitivityGrid {
    let (ratios, dampings) = (spaced(ratios, points.0), spaced(dampings, points.1));
    let row = |damping: f64| {
        let mode = Mode { damping, ..*mode };
        let columns = ratios.iter();
        columns
            .map(|r| residual_vibration(impulses, &mode.scaled(*r)))
            .collect()
    };
    SensitivityGrid {
        residual: dampings.iter().map(|d| row(*d)).collect(),
        ratios,
        dampings,
    }
}

fn spaced((low, high): (f64, f64), points: usize) -> Vec<f64> {
    let intervals = points.saturating_sub(1).max(1) as f64;
    (0..points)
        .map(|point| low + (high - low) * point as f64 / intervals)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODE: Mode = Mode {
        frequency_hz: 3.0,
        damping: 0.0,
    };

    fn impulses(pairs: &[(f64, f64)]) -> Vec<Impulse> {
        pairs
            .iter()
            .map(|&(time_s, amplitude)| Impulse { time_s, amplitude })
            .collect()
    }

    #[test]
    fn zv_is_worst_at_the_edge_of_its_band() {
        let zv = impulses(&[(0.0, 0.5), (1.0 / 6.0, 0.5)]);
        let edge = (std::f64::consts::FRAC_PI_2 * 0.1).sin();
        assert!((worst_residual(&zv, &MODE, 0.1) - edge).abs() < 1e-14);
        // At 0 Hz nothing is shaped; a band of 100 % or more reaches it.
        assert!((worst_residual(&zv, &MODE, 3.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_hump_within_the_band_is_found() {
        // The EI's hump, 5 %, is at the mode itself; ±15 % does not reach the level again.
        let ei = impulses(&[(0.0, 0.2625), (1.0 / 6.0, 0.475), (1.0 / 3.0, 0.2625)]);
        assert!((worst_residual(&ei, &MODE, 0.15) - 0.05).abs() < 1e-14);
        let far = impulses(&[(0.0, 0.5), (50.0 / 3.0 + 1.0 / 6.0, 0.5)]);
        assert!(
            (worst_residual(&far, &MODE, 0.1) - 1.0).abs() < 1e-12,
            "a long sequence turns often"
        );
    }

    #[test]
    fn the_residual_of_a_convolution_is_that_of_its_impulses() {
        let zv = impulses(&[(0.0, 0.55), (1.0 / 6.0, 0.45)]);
        let ei = impulses(&[(0.0, 0.28), (0.11, 0.48), (0.23, 0.24)]);
        let factors = [zv, ei].map(|list| ImpulseSequence::new(list).unwrap());
        let all = factors[0].convolve(&factors[1]).unwrap();
        for damping in [0.0, 0.03, 0.6] {
            for band in [0.0, 0.1, 0.9] {
                let mode = Mode { damping, ..MODE };
                let (of_factors, of_all) = (
                    worst_residual_of_convolution(&factors, &mode, band),
                    worst_residual(all.impulses(), &mode, band),
                );
                assert!(
                    (of_factors - of_all).abs() < 1e-12,
                    "damping ratio {damping}, band {band}: {of_factors} and {of_all}"
                );
            }
        }
    }

    #[test]
    fn the_grid_holds_the_residual() {
        let zv = impulses(&[(0.0, 0.5), (1.0 / 6.0, 0.5)]);
        let grid = sensitivity_grid(&zv, &MODE, (0.5, 1.5), (0.0, 0.2), (11, 3));
        assert_eq!((grid.residual.len(), grid.residual[0].len()), (3, 11));
        let mode = Mode {
            frequency_hz: 3.0 * grid.ratios[7],
            damping: grid.dampings[2],
        };
        assert_eq!(grid.residual[2][7], residual_vibration(&zv, &mode));
    }
}
