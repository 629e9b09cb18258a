//! Ringing of an axis after a jump of the acceleration.
//!
//! A jump of the acceleration by `a` moves the rest position of a mode with the share `p` of the tool's motion by `p·a/ω²`, which is the
//! amplitude of its ringing. A shaper leaves `V` of that, so the axis keeps
//!
//! ```text
//! Σ p_i/ω_i² · V_i  /  Σ p_i/ω_i²        V_i: the worst while the mode's frequency is off by up to the band
//! ```
//!
//! of its ringing, for any `a`. A low mode counts far more than its share suggests: with the same share, a mode at half the frequency
//! rings four times as far.

use super::worst_residual;
use crate::impulse::Impulse;
use crate::mode::Mode;

/// A mode of an axis, with its share in the motion of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedMode {
    /// The mode.
    pub mode: Mode,
    /// Its share; only ratios between the modes of an axis matter.
    pub participation: f64,
}

impl WeightedMode {
    /// Amplitude of the mode's ringing after a jump of the acceleration by 1, up to the axis's unit.
    pub fn ringing(&self) -> f64 {
        self.participation / self.mode.omega().powi(2)
    }
}

/// Fraction of the axis's ringing after a jump of the acceleration that a shaper leaves: 0 to 1 for positive impulses. Each mode's
/// frequency may be off by `band` (0.05: ±5 %). The result is 0 without modes, and if no mode participates.
pub fn ringing_left(impulses: &[Impulse], modes: &[WeightedMode], band: f64) -> f64 {
    left(modes, |mode| worst_residual(impulses, mode, band))
}

/// As [`ringing_left`], for any measure of a mode's residual.
pub fn left(modes: &[WeightedMode], residual: impl Fn(&Mode) -> f64) -> f64 {
    let whole: f64 = modes.iter().map(WeightedMode::ringing).sum();
    if whole == 0.0 {
        return 0.0;
    }
    let rest: f64 = modes.iter().map(|mode| mode.ringing() * residual(&mode.mode)).sum();
    rest / whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_counts_by_its_share_over_the_square_of_its_frequency() {
        let weighted = |frequency_hz, participation| WeightedMode {
            mode: Mode {
                frequency_hz,
                damping: 0.0,
            },
            participation,
        };
        // Half a period of 20 Hz removes all of 20 Hz and leaves all of 40 Hz, which has a fifth of the ringing at equal shares.
        let half = |time_s| Impulse { time_s, amplitude: 0.5 };
        let zv = [half(0.0), half(0.025)];
        let left = ringing_left(&zv, &[weighted(20.0, 1.0), weighted(40.0, 1.0)], 0.0);
        assert!((left - 0.25 / 1.25).abs() < 1e-9, "{left}");
        let left = ringing_left(&zv, &[weighted(20.0, 0.0), weighted(40.0, 2.0)], 0.0);
        assert!((left - 1.0).abs() < 1e-9, "{left}");
        assert_eq!(ringing_left(&zv, &[], 0.05), 0.0);
    }
}
