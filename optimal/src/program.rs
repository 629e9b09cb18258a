//! The cone program of a shaper on chosen samples, at chosen points of the bands.
//!
//! With [`Command::Positive`] and [`Command::Amplitudes`] the variables are the amplitudes. With
//! [`Command::PartialSums`] they are the partial sums `s_j`, so that each bound is one of a single variable: `a_j = s_j −
//! s_{j−1}`, the last sum is 1.

use crate::band::Point;
use crate::cone::{ConeProgram, Solution, Unsolved};
use crate::{Command, Request, Tap};
use num_complex::Complex64;

/// Objective of a program.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Objective<'a> {
    /// The largest ratio of residual to tolerance, without a bound.
    Ratio,
    /// `Σ weight |a|`, one weight per sample.
    Weighted(&'a [f64]),
    /// `Σ a_i i`.
    Delay,
    /// `−Σ a_i i`.
    Latest,
    /// The mean square of the ratios at these points.
    Squares(&'a [Point]),
}

/// A shaper on chosen samples.
pub(crate) struct Program<'a> {
    pub(crate) request: &'a Request,
    /// Samples that may have an amplitude, in order; the last is the duration.
    pub(crate) samples: &'a [u32],
    pub(crate) points: &'a [Point],
    /// Largest ratio of residual to tolerance, if the ratio is not the objective.
    pub(crate) level: f64,
}

/// Solution of a program.
pub(crate) struct Found {
    /// One amplitude per sample, with sum 1 and within the command's bounds.
    pub(crate) taps: Vec<Tap>,
    /// Weights of the points, as of a [`LowerBound`](crate::LowerBound), not yet of sum 1.
    pub(crate) weights: Vec<Complex64>,
    /// The largest ratio at the points, if it is the objective.
    pub(crate) ratio: Option<f64>,
}

/// A linear function of the variables.
type Terms = Vec<(usize, f64)>;

