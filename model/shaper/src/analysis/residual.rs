//! Residual vibration `V(ω, ζ) = e^{−ζω t_n} · |Σ A_i e^{(ζω + jω_d) t_i}|`.
//!
//! In words: the amplitude that remains after the last impulse, as a fraction of what the same command would have
//! left unshaped, measured at its own start (Singer and Seering 1990). 0 means that the mode is at rest, 1 that the
//! shaper had no effect. It is exact for impulses and for steps.
//!
//! `e^{ζω t_n}` overflows for long sequences. The decay is therefore factored into the sum, where every exponent is
//! at most 0.

use nalgebra::Complex;

use crate::impulse::Impulse;
use crate::mode::Mode;
use posicast_taps::TapTable;

/// The pole sum referred to a time, `Σ A_i e^{ζω(t_i − reference) + jω_d t_i}`, for impulses in any order.
pub fn pole_sum(impulses: &[Impulse], mode: &Mode, reference_s: f64) -> Complex<f64> {
    let (decay, omega_damped) = (mode.decay(), mode.omega_damped());
    impulses
        .iter()
        .map(|i| {
            Complex::from_polar(
                i.amplitude * growth(decay, i.time_s - reference_s),
                omega_damped * i.time_s,
            )
        })
        .sum()
}

/// `e^{decay · time}`; without damping exactly 1, even for a time out of all proportion.
fn growth(decay: f64, time_s: f64) -> f64 {
    if decay == 0.0 { 1.0 } else { (decay * time_s).exp() }
}

/// Residual vibration at a mode, as a fraction of the unshaped vibration: 0 for a perfect shaper, 1 for one without
/// effect.
///
/// `t_n` is the time of the last impulse that is not zero. Without impulses there is no motion, and the result is 0.
pub fn residual_vibration(impulses: &[Impulse], mode: &Mode) -> f64 {
    residual_vibration_at(impulses, mode, last_time_s(impulses))
}

/// Residual vibration referred to `reference_s` instead of the last impulse. It serves to compare two tables if one
/// ends earlier because a coefficient was rounded to zero.
pub fn residual_vibration_at(impulses: &[Impulse], mode: &Mode, reference_s: f64) -> f64 {
    pole_sum(impulses, mode, reference_s).norm()
}

/// Time of the last impulse that is not zero, in seconds.
pub(super) fn last_time_s(impulses: &[Impulse]) -> f64 {
    let nonzero = impulses.iter().filter(|i| i.amplitude != 0.0);
    nonzero.map(|i| i.time_s).fold(0.0, f64::max)
}

/// The impulses that an integer table stands for: `A_i = c_i / 2^F` at `t_i = delay_samples / sample_hz`.
pub fn tap_impulses(table: &TapTable, sample_hz: f64) -> Vec<Impulse> {
    let unity = f64::from(1u32 << table.coefficient_fraction());
    let taps = table.taps().iter();
    taps.map(|tap| Impulse {
        time_s: f64::from(tap.delay_samples) / sample_hz,
        amplitude: f64::from(tap.coefficient) / unity,
    })
    .collect()
}

/// Sensitivity curve: `(f/f_0, V)` at `points` equally spaced frequency ratios from `low` to `high`, damping fixed.
pub fn sensitivity_curve(impulses: &[Impulse], mode: &Mode, low: f64, high: f64, points: usize) -> Vec<(f64, f64)> {
    let intervals = points.saturating_sub(1).max(1) as f64;
    (0..points)
        .map(|point| {
            let ratio = low + (high - low) * point as f64 / intervals;
            (ratio, residual_vibration(impulses, &mode.scaled(ratio)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn impulses(pairs: &[(f64, f64)]) -> Vec<Impulse> {
        pairs
            .iter()
            .map(|&(time_s, amplitude)| Impulse { time_s, amplitude })
            .collect()
    }

    #[test]
    fn a_single_impulse_leaves_everything() {
        let mode = Mode {
            frequency_hz: 3.0,
            damping: 0.2,
        };
        assert_eq!(residual_vibration(&impulses(&[(0.0, 1.0)]), &mode), 1.0);
    }

    #[test]
    fn long_sequences_neither_overflow_nor_lose_the_last_impulse() {
        let mode = Mode {
            frequency_hz: 1e6,
            damping: 0.5,
        };
        // ζω t_n is 3e9, and e to that power is beyond f64. Only the last impulse still rings.
        let residual = residual_vibration(&impulses(&[(0.0, 0.75), (1000.0, 0.25)]), &mode);
        assert_eq!(residual, 0.25);
    }

    #[test]
    fn a_zero_impulse_does_not_move_the_end() {
        let mode = Mode {
            frequency_hz: 1.0,
            damping: 0.1,
        };
        let short = residual_vibration(&impulses(&[(0.0, 0.5), (0.3, 0.5)]), &mode);
        let padded = residual_vibration(&impulses(&[(0.0, 0.5), (0.3, 0.5), (9.0, 0.0)]), &mode);
        assert_eq!(short, padded);
    }

    #[test]
    fn sensitivity_curve_spans_its_range() {
        let mode = Mode {
            frequency_hz: 1.0,
            damping: 0.0,
        };
        let zv = impulses(&[(0.0, 0.5), (0.5, 0.5)]);
        let curve = sensitivity_curve(&zv, &mode, 0.5, 1.5, 3);
        assert_eq!(curve.len(), 3);
        assert_eq!((curve[0].0, curve[2].0), (0.5, 1.5));
        assert!(curve[1].1 < 1e-15);
        assert!((curve[0].1 - 0.5f64.sqrt()).abs() < 1e-15);
        assert!(sensitivity_curve(&zv, &mode, 0.5, 1.5, 0).is_empty());
    }
}
