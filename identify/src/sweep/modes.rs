//! Decides which poles of a fit are modes of the machine.

use super::transfer::{Band, Transfer};
use crate::found::{FoundMode, LEAST_PARTICIPATION, that_ring};
use crate::modal::{self, Fit, ResponsePoint};
use nalgebra::Complex;
use posicast_shaper::mode::Mode;

/// Returns the fraction of the transfer function's power, above that of its noise, that a fit explains.
pub(super) fn told(transfer: &Transfer, fit: &Fit) -> f64 {
    let weighted = |value: Complex<f64>, deviation: f64| (value / deviation).norm_sqr();
    let points = || transfer.points.iter().zip(&fit.values);
    let whole: f64 = points().map(|(p, _)| weighted(p.value, p.deviation)).sum();
    let left: f64 = points()
        .map(|(p, fitted)| weighted(p.value - fitted, p.deviation))
        .sum();
    1.0 - left / whole
}

/// Damping ratio from which on a pole does not count as a vibration, but as a slope of the transfer function.
const NO_VIBRATION: f64 = 0.5;
/// Share of the axis's own displacement below which errors of the excitation's description look like a mode.
const LEAST_OF_AXIS: f64 = 0.003;
/// Number of standard deviations by which a share must exceed zero.
const SIGNIFICANT: f64 = 6.0;

/// Distance from a gap, as a fraction of the frequency, up to which the part that the gap cuts off can look like a faint mode.
const EDGE: f64 = 0.1;

/// Poles of a fit that are modes of the machine, and doubtful ones.
pub(super) struct Told {
    pub(super) modes: Vec<FoundMode>,
    pub(super) doubtful: Vec<FoundMode>,
}

/// Distance to an end of the band, and half width `ζ·f` of a pole, both over the band that a sweep passes while it shakes a frequency
/// (`√rate`), below which the pole cannot be distinguished from an error at the transfer function's end.
const NEAR_END: f64 = 0.5;
const NARROW: f64 = 0.125;

/// Returns the modes of a fit within a band, without those that too few samples show, for a sweep that rises by `rate_hz_per_s`.
pub(super) fn modes(fit: &Fit, points: &[ResponsePoint], band: &Band, unseen: &[Band], rate_hz_per_s: f64) -> Told {
    let whole: f64 = fit.shares.iter().map(|(share, _)| share.max(0.0)).sum();
    let told = |k: &usize| {
        let pole = &fit.poles[*k];
        let (share, deviation) = fit.shares[*k];
        let inside = pole.frequency_hz > band.low_hz && pole.frequency_hz < band.high_hz;
        let is_faint = share < LEAST_PARTICIPATION * whole;
        let margin_hz = pole.frequency_hz * if is_faint { pole.damping.max(EDGE) } else { pole.damping };
        let is_seen =
            |band: &Band| pole.frequency_hz + margin_hz < band.low_hz || pole.frequency_hz - margin_hz > band.high_hz;
        inside
            && unseen.iter().all(is_seen)
            && pole.damping < NO_VIBRATION
            && modal::is_resolved(points, pole)
            && share > SIGNIFICANT * deviation
            && share > LEAST_OF_AXIS * fit.still.abs()
    };
    let passed_hz = rate_hz_per_s.sqrt();
    let is_doubtful = |found: &FoundMode| {
        let Mode { frequency_hz, damping } = found.mode;
        let to_end_hz = (frequency_hz - band.low_hz).min(band.high_hz - frequency_hz);
        to_end_hz < NEAR_END * passed_hz && damping * frequency_hz < NARROW * passed_hz
    };
    let poles = (0..fit.poles.len()).filter(told).map(|k| FoundMode {
        mode: Mode {
            frequency_hz: fit.poles[k].frequency_hz,
            damping: fit.poles[k].damping,
        },
        participation: fit.shares[k].0,
        frequency_sd_hz: fit.deviations[k].0,
        damping_sd: fit.deviations[k].1,
    });
    let (doubtful, modes): (Vec<_>, Vec<_>) = poles.partition(is_doubtful);
    Told {
        modes: that_ring(modes),
        doubtful,
    }
}
