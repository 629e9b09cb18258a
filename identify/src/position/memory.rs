//! Noise with a memory, for example from friction, a fan, a quantised sensor, or a disturbance that the machine
//! itself filters.
//!
//! ```text
//! n(k) = −a_1·n(k−1) − … − a_p·n(k−p) + e(k)     e without a memory
//! ```
//!
//! A fit that treats its rows as independent confuses such noise with a mode, and understates the uncertainty of a
//! true mode. The fit is therefore made on rows filtered by `1 + a_1·z⁻¹ + … + a_p·z⁻ᵖ` (generalised least squares),
//! and every mode must explain more than noise with its own memory would. The coefficients are found by Burg's
//! method, the order by Schwarz's criterion.

use super::held::HeldModes;
use super::search::{Found, LEAST_GAIN, ROUNDING, search};
use crate::separable::{Effort, Separable, refine};
use posicast_shaper::mode::Mode;

/// An autoregressive model of noise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NoiseMemory {
    /// Coefficients for the orders from 0 on; the first rows have a shorter past.
    predictors: Vec<Vec<f64>>,
    /// Variance of the prediction error of each order.
    variances: Vec<f64>,
}

/// Longest memory, in rows, for a forced response.
const LONGEST_FORCED: usize = 8;
/// Longest memory, in rows, for a free response: a longer one would explain a decay as well as a mode does.
const LONGEST_FREE: usize = 4;
/// Number of rows needed per coefficient.
const ROWS_PER_COEFFICIENT: usize = 12;
/// Twice the logarithm of the likelihood ratio above which noise counts as having a memory.
const HAS_MEMORY: f64 = 20.0;

impl NoiseMemory {
    /// Returns the model of order at most `longest` that fits the noise best.
    pub(super) fn of(noise: &[f64], longest: usize) -> Self {
        let rows = noise.len();
        let longest = longest.min(rows / ROWS_PER_COEFFICIENT);
        let mean_square = |signal: &[f64]| signal.iter().map(|x| x * x).sum::<f64>() / signal.len().max(1) as f64;
        let (mut forward, mut backward) = (noise.to_vec(), noise.to_vec());
        let mut predictors = vec![Vec::new()];
        let mut variances = vec![mean_square(noise)];
        for order in 0..longest {
            let pairs = || forward[order + 1..].iter().zip(&backward[order..rows - 1]);
            let cross: f64 = pairs().map(|(f, b)| f * b).sum();
            let power: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
            let reflection = -2.0 * cross / power;
            // For a signal of zeros the reflection is NaN.
            if reflection.is_nan() || reflection.abs() >= 1.0 {
                break;
            }
            let (old_forward, old_backward) = (forward.clone(), backward.clone());
            for k in order + 1..rows {
                forward[k] = old_forward[k] + reflection * old_backward[k - 1];
                backward[k] = old_backward[k - 1] + reflection * old_forward[k];
            }
            let last = &predictors[order];
            let mut next: Vec<f64> = (0..order).map(|n| last[n] + reflection * last[order - 1 - n]).collect();
            next.push(reflection);
            variances.push(variances[order] * (1.0 - reflection * reflection));
            predictors.push(next);
        }
        let cost = |order: usize| rows as f64 * variances[order].ln() + order as f64 * (rows as f64).ln();
        let best = (0..variances.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        let orders = best.unwrap_or(0) + 1;
        predictors.truncate(orders);
        variances.truncate(orders);
        Self { predictors, variances }
    }

    /// Variance of the model's prediction error.
    fn variance(&self) -> f64 {
        self.variances.last().copied().unwrap_or(0.0)
    }

    /// Whether this many rows of noise differ from independent ones by more than chance.
    fn is_certain(&self, rows: usize) -> bool {
        let first = self.variances.first().copied().unwrap_or(0.0);
        rows as f64 * (first / self.variance()).ln() > HAS_MEMORY
    }

    /// Removes from a signal what the past of the noise predicts; its rows then have equal variance.
    pub(super) fn whitened(&self, signal: &[f64]) -> Vec<f64> {
        let longest = self.predictors.len() - 1;
        let row = |k: usize| {
            let order = k.min(longest);
            let past = self.predictors[order].iter().zip(signal[..k].iter().rev());
            let alone = signal[k] + past.map(|(a, x)| a * x).sum::<f64>();
            alone * (self.variance() / self.variances[order]).sqrt()
        };
        (0..signal.len()).map(row).collect()
    }
}

/// Modes together with the noise beside them.
struct Level {
    modes: Vec<Mode>,
    memory: NoiseMemory,
}

impl Level {
    /// Fits the modes and the noise together.
    fn fitted(problem: &HeldModes<'_>, modes: &[Mode]) -> Option<Self> {
        let longest = longest(problem);
        let plain = refine(problem, &HeldModes::unknowns(modes), Effort::Rough)?;
        let residual = problem.measured() - &plain.fitted;
        let whitened = problem.whitened(NoiseMemory::of(residual.as_slice(), longest));
        let solution = refine(&whitened, &plain.unknowns, Effort::Rough)?;
        let residual = problem.measured() - problem.basis(&solution.unknowns) * &solution.coefficients;
        Some(Self {
            modes: HeldModes::modes(&solution.unknowns),
            memory: NoiseMemory::of(residual.as_slice(), longest),
        })
    }

