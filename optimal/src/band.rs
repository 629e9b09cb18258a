//! A mode with its uncertainty, and the points at which its residual is largest.
//!
//! In the plane of `p = ω(ζ + j√(1−ζ²))` a band is a part of a ring: `|p| = ω`, angle `acos ζ`. `Σ a_i e^(−p(N−i))` is
//! analytic there, so the maximum of its modulus lies on one of the four edges.

use num_complex::Complex64;
use std::f64::consts::TAU;

/// A mode with its ranges of frequency and damping ratio, and its largest allowed residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lowest and highest undamped natural frequency in Hz.
    pub frequency_hz: [f64; 2],
    /// Lowest and highest damping ratio, in [0, 1).
    pub damping: [f64; 2],
    /// Largest residual vibration, in (0, 1).
    pub tolerance: f64,
}

/// A point of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) band: usize,
    pub(crate) frequency_hz: f64,
    pub(crate) damping: f64,
    pub(crate) tolerance: f64,
}

impl Point {
    /// `e^(−p)` of one sample.
    pub(crate) fn z(&self, sample_hz: f64) -> Complex64 {
        let omega = TAU * self.frequency_hz / sample_hz;
        let imaginary = omega * (1.0 - self.damping * self.damping).sqrt();
        Complex64::from_polar((-omega * self.damping).exp(), -imaginary)
    }

    /// Whether two points of one band are the same but for rounding.
    fn is_at(&self, other: &Self) -> bool {
        let is_near = |a: f64, b: f64, unit: f64| (a - b).abs() <= ROUNDING * unit;
        is_near(self.frequency_hz, other.frequency_hz, other.frequency_hz) && is_near(self.damping, other.damping, 1.0)
    }

    /// Returns the ratio of the residual of these taps to the tolerance.
    pub(crate) fn ratio(&self, taps: &[(u32, f64)], sample_hz: f64) -> f64 {
        residual_sum(taps, self.z(sample_hz)).norm() / self.tolerance
    }
}

/// Computes `Σ a_i z^(N−i)` by Horner's rule over the gaps.
pub(crate) fn residual_sum(taps: &[(u32, f64)], z: Complex64) -> Complex64 {
    let mut sum = Complex64::default();
    let mut last = None;
    for &(sample, amplitude) in taps {
        if let Some(last) = last {
            sum *= match sample - last {
                1 => z,
                gap => z.powu(gap),
            };
        }
        sum += amplitude;
        last = Some(sample);
    }
    sum
}

/// An edge of a band: from a point to a point, with frequency and damping linear in between.
#[derive(Debug, Clone, Copy)]
struct Edge {
    from: Point,
    to: Point,
}

/// Number of evaluations of a residual per turn of two taps against each other.
const LOOKS_PER_TURN: f64 = 16.0;
/// Smallest number of evaluations along an edge.
const LOOKS_LEAST: f64 = 24.0;
/// Distance below which two points are one: that of the frequencies relative to them, that of the damping ratios.
const ROUNDING: f64 = 1e-9;
/// Rounds of the golden section that narrows a peak.
const ROUNDS: usize = 34;

impl Edge {
    fn at(&self, share: f64) -> Point {
        // Rounding must not lead beyond the ends, because a proof is refused for a point outside.
        let between = |from: f64, to: f64| (from + share * (to - from)).clamp(from, to);
        Point {
            frequency_hz: between(self.from.frequency_hz, self.to.frequency_hz),
            damping: between(self.from.damping, self.to.damping),
            ..self.from
        }
    }

    fn looks(&self, samples: f64, sample_hz: f64) -> usize {
        let angle = |point: &Point| (point.damping).acos();
        let reach = (self.from.frequency_hz - self.to.frequency_hz).abs()
            + self.to.frequency_hz * (angle(&self.from) - angle(&self.to)).abs();
        (LOOKS_PER_TURN * reach * samples / sample_hz).max(LOOKS_LEAST).ceil() as usize
    }
}

