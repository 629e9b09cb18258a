//! Equations (2-1) to (2-4) of the XY stage: a second-order model from samples, by least squares.
//!
//! ```text
//! y(k) = −a_1·y(k−1) − a_2·y(k−2) + b_1·u(k−1) + b_2·u(k−2)
//! p = root of z² + a_1·z + a_2,    s = ln(p)/T,    ω = |s|,    ζ = −Re s/|s|
//! ```
//!
//! The samples are those of the plant itself under a pseudo-random command; without noise the model must be exact.

use nalgebra::{Complex, Matrix4, Vector4};
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;

/// Sample period in seconds.
const SAMPLE_S: f64 = 0.5e-3;
/// Number of samples: one period of the pseudo-random command.
const SAMPLES: usize = 1023;

/// Returns one period of a maximum-length sequence of ±1, by `x^10 + x^7 + 1`.
fn pseudo_random() -> Vec<f64> {
    let mut register = 1u32;
    (0..SAMPLES)
        .map(|_| {
            let bit = (register >> 9 ^ register >> 6) & 1;
            register = (register << 1 | bit) & 0x3ff;
            if bit == 1 { 1.0 } else { -1.0 }
        })
        .collect()
}

/// Returns the coefficients `[a_1, a_2, b_1, b_2]` that fit the plant's samples best.
fn coefficients(plant: &Plant) -> Vector4<f64> {
    let mut sampled = SampledPlant::new(plant, SAMPLE_S, 0.0);
    let command = pseudo_random();
    // y(k) is the position before the command u(k) acts.
    let positions: Vec<f64> = std::iter::once(0.0)
        .chain(command.iter().map(|u| sampled.step(*u)))
        .collect();
    let (mut square, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for k in 2..positions.len() {
        let row = Vector4::new(-positions[k - 1], -positions[k - 2], command[k - 1], command[k - 2]);
        square += row * row.transpose();
        right += row * positions[k];
    }
    square.lu().solve(&right).unwrap_or_else(|| Vector4::repeat(f64::NAN))
}

/// Returns the mode of the model that least squares finds in the samples of a plant with one mode.
pub(super) fn identify(plant: &Plant) -> Mode {
    let found = coefficients(plant);
    let half = -found[0] / 2.0;
    let root = Complex::new(half, 0.0) + Complex::new(half * half - found[1], 0.0).sqrt();
    let pole = root.ln() / SAMPLE_S;
    Mode {
        frequency_hz: pole.norm() / TAU,
        damping: -pole.re / pole.norm(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::PLANTS;

    #[test]
    fn golden_coefficients_of_both_plants() {
        // The expected values are the zero-order hold of Gx and Gy at 0.5 ms, derived elsewhere.
        let expected = [
            [
                -1.721_222_944_760_167,
                0.878_095_430_920_561_3,
                0.080_144_879_108_171_59,
                0.076_727_607_052_222_48,
            ],
            [
                -1.832_374_278_501_373_5,
                0.913_931_185_271_228,
                0.041_391_803_666_882_11,
                0.040_165_103_102_972_61,
            ],
        ];
        for (plant, expected) in PLANTS.iter().zip(expected) {
            let found = coefficients(&plant.plant());
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }
}
