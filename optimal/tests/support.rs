//! Requests, and the residual by its definition.

use posicast_optimal::{Band, Command, Prefer, Request};
use std::f64::consts::TAU;

/// Modes of frequencies in Hz and damping ratios, off by up to `width` to either side.
pub(crate) fn request(sample_hz: f64, modes: &[(f64, f64)], tolerance: f64, width: f64) -> Request {
    let band = |&(frequency_hz, damping): &(f64, f64)| Band {
        frequency_hz: [frequency_hz * (1.0 - width), frequency_hz * (1.0 + width)],
        damping: [damping; 2],
        tolerance,
    };
    Request {
        sample_hz,
        bands: modes.iter().map(band).collect(),
        command: Command::Positive,
        prefer: Prefer::default(),
        most_taps: 256,
        longest_samples: 16_382,
        delay_samples: None,
    }
}

/// Partial sums within −1 … 1.
pub(crate) const SIGNED: Command = Command::PartialSums { low: -1.0, high: 1.0 };

/// The modes of the robot with two modes.
pub(crate) const TWO_MODES: [(f64, f64); 2] = [(76.6, 0.057), (231.2, 0.017)];

/// Undamped modes of 10, 35, 68 and 124 rad/s.
pub(crate) fn four_modes() -> [(f64, f64); 4] {
    [10.0, 35.0, 68.0, 124.0].map(|omega| (omega / TAU, 0.0))
}

/// `V` by its definition, sine and cosine sums apart, at the time of the last tap.
pub(crate) fn residual(taps: &[(u32, f64)], frequency_hz: f64, damping: f64, sample_hz: f64) -> f64 {
    let omega = TAU * frequency_hz;
    let end_s = f64::from(taps.last().unwrap().0) / sample_hz;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for &(sample, amplitude) in taps {
        let time_s = f64::from(sample) / sample_hz;
        let size = amplitude * (damping * omega * time_s).exp();
        let phase = omega * (1.0 - damping * damping).sqrt() * time_s;
        sine += size * phase.sin();
        cosine += size * phase.cos();
    }
    (-damping * omega * end_s).exp() * sine.hypot(cosine)
}

/// Largest ratio of residual to tolerance on a dense grid over all bands, edges and inside.
pub(crate) fn worst_ratio(request: &Request, taps: &[(u32, f64)]) -> f64 {
    let mut worst = 0.0f64;
    for band in &request.bands {
        let ([low, high], [least, most]) = (band.frequency_hz, band.damping);
        for step in 0..=400 {
            let frequency_hz = low + (high - low) * f64::from(step) / 400.0;
            for part in [0.0, 0.2, 0.5, 0.8, 1.0] {
                let damping = least + (most - least) * part;
                let ratio = residual(taps, frequency_hz, damping, request.sample_hz) / band.tolerance;
                worst = worst.max(ratio);
            }
        }
    }
    worst
}