impl Band {
    fn edges(&self, band: usize) -> Vec<Edge> {
        let point = |frequency_hz, damping| Point {
            band,
            frequency_hz,
            damping,
            tolerance: self.tolerance,
        };
        let ([low, high], [least, most]) = (self.frequency_hz, self.damping);
        let mut edges = Vec::new();
        let mut edge = |from: Point, to: Point| edges.push(Edge { from, to });
        match (low < high, least < most) {
            (false, false) => edge(point(low, least), point(low, least)),
            (true, false) => edge(point(low, least), point(high, least)),
            (false, true) => edge(point(low, least), point(low, most)),
            (true, true) => {
                edge(point(low, least), point(high, least));
                edge(point(low, most), point(high, most));
                edge(point(low, least), point(low, most));
                edge(point(high, least), point(high, most));
            }
        }
        edges
    }

    /// Returns the first points of a search: ends, middles and quarters of the edges.
    pub(crate) fn first_points(&self, band: usize) -> Vec<Point> {
        let mut points: Vec<Point> = Vec::new();
        for edge in self.edges(band) {
            for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let point = edge.at(share);
                if !points.contains(&point) {
                    points.push(point);
                }
            }
        }
        points
    }

    /// Returns points spread over the edges, close enough for a mean over the band.
    pub(crate) fn spread_points(&self, band: usize, samples: u32, sample_hz: f64) -> Vec<Point> {
        let mut points = Vec::new();
        for edge in self.edges(band) {
            let looks = edge.looks(f64::from(samples), sample_hz).div_ceil(4);
            points.extend((0..=looks).map(|look| edge.at(look as f64 / looks as f64)));
        }
        points.dedup();
        points
    }

    /// Returns the peaks of the ratio of residual to tolerance along the edges, including the ends, highest first; each
    /// point once.
    pub(crate) fn peaks(&self, band: usize, taps: &[(u32, f64)], sample_hz: f64) -> Vec<(f64, Point)> {
        let samples = f64::from(taps.last().map_or(0, |tap| tap.0));
        let mut peaks = Vec::new();
        for edge in self.edges(band) {
            let value = |share: f64| edge.at(share).ratio(taps, sample_hz);
            if edge.from == edge.to {
                peaks.push((value(0.0), edge.from));
                continue;
            }
            let looks = edge.looks(samples, sample_hz);
            let step = 1.0 / looks as f64;
            let values: Vec<f64> = (0..=looks).map(|look| value(look as f64 * step)).collect();
            for (look, &found) in values.iter().enumerate() {
                let before = look.checked_sub(1).map_or(f64::NEG_INFINITY, |i| values[i]);
                let after = values.get(look + 1).copied().unwrap_or(f64::NEG_INFINITY);
                if found < before || found < after {
                    continue;
                }
                let at = look as f64 * step;
                let (share, ratio) = narrow(value, (at - step).max(0.0), (at + step).min(1.0));
                if ratio > found {
                    peaks.push((ratio, edge.at(share)))
                } else {
                    peaks.push((found, edge.at(at)))
                }
            }
        }
        peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Two edges share a corner. A point that is twice in a cone program is work, and makes it ill-conditioned.
        let mut apart: Vec<(f64, Point)> = Vec::new();
        for peak in peaks {
            if !apart.iter().any(|(_, other)| other.is_at(&peak.1)) {
                apart.push(peak);
            }
        }
        apart
    }
}

/// Finds a maximum by golden section.
fn narrow(value: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> (f64, f64) {
    let golden = (5.0f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (to - golden * (to - from), from + golden * (to - from));
    let (mut at_low, mut at_high) = (value(low), value(high));
    for _ in 0..ROUNDS {
        if at_low > at_high {
            (to, high, at_high) = (high, low, at_low);
            low = to - golden * (to - from);
            at_low = value(low);
        } else {
            (from, low, at_low) = (low, high, at_high);
            high = from + golden * (to - from);
            at_high = value(high);
        }
    }
    if at_low > at_high {
        (low, at_low)
    } else {
        (high, at_high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_is_one_peak_of_its_two_edges() {
        let band = Band {
            frequency_hz: [22.0, 26.0],
            damping: [0.01, 0.04],
            tolerance: 0.05,
        };
        // The residual of a shaper for 24 Hz falls along each edge towards its middle.
        let peaks = band.peaks(0, &[(0, 0.5), (104, 0.5)], 5000.0);
        let mut corners: Vec<_> = peaks
            .iter()
            .map(|(_, point)| [point.frequency_hz, point.damping])
            .collect();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [[22.0, 0.01], [22.0, 0.04], [26.0, 0.01], [26.0, 0.04]]);
    }
}