impl Program<'_> {
    /// The variables of the amplitudes are the first ones.
    fn variables(&self) -> usize {
        match self.request.command {
            Command::Positive | Command::Amplitudes { .. } => self.samples.len(),
            Command::PartialSums { .. } => self.samples.len() - 1,
        }
    }

    /// Returns `Σ factor_j a_j` as terms of the variables, and a constant.
    fn combined<T>(&self, factors: &[T]) -> (Vec<(usize, T)>, T)
    where
        T: Copy + std::ops::Sub<Output = T> + Default,
    {
        match self.request.command {
            Command::Positive | Command::Amplitudes { .. } => {
                (factors.iter().copied().enumerate().collect(), T::default())
            }
            Command::PartialSums { .. } => {
                let terms = factors.windows(2).map(|pair| pair[0] - pair[1]).enumerate();
                (terms.collect(), factors.last().copied().unwrap_or_default())
            }
        }
    }

    /// Returns real and imaginary part of the residual at a point in units of its tolerance, each as terms and a
    /// constant.
    fn residual(&self, point: &Point) -> [(Terms, f64); 2] {
        let powers = powers(self.samples, point.z(self.request.sample_hz));
        let (terms, constant) = self.combined(&powers);
        let part = |of: fn(&Complex64) -> f64| {
            let terms = terms.iter().map(|(j, value)| (*j, of(value) / point.tolerance));
            (terms.collect(), of(&constant) / point.tolerance)
        };
        [part(|value| value.re), part(|value| value.im)]
    }

    pub(crate) fn solve(&self, objective: Objective<'_>) -> Result<Found, Unsolved> {
        let mut program = ConeProgram::default();
        let delays: Vec<f64> = self.samples.iter().map(|sample| f64::from(*sample)).collect();
        let (delay_terms, delay_constant) = self.combined(&delays);
        let of_delay = |sign: f64| {
            let mut linear = vec![0.0; self.variables()];
            for (j, value) in &delay_terms {
                linear[*j] = sign * value;
            }
            linear
        };
        let linear = match (objective, self.request.command) {
            (Objective::Delay, _) => of_delay(1.0),
            (Objective::Latest, _) => of_delay(-1.0),
            (Objective::Weighted(weights), command) if command.is_positive() => weights.to_vec(),
            _ => vec![0.0; self.variables()],
        };
        let scale = linear.iter().fold(0.0f64, |most, value| most.max(value.abs())).max(1.0);
        for value in linear {
            program.variable(value / scale, 0.0);
        }
        self.bounds(&mut program);
        if let Some(delay) = self.request.delay_samples {
            let whole = delays.last().copied().unwrap_or(1.0).max(1.0);
            let terms = delay_terms.iter().map(|(j, value)| (*j, value / whole));
            program.equal(terms.collect::<Terms>(), (delay - delay_constant) / whole);
        }
        let ratio = match objective {
            Objective::Ratio => Some(program.variable(1.0, 0.0)),
            _ => None,
        };
        match objective {
            Objective::Weighted(weights) => self.magnitudes(&mut program, weights),
            Objective::Squares(points) => {
                let square = 2.0 / points.len().max(1) as f64;
                for (terms, constant) in points.iter().flat_map(|point| self.residual(point)) {
                    let value = program.variable(0.0, square);
                    program.equal(terms.into_iter().chain([(value, -1.0)]), -constant);
                }
            }
            _ => {}
        }
        let negative = |(terms, constant): (Terms, f64)| {
            let terms = terms.into_iter().map(|(j, value)| (j, -value)).collect::<Terms>();
            (terms, constant)
        };
        let rows: Vec<usize> = self
            .points
            .iter()
            .map(|point| {
                let [re, im] = self.residual(point);
                let most = match ratio {
                    Some(ratio) => (vec![(ratio, -1.0)], 0.0),
                    None => (Vec::new(), self.level),
                };
                program.cone([most, negative(re), negative(im)])
            })
            .collect();
        let solution = program.solve()?;
        let weights = rows.iter().zip(self.points).map(|(row, point)| {
            let [re, im] = [1, 2].map(|part| -scale * solution.z[row + part] / point.tolerance);
            Complex64::new(re, im)
        });
        Ok(Found {
            weights: weights.collect(),
            ratio: ratio.map(|variable| solution.x[variable]),
            taps: self.taps(&solution),
        })
    }

    /// Adds the bounds of the command.
    fn bounds(&self, program: &mut ConeProgram) {
        match self.request.command {
            Command::Positive => {
                program.equal((0..self.variables()).map(|j| (j, 1.0)), 1.0);
                for j in 0..self.variables() {
                    program.at_most([(j, -1.0)], 0.0);
                }
            }
            Command::PartialSums { low, high } => {
                for j in 0..self.variables() {
                    program.at_most([(j, 1.0)], high);
                    program.at_most([(j, -1.0)], -low);
                }
            }
            Command::Amplitudes { low, high } => {
                program.equal((0..self.variables()).map(|j| (j, 1.0)), 1.0);
                for j in 0..self.variables() {
                    program.at_most([(j, 1.0)], high);
                    program.at_most([(j, -1.0)], -low);
                }
            }
        }
    }

    /// Adds `Σ weight |a|` of amplitudes that may be negative, with a variable for each that is at least as large as the amplitude and as
    /// its negative.
    fn magnitudes(&self, program: &mut ConeProgram, weights: &[f64]) {
        if self.request.command.is_positive() {
            return;
        }
        let of_sums = matches!(self.request.command, Command::PartialSums { .. });
        let scale = weights.iter().fold(1.0f64, |most, value| most.max(*value));
        let last = self.samples.len() - 1;
        for (j, weight) in weights.iter().enumerate() {
            let size = program.variable(weight / scale, 0.0);
            for sign in [1.0, -1.0] {
                let own = (j < last || !of_sums).then_some((j, sign));
                let before = j.checked_sub(1).filter(|_| of_sums).map(|before| (before, -sign));
                let constant = if j == last && of_sums { sign } else { 0.0 };
                program.at_most(own.into_iter().chain(before).chain([(size, -1.0)]), -constant);
            }
        }
    }

    /// Returns the amplitudes of a solution, clamped to the bounds, which the solver meets only approximately.
    fn taps(&self, solution: &Solution) -> Vec<Tap> {
        let x = &solution.x[..self.variables()];
        let amplitudes: Vec<f64> = match self.request.command {
            Command::Positive => {
                let clipped: Vec<f64> = x.iter().map(|value| value.max(0.0)).collect();
                let sum: f64 = clipped.iter().sum();
                clipped.iter().map(|value| value / sum).collect()
            }
            Command::PartialSums { low, high } => {
                let sums = x.iter().map(|value| value.clamp(low, high)).chain([1.0]);
                let mut before = 0.0;
                sums.map(|sum| {
                    let amplitude = sum - before;
                    before = sum;
                    amplitude
                })
                .collect()
            }
            Command::Amplitudes { low, high } => within(x, low, high),
        };
        self.samples.iter().copied().zip(amplitudes).collect()
    }
}

/// Clamps amplitudes to bounds; the amount that is then missing from the sum 1 is distributed over the room that each of them has.
fn within(x: &[f64], low: f64, high: f64) -> Vec<f64> {
    let clamped: Vec<f64> = x.iter().map(|value| value.clamp(low, high)).collect();
    let missing = 1.0 - clamped.iter().sum::<f64>();
    let end = if missing > 0.0 { high } else { low };
    let room: f64 = clamped.iter().map(|value| (end - value).abs()).sum();
    let share = if room > 0.0 {
        (missing.abs() / room).min(1.0)
    } else {
        0.0
    };
    clamped.iter().map(|value| value + share * (end - value)).collect()
}

/// Returns `z^(N−i)` for each sample `i` of a list whose last is `N`.
pub(crate) fn powers(samples: &[u32], z: Complex64) -> Vec<Complex64> {
    let mut powers = vec![Complex64::new(1.0, 0.0); samples.len()];
    for index in (1..samples.len()).rev() {
        let step = match samples[index] - samples[index - 1] {
            1 => z,
            gap => z.powu(gap),
        };
        powers[index - 1] = powers[index] * step;
    }
    powers
}
