//! Fits several modes to one measured transfer function.
//!
//! ```text
//! H(f) = e^{−j2πfτ} · ( D + E·f² + Σ_k (a_k + j·b_k·r_k) / (1 − r_k² + 2jζ_k·r_k) ),     r_k = f/f_k
//! ```
//!
//! `a_k` is the share of mode `k` in the static displacement, `D` and `E` are the contributions of the axis itself
//! and of modes above the band, and `τ` is the time by which the response is later than was assumed; it may grow with
//! the frequency, because clocks drift. The fit is a weighted, separable least-squares fit: for given frequencies,
//! damping ratios and `τ` the other unknowns follow linearly (Golub and Pereyra 1973, in the form of Kaufman 1975).
//!
//! If the phase is not known, the coefficients are complex and the rest is a polynomial with complex coefficients: the
//! poles are then found for any phase of the excitation.

mod columns;
mod fit;
mod select;

pub(crate) use fit::{Fit, Lateness, Phase, Pole, is_resolved, likeliest_delay, refine};
pub use select::{TOLD_RINGING, Visible};
pub(crate) use select::{grown, pruned, select, visible};

use nalgebra::Complex;

/// A measured value of a transfer function, averaged over a small range of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponsePoint {
    /// Mean frequency in Hz.
    pub frequency_hz: f64,
    /// Standard deviation in Hz of the frequencies that were averaged.
    pub spread_hz: f64,
    /// Value of the transfer function.
    pub value: Complex<f64>,
    /// Standard deviation of the real part, and of the imaginary part.
    pub deviation: f64,
}

impl ResponsePoint {
    /// Returns two frequencies in Hz that have the same mean as the point's frequencies, up to the third power of their
    /// spread.
    fn nodes_hz(&self) -> [f64; 2] {
        [self.frequency_hz - self.spread_hz, self.frequency_hz + self.spread_hz]
    }
}

/// The values on fewer points, each the mean of `joined` neighbours.
pub(crate) fn thinned(points: &[ResponsePoint], joined: usize) -> Vec<ResponsePoint> {
    let mean = |group: &[ResponsePoint]| {
        let weight = |point: &ResponsePoint| point.deviation.powi(-2);
        let whole: f64 = group.iter().map(weight).sum();
        let frequency_hz = group.iter().map(|p| weight(p) * p.frequency_hz).sum::<f64>() / whole;
        let spread = |p: &ResponsePoint| p.spread_hz.powi(2) + (p.frequency_hz - frequency_hz).powi(2);
        ResponsePoint {
            frequency_hz,
            spread_hz: (group.iter().map(|p| weight(p) * spread(p)).sum::<f64>() / whole).sqrt(),
            value: group.iter().map(|p| p.value * weight(p)).sum::<Complex<f64>>() / whole,
            deviation: whole.sqrt().recip(),
        }
    };
    points.chunks(joined.max(1)).map(mean).collect()
}
