//! The families of optimal cascades: each is followed by Newton's method from a known member to the wanted bound.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use super::super::newton;
use super::{VibrationlessCascade, gain, peak_between, peaks, zeros};

/// A member of a family: `(ε, Δ, r)`, to the digits from which Newton's method converges.
pub(super) type Seed = (f64, f64, &'static [f64]);

/// Starting members for the orders 2 to 5; families without repetitions come first. Order 1 has a closed form.
pub(super) const SEEDS: [&[Seed]; 4] = [
    &[(0.097339, 0.2, &[0.8591, 1.1394])],
    &[
        (0.049571, 0.3, &[0.741, 0.9921, 1.2544]),
        (0.177737, 0.5, &[0.481, 0.7741, 1.136]),
        (0.288704, 0.6, &[0.4663, 0.8253, 1.3929]),
        (0.35, 0.670156, &[0.431533, 0.534801, 0.947756]),
        (0.378, 0.7534, &[0.29674, 0.555699, 1.110068]),
        (0.374804, 0.7, &[0.2886, 0.5387, 1.0797]),
    ],
    &[
        (0.011466, 0.3, &[0.7234, 0.8826, 1.1035, 1.2738]),
        (0.060868, 0.5, &[0.487, 0.684, 0.9567, 1.2378]),
        (0.099365, 0.606191, &[0.455226, 0.52381, 0.826709, 1.107547]),
        (0.111486, 0.6, &[0.4368, 0.661, 0.9638, 1.5086]),
        (0.12332, 0.636046, &[0.399583, 0.610242, 0.894838, 1.506523]),
        (0.124398, 0.638, &[0.39774, 0.60765, 0.8924, 1.50165]),
        (0.125877, 0.7, &[0.33, 0.5038, 0.7371, 1.2463]),
        (0.2, 0.756826, &[0.278361, 0.472923, 0.567354, 1.080656]),
        (0.212555, 0.78, &[0.2498, 0.4426, 0.5263, 0.9839]),
    ],
    &[
        (0.002653, 0.3, &[0.7151, 0.8234, 0.9921, 1.1655, 1.283]),
        (0.021172, 0.5, &[0.4901, 0.6298, 0.839, 1.0708, 1.2969]),
        (0.03, 0.543203, &[0.479686, 0.633305, 0.860378, 1.114901, 1.443961]),
        (0.031824, 0.575955, &[0.464436, 0.51776, 0.74845, 0.976078, 1.211974]),
        (0.04, 0.601243, &[0.421858, 0.565786, 0.782205, 1.021002, 1.502621]),
        (0.039897, 0.6, &[0.4231, 0.5678, 0.7847, 1.0241, 1.5065]),
        (0.05, 0.64209, &[0.380458, 0.5325671, 0.7169933, 0.9746735, 1.3941908]),
        (0.064748, 0.7, &[0.3259, 0.4635, 0.5451, 0.7839, 1.1867]),
        (0.063816, 0.68, &[0.3263, 0.4812, 0.6089, 0.8746, 1.2312]),
    ],
];

/// The highest peak above the bound; `None` if there is none. `unknowns` are the ratios and the index.
fn highest_above(unknowns: &DVector<f64>, log_epsilon: f64) -> Option<Peak> {
    let (ratios, index) = unknowns.as_slice().split_at(unknowns.len() - 1);
    let index = index[0];
    let bound = log_epsilon.exp() / 2.0 * (1.0 + 1e-9);
    let ends = [(Peak::Low, 1.0 - index), (Peak::High, 1.0 + index)];
    let between = peaks(ratios, index).map(|(left, peak)| (Peak::After(left), peak));
    let heights = between.chain(ends).map(|(peak, at)| (gain(ratios, at), peak));
    let highest = heights.max_by(|a, b| a.0.total_cmp(&b.0));
    highest.filter(|(height, _)| *height > bound).map(|(_, peak)| peak)
}

/// Action if another peak rises above the bound on the way to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Above {
    /// The peak takes the place of one of the equal peaks.
    Exchanged,
    /// The way continues, because the peak may have fallen again at its end.
    Crossed,
}

/// A frequency at which the gain may be largest.
#[derive(Debug, Clone, Copy)]
enum Peak {
    /// The lower end of the band.
    Low,
    /// Between two zeros; the index is that of the lower one.
    After(usize),
    /// The upper end of the band.
    High,
}

/// A family of optima, given by the `n + 1` peaks that are equal.
pub(super) struct Family(Vec<Peak>);

impl Family {
    /// The family of a seed: that of its `n + 1` highest peaks.
    pub(super) fn of(seed: &Seed) -> Self {
        let (_, index, ratios) = *seed;
        let ends = [(Peak::Low, 1.0 - index), (Peak::High, 1.0 + index)];
        let between = peaks(ratios, index).map(|(left, peak)| (Peak::After(left), peak));
        let mut heights: Vec<(f64, Peak)> = between.chain(ends).map(|(peak, at)| (gain(ratios, at), peak)).collect();
        heights.sort_by(|a, b| b.0.total_cmp(&a.0));
        Self(
            heights
                .into_iter()
                .take(ratios.len() + 1)
                .map(|(_, peak)| peak)
                .collect(),
        )
    }

