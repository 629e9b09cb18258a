//! The fitted function and its derivatives at the points, column by column.
//!
//! A point is the mean of a small range of frequencies, so that each value is the mean of those at the point's two nodes. It is divided by
//! the point's standard deviation. In a column, the real parts of all points come before the imaginary parts.

use super::ResponsePoint;
use super::fit::{Phase, Pole};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Number of terms of the complex polynomial that represents everything except the modes, where the phase is free.
const FREE_TERMS: i32 = 5;

/// `1 / (1 − r² + 2jζr)` of a mode, and the relative frequency `r`.
pub(super) fn resonance(pole: &Pole, frequency_hz: f64) -> (Complex<f64>, f64) {
    let ratio = frequency_hz / pole.frequency_hz;
    let (re, im) = (1.0 - ratio * ratio, 2.0 * pole.damping * ratio);
    let norm = (re * re + im * im).recip();
    (Complex::new(re * norm, -im * norm), ratio)
}

/// `j` times a value.
pub(super) fn times_j(value: Complex<f64>) -> Complex<f64> {
    Complex::new(-value.im, value.re)
}

/// Complex coefficients of the displacement and velocity of a pole.
pub(super) type Coefficients = [Complex<f64>; 2];

/// The frequencies at which a fit needs values.
pub(super) struct Nodes {
    /// Frequencies in Hz: the lower node of each point, then the upper node of each.
    frequencies_hz: Vec<f64>,
    /// Weight of either node of each point: half the reciprocal of its standard deviation.
    weights: Vec<f64>,
    /// Frequency in Hz of the last point.
    top_hz: f64,
}

impl Nodes {
    pub(super) fn new(points: &[ResponsePoint]) -> Self {
        let node = |which: usize| points.iter().map(move |point| point.nodes_hz()[which]);
        Self {
            frequencies_hz: node(0).chain(node(1)).collect(),
            weights: points.iter().map(|point| 0.5 / point.deviation).collect(),
            top_hz: top_hz(points),
        }
    }

    /// Number of rows of a column.
    fn rows(&self) -> usize {
        self.frequencies_hz.len()
    }

    /// Writes columns, one after the other, from their values at a node.
    fn write<const N: usize>(&self, columns: &mut [f64], value: impl Fn(usize) -> [Complex<f64>; N]) {
        let count = self.weights.len();
        for (point, weight) in self.weights.iter().enumerate() {
            let (lower, upper) = (value(point), value(count + point));
            for (column, (lower, upper)) in columns
                .chunks_exact_mut((2 * count).max(1))
                .zip(lower.iter().zip(&upper))
            {
                column[point] = weight * (lower.re + upper.re);
                column[count + point] = weight * (lower.im + upper.im);
            }
        }
    }

    /// The phase factor at each node.
    fn turns(&self, phase: Phase) -> Vec<Complex<f64>> {
        let late = phase.lateness();
        let turn = |&frequency_hz: &f64| late.turn(frequency_hz, self.top_hz);
        self.frequencies_hz.iter().map(turn).collect()
    }

    /// The columns of the linear unknowns: displacement and velocity of each pole, then everything except the modes.
    pub(super) fn basis(&self, poles: &[Pole], phase: Phase) -> DMatrix<f64> {
        let (rows, of_poles) = (self.rows(), 2 * poles.len());
        let others = match phase {
            Phase::Late(_) => 2,
            Phase::Free => FREE_TERMS as usize,
        };
        let half = of_poles + others;
        let width = if phase == Phase::Free { 2 * half } else { half };
        let mut matrix = DMatrix::zeros(rows, width);
        let turns = self.turns(phase);
        let (modes, rest) = matrix.as_mut_slice().split_at_mut(of_poles * rows);
        for (pole, columns) in poles.iter().zip(modes.chunks_exact_mut((2 * rows).max(1))) {
            self.write(columns, |node| {
                let (resonance, ratio) = resonance(pole, self.frequencies_hz[node]);
                let still = turns[node] * resonance;
                [still, times_j(still) * ratio]
            });
        }
        let relative = |node: usize| self.frequencies_hz[node] / self.top_hz;
        match phase {
            Phase::Late(_) => self.write(rest, |node| [turns[node], turns[node] * relative(node).powi(2)]),
            Phase::Free => {
                for (power, column) in (0..FREE_TERMS).zip(rest.chunks_exact_mut(rows.max(1))) {
                    self.write(column, |node| {
                        [Complex::new((2.0 * relative(node) - 1.0).powi(power), 0.0)]
                    });
                }
                self.turned(&mut matrix, half);
            }
        }
        matrix
    }

    /// Writes the first `half` columns once more behind them, multiplied by `j`, for complex coefficients.
    fn turned(&self, matrix: &mut DMatrix<f64>, half: usize) {
        let (rows, count) = (self.rows(), self.weights.len());
        let (first, second) = matrix.as_mut_slice().split_at_mut(half * rows);
        for (from, to) in first
            .chunks_exact(rows.max(1))
            .zip(second.chunks_exact_mut(rows.max(1)))
        {
            let ((re, im), (turned_re, turned_im)) = (from.split_at(count), to.split_at_mut(count));
            turned_re.iter_mut().zip(im).for_each(|(to, im)| *to = -im);
            turned_im.copy_from_slice(re);
        }
    }

