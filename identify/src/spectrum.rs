//! Fourier transforms of real signals.

use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::TAU;
use std::sync::Arc;

/// An even number of samples not below `samples` whose transform is fast: a product of 2, 3 and 5.
pub fn fast_length(samples: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    let mut length = samples.max(2).next_multiple_of(2);
    while !smooth(length) {
        length += 2;
    }
    length
}

/// Transforms of one length.
#[derive(Clone)]
pub struct Transform {
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    length: usize,
}

impl Transform {
    /// Transforms of `length` samples.
    pub fn new(length: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        Self {
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
            length,
        }
    }

    /// The lines 0 to `length/2` of a signal that is padded with zeros: `X_k = Σ x_n e^{−j2πkn/length}`.
    pub fn forward(&self, mut signal: Vec<f64>) -> Vec<Complex<f64>> {
        signal.resize(self.length, 0.0);
        let mut lines = self.forward.make_output_vec();
        // Both lengths are those of the plan, so this cannot fail.
        let _ = self.forward.process(&mut signal, &mut lines);
        lines
    }

    /// The signal with these lines, not divided by the length.
    pub fn inverse(&self, mut lines: Vec<Complex<f64>>) -> Vec<f64> {
        lines.resize(self.length / 2 + 1, Complex::new(0.0, 0.0));
        // The first and the last line of a real signal are real.
        lines[0].im = 0.0;
        lines[self.length / 2].im = 0.0;
        let mut signal = self.inverse.make_output_vec();
        let _ = self.inverse.process(&mut lines, &mut signal);
        signal
    }
}

/// A power spectral density.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerSpectrum {
    /// Distance of the lines in Hz.
    pub resolution_hz: f64,
    /// One-sided density of each line from 0 Hz on, in unit² per Hz.
    pub density: Vec<f64>,
    /// Number of segments that were averaged.
    pub segments: usize,
}

impl PowerSpectrum {
    /// Frequency of a line in Hz.
    pub fn frequency_hz(&self, line: usize) -> f64 {
        line as f64 * self.resolution_hz
    }
}

/// Welch's average of segments that overlap by half, with a Hann window and with the mean of each removed (Welch
/// 1967). A signal shorter than a segment is one segment.
pub fn welch(signal: &[f64], sample_s: f64, segment: usize) -> PowerSpectrum {
    let segment = segment.min(signal.len()).max(2) & !1;
    let window: Vec<f64> = (0..segment)
        .map(|n| 0.5 - 0.5 * (TAU * n as f64 / segment as f64).cos())
        .collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let transform = Transform::new(segment);
    let mut density = vec![0.0; segment / 2 + 1];
    let mut segments = 0;
    let mut begin = 0;
    while begin + segment <= signal.len() {
        let part = &signal[begin..begin + segment];
        let mean = part.iter().sum::<f64>() / segment as f64;
        let windowed: Vec<f64> = part.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
        for (sum, line) in density.iter_mut().zip(transform.forward(windowed)) {
            *sum += line.norm_sqr();
        }
        segments += 1;
        begin += segment / 2;
    }
    let scale = 2.0 * sample_s / (power * f64::from(segments.max(1)));
    for value in &mut density {
        *value *= scale;
    }
    PowerSpectrum {
        resolution_hz: 1.0 / (segment as f64 * sample_s),
        density,
        segments: segments as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_its_power_at_its_frequency() {
        let sample_s = 1e-3;
        let sine: Vec<f64> = (0..20_000)
            .map(|n| 3.0 * (TAU * 50.0 * n as f64 * sample_s).sin() + 7.0)
            .collect();
        let spectrum = welch(&sine, sample_s, 2000);
        let power: f64 = spectrum.density.iter().sum::<f64>() * spectrum.resolution_hz;
        assert!((power - 4.5).abs() < 1e-3, "{power}");
        let peak = (0..spectrum.density.len()).max_by(|a, b| spectrum.density[*a].total_cmp(&spectrum.density[*b]));
        assert!((spectrum.frequency_hz(peak.unwrap()) - 50.0).abs() < 1e-9);
        assert_eq!(spectrum.segments, 19);
    }

    #[test]
    fn fast_lengths_are_products_of_small_primes() {
        assert_eq!([7, 416_000, 419_431].map(fast_length), [8, 419_904, 419_904]);
    }

    #[test]
    fn inverse_of_the_transform_is_the_signal() {
        let signal: Vec<f64> = (0..30).map(|n| f64::from(n * n % 7)).collect();
        let transform = Transform::new(30);
        let lines = transform.forward(signal.clone());
        for (back, there) in transform.inverse(lines).iter().zip(&signal) {
            assert!((back / 30.0 - there).abs() < 1e-12);
        }
    }
}
