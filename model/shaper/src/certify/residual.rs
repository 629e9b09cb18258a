//! An upper bound of the residual of an integer table over a band.
//!
//! With `τ_i` the time from tap `i` to the last one, in samples, and `p = ω(ζ + j√(1−ζ²))/sample_hz`,
//!
//! ```text
//! V(p) = |F(p)|,   F(p) = Σ A_i e^(−p τ_i),   F′(p) = −Σ A_i τ_i e^(−p τ_i),   |F″(p)| ≤ Σ |A_i| τ_i² e^(−Re p·τ_i)
//! ```
//!
//! `F` is analytic, so `V` has its maximum over a band on the band's edge: two curves of constant damping, which are
//! rays of the `p` plane, and two of constant frequency, which are arcs round its origin. An edge is cut into pieces.
//! On a piece with the middle `p_0` and `|p − p_0| ≤ h`
//!
//! ```text
//! V(p) ≤ |F(p_0) + F′(p_0)(p − p_0)| + ½h² · max |F″|
//! ```
//!
//! The first term is convex in `p`, so on a straight piece it is largest at an end; an arc lies within `ω(1 − cos φ)`
//! of its chord, which adds `|F′|` times that. Pieces are halved, those of the largest bound first, until the bound is
//! hardly above a value that was found. The result is the largest bound of any piece.

use super::{UNIT, exponential_error};
use crate::mode::{Mode, ModeBand};
use nalgebra::Complex;
use posicast_taps::TapTable;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// The bound may lie above the largest value found by this part of it, and by this much.
const CLOSE: (f64, f64) = (1e-6, 1e-9);
/// Largest number of pieces of an edge; the bound holds with any number.
const PIECES: usize = 200_000;
/// Pieces overlap by this part: their ends are rounded.
const OVERLAP: f64 = 1.0 + 1e-12;

/// Bound of the residual of a table over a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualBound {
    /// Upper bound of the residual in the band.
    pub bound: f64,
    /// Largest residual that was found.
    pub found: f64,
    /// Mode at which it was found.
    pub at: Mode,
}

/// Returns the bound of a table's residual over a band of frequencies below half of `sample_hz` and damping ratios
/// below 1.
pub fn residual_bound(table: &TapTable, sample_hz: f64, band: &ModeBand) -> ResidualBound {
    let unity = f64::from(1u32 << table.coefficient_fraction());
    let last = table.longest_delay_samples();
    let taps = table.taps().iter().map(|tap| Term {
        amplitude: f64::from(tap.coefficient) / unity,
        delay: f64::from(last - tap.delay_samples),
    });
    let sum = Sum(taps.collect());
    let ([low, high], [least, most]) = (band.frequency_hz, band.damping);
    let per_sample = TAU / sample_hz;
    let mut edges = vec![Edge::ray(least, low, high)];
    if least < most {
        edges.extend([Edge::ray(most, low, high), Edge::arc(low, least, most)]);
        if low < high {
            edges.push(Edge::arc(high, least, most));
        }
    }
    let bounds = edges.iter().map(|edge| edge.bound(&sum, per_sample));
    let none = ResidualBound {
        bound: 0.0,
        found: -1.0,
        at: Mode {
            frequency_hz: low,
            damping: least,
        },
    };
    bounds.fold(none, |all, edge| ResidualBound {
        bound: all.bound.max(edge.bound),
        ..if edge.found > all.found { edge } else { all }
    })
}

struct Term {
    amplitude: f64,
    /// Samples to the last tap.
    delay: f64,
}

struct Sum(Vec<Term>);

/// `F` and `F′`, each with a bound of its error.
struct Values {
    sum: Complex<f64>,
    slope: Complex<f64>,
    sum_error: f64,
    slope_error: f64,
}

impl Sum {
    fn at(&self, p: Complex<f64>) -> Values {
        let zero = Complex::new(0.0, 0.0);
        let (mut sum, mut slope) = (zero, zero);
        let (mut sum_error, mut slope_error) = (0.0, 0.0);
        // Each addition rounds by a unit of what is added up so far.
        let adding = self.0.len() as f64 * UNIT;
        for Term { amplitude, delay } in &self.0 {
            let term = Complex::from_polar(amplitude * (-p.re * delay).exp(), -p.im * delay);
            let error = amplitude.abs() * (exponential_error(p.norm() * delay) + 2.0 * adding);
            sum += term;
            slope -= term * *delay;
            sum_error += error;
            slope_error += error * delay;
        }
        Values {
            sum,
            slope,
            sum_error,
            slope_error,
        }
    }

    /// Returns `max |F″|` for a real part of `p` of at least `decay`.
    fn curvature(&self, decay: f64) -> f64 {
        let terms = self.0.iter();
        terms
            .map(|term| term.amplitude.abs() * term.delay * term.delay * (-decay * term.delay).exp())
            .sum()
    }
}

/// An edge of a band: frequency or damping is constant on it.
#[derive(Clone, Copy)]
struct Edge {
    from: Mode,
    to: Mode,
    is_arc: bool,
}