    /// Keeps the modes of a fit that explain more than noise does, adding the strongest first.
    fn with_the_strongest(problem: &HeldModes<'_>, found: &Found) -> Option<Self> {
        let width = problem.per_mode();
        let strength = |k: usize| {
            let coefficients: Vec<f64> = (width * k..width * (k + 1))
                .map(|n| found.solution.coefficients[n])
                .collect();
            problem.strength(&found.modes[k], &coefficients)
        };
        let mut order: Vec<usize> = (0..found.modes.len()).collect();
        order.sort_by(|a, b| strength(*b).total_cmp(&strength(*a)));
        let mut level = Self::fitted(problem, &[])?;
        for k in order {
            let more = Self::fitted(problem, &[&level.modes[..], &[found.modes[k]]].concat())?;
            if more.explained_beyond(&level, problem) > LEAST_GAIN {
                level = more;
            }
        }
        Some(level)
    }

    /// Amount by which this level leaves less than another, in variances of the noise.
    fn explained_beyond(&self, other: &Self, problem: &HeldModes<'_>) -> f64 {
        problem.len() as f64 * (other.memory.variance() / self.memory.variance()).ln()
    }

    /// Returns the level without the mode that contributes least, and how much that mode explains, in variances of the
    /// noise.
    fn with_one_less(&self, problem: &HeldModes<'_>) -> Option<(f64, Self)> {
        let levels = (0..self.modes.len()).filter_map(|left_out| {
            let mut modes = self.modes.clone();
            modes.remove(left_out);
            Self::fitted(problem, &modes)
        });
        let best = levels.min_by(|a, b| a.memory.variance().total_cmp(&b.memory.variance()))?;
        Some((self.explained_beyond(&best, problem), best))
    }
}

fn longest(problem: &HeldModes<'_>) -> usize {
    if problem.is_forced() {
        LONGEST_FORCED
    } else {
        LONGEST_FREE
    }
}

/// Fits modes beside noise with a memory, and returns the fit with the problem that it solves; if the noise has no
/// memory, the rows are unchanged.
pub(super) fn beside_noise<'a>(problem: HeldModes<'a>, modes: &[Mode]) -> Option<(HeldModes<'a>, Found)> {
    let solution = refine(&problem, &HeldModes::unknowns(modes), Effort::Full)?;
    let power = problem.measured().variance() * problem.len() as f64;
    let residual = problem.measured() - &solution.fitted;
    let is_rounding = solution.square <= ROUNDING * power;
    if is_rounding || !NoiseMemory::of(residual.as_slice(), longest(&problem)).is_certain(problem.len()) {
        let modes = HeldModes::modes(&solution.unknowns);
        return Some((problem, Found { modes, solution }));
    }
    let level = Level::with_the_strongest(
        &problem,
        &Found {
            modes: modes.to_vec(),
            solution,
        },
    )?;
    // The remaining modes are those that noise cannot explain; others may appear after its memory is removed.
    let found = search(&problem.whitened(level.memory), &level.modes)?;
    let mut level = Level::fitted(&problem, &found.modes)?;
    while let Some((missed, less)) = level.with_one_less(&problem) {
        if missed > LEAST_GAIN {
            break;
        }
        level = less;
    }
    let whitened = problem.whitened(level.memory);
    let solution = refine(&whitened, &HeldModes::unknowns(&level.modes), Effort::Full)?;
    let modes = HeldModes::modes(&solution.unknowns);
    Some((whitened, Found { modes, solution }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    #[test]
    fn the_memory_of_noise_is_found_and_removed() {
        let mut source = Noise::new(1);
        let mut noise = vec![0.0, 0.0];
        for k in 2..4000 {
            noise.push(1.6 * noise[k - 1] - 0.8 * noise[k - 2] + 3.0 * source.draw());
        }
        let memory = NoiseMemory::of(&noise, 8);
        assert!(memory.is_certain(4000));
        let coefficients = memory.predictors.last().unwrap();
        assert!((coefficients[0] + 1.6).abs() < 0.05 && (coefficients[1] - 0.8).abs() < 0.05);
        assert!((memory.variance() / 9.0 - 1.0).abs() < 0.1, "{}", memory.variance());
        let white = memory.whitened(&noise);
        assert!(!NoiseMemory::of(&white, 8).is_certain(4000));
        assert!(!NoiseMemory::of(&[0.0; 100], 8).is_certain(100));
    }
}