    /// Derivatives of the fitted function with respect to `ln f` and `ln ζ` of each pole, and to delay and bend if the phase is known.
    /// `rest` are the coefficients of everything except the modes, in that case.
    pub(super) fn slopes(
        &self,
        poles: &[Pole],
        phase: Phase,
        coefficients: &[Coefficients],
        rest: [f64; 2],
    ) -> DMatrix<f64> {
        let (rows, of_poles) = (self.rows(), 2 * poles.len());
        let late = if phase == Phase::Free { 0 } else { 2 };
        let mut matrix = DMatrix::zeros(rows, of_poles + late);
        let turns = self.turns(phase);
        let (modes, delays) = matrix.as_mut_slice().split_at_mut(of_poles * rows);
        let above = |[still, moving]: Coefficients, ratio: f64| still + times_j(moving) * ratio;
        let modes = modes.chunks_exact_mut((2 * rows).max(1));
        for ((pole, &of_pole), columns) in poles.iter().zip(coefficients).zip(modes) {
            self.write(columns, |node| {
                let (resonance, ratio) = resonance(pole, self.frequencies_hz[node]);
                let outer = resonance * turns[node];
                let inner = above(of_pole, ratio) * resonance;
                let by_ratio = times_j(of_pole[1]) - inner * Complex::new(-2.0 * ratio, 2.0 * pole.damping);
                let by_damping = times_j(inner) * (-2.0 * ratio * pole.damping);
                [by_ratio * outer * -ratio, by_damping * outer]
            });
        }
        if late > 0 {
            self.write(delays, |node| {
                let frequency_hz = self.frequencies_hz[node];
                let relative = frequency_hz / self.top_hz;
                let mut value = Complex::new(rest[0] + rest[1] * relative * relative, 0.0);
                for (pole, &of_pole) in poles.iter().zip(coefficients) {
                    let (resonance, ratio) = resonance(pole, frequency_hz);
                    value += above(of_pole, ratio) * resonance;
                }
                let by_delay = times_j(turns[node] * value) * (-TAU * frequency_hz);
                [by_delay, by_delay * relative]
            });
        }
        matrix
    }
}

/// The highest frequency in Hz.
pub(super) fn top_hz(points: &[ResponsePoint]) -> f64 {
    points.last().map_or(1.0, |point| point.frequency_hz)
}

/// Measured values divided by their standard deviations.
pub(super) fn weighted(points: &[ResponsePoint]) -> DVector<f64> {
    let values = || points.iter().map(|point| point.value / point.deviation);
    let parts = values().map(|value| value.re).chain(values().map(|value| value.im));
    DVector::from_iterator(2 * points.len(), parts)
}

#[cfg(test)]
mod tests {
    use super::super::fit::Lateness;
    use super::*;

    const POLES: [Pole; 2] = [
        Pole {
            frequency_hz: 23.0,
            damping: 0.05,
        },
        Pole {
            frequency_hz: 61.0,
            damping: 0.02,
        },
    ];

    fn points() -> Vec<ResponsePoint> {
        let point = |n: u32| ResponsePoint {
            frequency_hz: 5.0 + 0.7 * f64::from(n),
            spread_hz: 0.2,
            value: Complex::ZERO,
            deviation: 0.3 + 0.01 * f64::from(n),
        };
        (0..120).map(point).collect()
    }

    /// The slopes are those of `basis · coefficients`, by differences of the unknowns.
    #[test]
    fn slopes_are_the_derivatives_of_the_fitted_function() {
        let nodes = Nodes::new(&points());
        let late = Lateness {
            delay_s: 3e-4,
            bend_s: -2e-4,
        };
        for phase in [Phase::Free, Phase::Late(late)] {
            let is_free = phase == Phase::Free;
            let width = nodes.basis(&POLES, phase).ncols();
            let coefficients = DVector::from_fn(width, |n, _| 0.4 + (n as f64).sin());
            let at = |column: usize| {
                let im = if is_free { coefficients[column + width / 2] } else { 0.0 };
                Complex::new(coefficients[column], im)
            };
            let slopes = nodes.slopes(
                &POLES,
                phase,
                &[0, 1].map(|pole| [at(2 * pole), at(2 * pole + 1)]),
                [coefficients[4], coefficients[5]],
            );
            assert_eq!(slopes.ncols(), if is_free { 4 } else { 6 });
            let moved = |unknown: usize, by: f64| {
                let (mut poles, mut phase) = (POLES, phase);
                match (unknown, &mut phase) {
                    (4, Phase::Late(late)) => late.delay_s += by,
                    (5, Phase::Late(late)) => late.bend_s += by,
                    (_, _) if unknown.is_multiple_of(2) => poles[unknown / 2].frequency_hz *= by.exp(),
                    (_, _) => poles[unknown / 2].damping *= by.exp(),
                }
                nodes.basis(&poles, phase) * &coefficients
            };
            for unknown in 0..slopes.ncols() {
                let by = 1e-6;
                let difference = (moved(unknown, by) - moved(unknown, -by)) / (2.0 * by);
                let off = (difference - slopes.column(unknown)).norm() / slopes.column(unknown).norm();
                assert!(off < 1e-7, "{phase:?}, unknown {unknown}: {off:e}");
            }
        }
    }
}