/// A piece of an edge, by the part of it that it begins at, and its length.
struct Piece {
    bound: f64,
    start: f64,
    length: f64,
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl Edge {
    fn ray(damping: f64, low: f64, high: f64) -> Self {
        let [from, to] = [low, high].map(|frequency_hz| Mode { frequency_hz, damping });
        Self {
            from,
            to,
            is_arc: false,
        }
    }

    fn arc(frequency_hz: f64, least: f64, most: f64) -> Self {
        let [from, to] = [least, most].map(|damping| Mode { frequency_hz, damping });
        Self { from, to, is_arc: true }
    }

    /// Returns the mode at a part of the edge; along an arc the angle `acos ζ` is linear.
    fn at(&self, part: f64) -> Mode {
        let between = |from: f64, to: f64| from + part * (to - from);
        if self.is_arc {
            Mode {
                damping: between(self.from.damping.acos(), self.to.damping.acos()).cos(),
                ..self.from
            }
        } else {
            Mode {
                frequency_hz: between(self.from.frequency_hz, self.to.frequency_hz),
                ..self.from
            }
        }
    }

    fn bound(&self, sum: &Sum, per_sample: f64) -> ResidualBound {
        let mut best = ResidualBound {
            bound: 0.0,
            found: -1.0,
            at: self.from,
        };
        let mut pieces = BinaryHeap::new();
        let mut add = |start: f64, length: f64, pieces: &mut BinaryHeap<Piece>| {
            let (found, bound) = self.piece(sum, per_sample, start, length);
            if found > best.found {
                (best.found, best.at) = (found, self.at(start + length / 2.0));
            }
            pieces.push(Piece { bound, start, length });
            best
        };
        let mut state = add(0.0, 1.0, &mut pieces);
        let mut count = 1;
        while let Some(top) = pieces.peek() {
            state.bound = top.bound;
            let close = state.found.max(0.0) * (1.0 + CLOSE.0) + CLOSE.1;
            if top.bound <= close || count >= PIECES {
                break;
            }
            let Some(Piece { start, length, .. }) = pieces.pop() else {
                break;
            };
            let half = length / 2.0;
            add(start, half, &mut pieces);
            state = add(start + half, half, &mut pieces);
            count += 1;
        }
        // The largest value found has an error, but the bound is above it in any case.
        state.bound = state.bound.max(state.found);
        state
    }

    /// Returns the residual in the middle of a piece, and the bound over the piece.
    fn piece(&self, sum: &Sum, per_sample: f64, start: f64, length: f64) -> (f64, f64) {
        let pole = |mode: Mode| {
            let omega = mode.frequency_hz * per_sample;
            Complex::new(omega * mode.damping, omega * (1.0 - mode.damping * mode.damping).sqrt())
        };
        let [first, middle, last] = [start, start + length / 2.0, start + length].map(|part| self.at(part));
        let centre = pole(middle);
        let values = sum.at(centre);
        let [before, after] = [first, last].map(|end| (pole(end) - centre) * OVERLAP);
        let reach = before.norm().max(after.norm());
        let sagitta = match self.is_arc {
            false => 0.0,
            // Half the angle of the piece; 1 − cos x ≤ x²/2.
            true => {
                let half = (first.damping.acos() - last.damping.acos()).abs() / 2.0 * OVERLAP;
                middle.frequency_hz * per_sample * half * half / 2.0
            }
        };
        let decay = pole(first).re.min(pole(last).re) * (1.0 - 8.0 * UNIT);
        let linear = [before, after].map(|end| (values.sum + values.slope * end).norm());
        let bound = linear[0].max(linear[1])
            + values.slope.norm() * sagitta
            + 0.5 * reach * reach * sum.curvature(decay)
            + values.sum_error
            + values.slope_error * (reach + sagitta);
        (values.sum.norm(), bound * (1.0 + 64.0 * UNIT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{residual_vibration, tap_impulses};
    use posicast_taps::Tap;

    fn table(taps: &[(u32, i32)]) -> TapTable {
        let taps = taps.iter().map(|&(delay_samples, coefficient)| Tap {
            delay_samples,
            coefficient,
        });
        TapTable::new(16, taps.collect()).unwrap()
    }

    #[test]
    fn the_hump_of_an_ei_is_bounded_by_its_tolerance() {
        // 1.05/4, 0.95/2, 1.05/4 at half periods of 50 samples: the residual at the mode is 5 %, and less at both
        // sides.
        let ei = table(&[(0, 17_203), (50, 31_130), (100, 17_203)]);
        let band = ModeBand {
            frequency_hz: [8.7, 11.4],
            damping: [0.0, 0.0],
        };
        let found = residual_bound(&ei, 1000.0, &band);
        let exact = f64::from(17_203 * 2 - 31_130) / 65_536.0;
        assert!(
            found.bound >= exact && found.bound <= exact * (1.0 + 1e-5) + 1e-8,
            "{found:?}"
        );
        assert!((found.at.frequency_hz - 10.0).abs() < 0.01);
    }

    #[test]
    fn a_point_is_its_residual() {
        let zv = table(&[(0, 40_000), (50, 25_536)]);
        let mode = Mode {
            frequency_hz: 9.0,
            damping: 0.1,
        };
        let band = ModeBand {
            frequency_hz: [9.0; 2],
            damping: [0.1; 2],
        };
        let exact = residual_vibration(&tap_impulses(&zv, 1000.0), &mode);
        let found = residual_bound(&zv, 1000.0, &band);
        assert!(found.bound >= exact && found.bound < exact + 1e-11, "{found:?} {exact}");
    }
}