    /// Follows the family from a seed to `epsilon`, in steps of its logarithm that are halved where a step fails.
    pub(super) fn follow(mut self, seed: &Seed, epsilon: f64, above: Above) -> Option<VibrationlessCascade> {
        // An exchange must not be missed, so the steps are short; without one the way is smooth.
        let first_step: f64 = match above {
            Above::Exchanged => 0.1,
            Above::Crossed => 0.5,
        };
        let last_step = first_step / 8.0;
        let (start, index, ratios) = *seed;
        let unknowns: Vec<f64> = ratios.iter().copied().chain([index]).collect();
        let mut reached = start.ln();
        let target = epsilon.ln();
        let mut solution = self.refine(&DVector::from_vec(unknowns), reached)?;
        let mut step = first_step;
        loop {
            let next = reached + (target - reached).clamp(-step, step);
            match self.step(&solution, next, above) {
                Some((family, refined)) => (self, solution, reached) = (family, refined, next),
                None if step > last_step => step /= 2.0,
                None => return None,
            }
            if reached == target {
                if highest_above(&solution, target).is_some() {
                    return None;
                }
                let mut ratios: Vec<f64> = solution.iter().copied().collect();
                let index = ratios.pop()?;
                return Some(VibrationlessCascade { ratios, index });
            }
        }
    }

    /// The optimum at the next bound. Where another peak rises above the bound, it replaces that one of the equal
    /// peaks whose removal leaves the widest band.
    fn step(&self, start: &DVector<f64>, log_epsilon: f64, above: Above) -> Option<(Self, DVector<f64>)> {
        let refined = self.refine(start, log_epsilon)?;
        let higher = highest_above(&refined, log_epsilon).filter(|_| above == Above::Exchanged);
        let Some(higher) = higher else {
            return Some((Self(self.0.clone()), refined));
        };
        let exchanged = (0..self.0.len()).filter_map(|position| {
            let mut peaks = self.0.clone();
            peaks[position] = higher;
            let family = Self(peaks);
            let found = family
                .refine(&refined, log_epsilon)
                .or_else(|| family.refine(start, log_epsilon))?;
            highest_above(&found, log_epsilon).is_none().then_some((family, found))
        });
        exchanged.max_by(|(_, a), (_, b)| a[a.len() - 1].total_cmp(&b[b.len() - 1]))
    }

    fn refine(&self, start: &DVector<f64>, log_epsilon: f64) -> Option<DVector<f64>> {
        let equations = |x: &_| self.equations(x, log_epsilon);
        let found = newton::solve_with(equations, |x| self.slopes(x), start.clone(), 1e-11)?;
        let ratios = &found.as_slice()[..found.len() - 1];
        let index = found[found.len() - 1];
        let ordered = ratios.windows(2).all(|pair| pair[0] < pair[1]);
        (ordered && ratios[0] > 1.0 - index && index < 1.0).then_some(found)
    }

    /// Frequencies of the peaks in their order; NaN where the family has no such peak.
    fn frequencies(&self, ratios: &[f64], index: f64) -> Vec<f64> {
        let zeros = zeros(ratios, 1.0 + index);
        let frequency = |peak: &Peak| match *peak {
            Peak::Low => 1.0 - index,
            Peak::High => 1.0 + index,
            Peak::After(left) => match zeros.get(left..left + 2) {
                Some(&[left, right]) => peak_between(ratios, left, right),
                _ => f64::NAN,
            },
        };
        self.0.iter().map(frequency).collect()
    }

    /// Distances of the peaks' heights from `ε/2`, as logarithms; NaN where the family has no such peak.
    fn equations(&self, unknowns: &DVector<f64>, log_epsilon: f64) -> DVector<f64> {
        let (ratios, index) = unknowns.as_slice().split_at(unknowns.len() - 1);
        let frequencies = self.frequencies(ratios, index[0]).into_iter();
        let heights = frequencies.map(|frequency| (2.0 * gain(ratios, frequency)).ln() - log_epsilon);
        DVector::from_iterator(self.0.len(), heights)
    }

    /// Derivatives of [`equations`](Self::equations): a row per peak, a column per unknown. A height between two zeros
    /// is stationary, so that a shift of its frequency changes nothing.
    fn slopes(&self, unknowns: &DVector<f64>) -> DMatrix<f64> {
        let (ratios, index) = unknowns.as_slice().split_at(unknowns.len() - 1);
        let mut slopes = DMatrix::zeros(self.0.len(), unknowns.len());
        let frequencies = self.frequencies(ratios, index[0]);
        for (row, (peak, frequency)) in self.0.iter().zip(frequencies).enumerate() {
            let tangents = ratios
                .iter()
                .map(|ratio| PI / (2.0 * ratio) * (PI * frequency / (2.0 * ratio)).tan());
            let by_index = match peak {
                Peak::Low => 1.0,
                Peak::After(_) => 0.0,
                Peak::High => -1.0,
            };
            for (column, (ratio, tangent)) in ratios.iter().zip(tangents).enumerate() {
                slopes[(row, column)] = tangent * frequency / ratio;
                slopes[(row, ratios.len())] += by_index * tangent;
            }
        }
        slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each slope against central differences, whose error is of the order of their square.
    #[test]
    fn slopes_are_the_derivatives_of_the_heights() {
        for seed in SEEDS.concat() {
            let family = Family::of(&seed);
            let at = DVector::from_iterator(seed.2.len() + 1, seed.2.iter().copied().chain([seed.1]));
            let slopes = family.slopes(&at);
            let differences = newton::differences(|x| family.equations(x, 0.0), &at);
            for (slope, expected) in slopes.iter().zip(&differences) {
                let tolerance = 1e-5 * (1.0 + expected.abs());
                assert!((slope - expected).abs() < tolerance, "{seed:?}: {slope} {expected}");
            }
        }
    }
}
