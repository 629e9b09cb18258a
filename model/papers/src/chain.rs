//! Modes in series, `∏ ω_i²/(s² + 2ζ_i ω_i s + ω_i²)`, as in the four-mode example of Zhang and Li.
//!
//! The step response is one plus a decaying oscillation per mode, whose complex amplitudes are the residues at the
//! poles.

use nalgebra::Complex;
use posicast_shaper::impulse::Impulse;
use posicast_shaper::mode::Mode;

/// Modes in series, with different poles.
pub(super) struct Chain {
    /// Per mode, the pole `−σ + jω_d` and the residue of the unit step response.
    modes: Vec<(Complex<f64>, Complex<f64>)>,
}

impl Chain {
    /// Creates the chain of these modes.
    pub(super) fn new(modes: &[Mode]) -> Self {
        let pole = |mode: &Mode| Complex::new(-mode.decay(), mode.omega_damped());
        let with_residue = modes.iter().enumerate().map(|(index, mode)| {
            let at = pole(mode);
            // G(s)/s without the factor (s − pole): ω²/((s − pole)(s − pole*)) for this mode, the whole factor for
            // the others.
            let own = Complex::from(mode.omega().powi(2)) / (at * (at - at.conj()));
            let others = modes.iter().enumerate().filter(|(other, _)| *other != index);
            let residue = others.fold(own, |product, (_, other)| {
                product * other.omega().powi(2) / ((at - pole(other)) * (at - pole(other).conj()))
            });
            (at, residue)
        });
        Self {
            modes: with_residue.collect(),
        }
    }

    /// Returns the position minus the step, as a fraction of the step, at a time after the last impulse.
    pub(super) fn vibration(&self, impulses: &[Impulse], time_s: f64) -> f64 {
        let modes = self.modes.iter().map(|(pole, residue)| {
            let terms = impulses
                .iter()
                .map(|i| (pole * (time_s - i.time_s)).exp() * i.amplitude);
            2.0 * (residue * terms.sum::<Complex<f64>>()).re
        });
        modes.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_mode_has_its_step_response() {
        let mode = Mode {
            frequency_hz: 2.0,
            damping: 0.1,
        };
        let step = [Impulse {
            time_s: 0.0,
            amplitude: 1.0,
        }];
        for time_s in [0.0, 0.1, 0.3, 1.0] {
            let (sin, cos) = (mode.omega_damped() * time_s).sin_cos();
            let expected = -(-mode.decay() * time_s).exp() * (cos + mode.decay() / mode.omega_damped() * sin);
            assert!((Chain::new(&[mode]).vibration(&step, time_s) - expected).abs() < 1e-14);
        }
    }
}
