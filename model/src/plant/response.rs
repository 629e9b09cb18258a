//! What a shaped unit step does on the simulated plant: vibration that is left, overshoot, the curve itself.
//!
//! The shaped step rises by `A_i` at `t_i`. Between those times the plant moves freely, in closed form, so peaks between
//! samples are found where they are: a sign change of the velocity is located on a grid of 1/48 of the shortest period and
//! narrowed to rounding.

use super::{Motion, Plant, free_amplitude};
use crate::impulse::Impulse;

/// Fraction of the shortest period between two looks at the velocity: two peaks of the sum lie farther apart.
const LOOKS_PER_PERIOD: f64 = 48.0;
/// Looks at one response, times modes; beyond it (periods of a millisecond and of minutes in one plant) they are spread out.
const LOOKS_MAX: f64 = 2e5;
/// After the last impulse the peak is looked for in this many periods of the slowest mode; of one mode alone the first
/// period has it.
const TAIL_PERIODS: f64 = 20.0;
/// Time constants after which a mode is at rest to rounding.
const SETTLED: f64 = 40.0;

/// Figures of one step response.
#[derive(Debug, Clone, PartialEq)]
pub struct StepFigures {
    /// Per mode: amplitude after the last impulse, as a fraction of that of an unshaped step at its own start. The measured
    /// counterpart of [`crate::analysis::residual_vibration`].
    pub residual: Vec<f64>,
    /// Highest position beyond the step, as a fraction of it; 0 if there is none.
    pub overshoot: f64,
}

/// Step figures where the machine is as modelled, and where it is not.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantFigures {
    /// Frequencies as in the machine file.
    pub nominal: StepFigures,
    /// All frequencies 10 % lower.
    pub minus_10_percent: StepFigures,
    /// All frequencies 10 % higher.
    pub plus_10_percent: StepFigures,
}

/// The three sets of figures for one shaper. A single impulse of amplitude 1 gives those of the unshaped machine.
pub fn plant_figures(plant: &Plant, impulses: &[Impulse]) -> PlantFigures {
    PlantFigures {
        nominal: step_figures(plant, impulses),
        minus_10_percent: step_figures(&plant.scaled(0.9), impulses),
        plus_10_percent: step_figures(&plant.scaled(1.1), impulses),
    }
}

/// Measures a unit step that is shaped by `impulses` (in order of time, the first at 0).
pub fn step_figures(plant: &Plant, impulses: &[Impulse]) -> StepFigures {
    let stretches = stretches(plant, impulses);
    let residual = stretches.last().map_or_else(Vec::new, |last| {
        let modes = plant.modes().iter().zip(&last.motion.states);
        modes
            .map(|(m, state)| {
                let unshaped = free_amplitude(&m.mode, &nalgebra::Vector2::new(1.0, 0.0));
                free_amplitude(&m.mode, state) / unshaped
            })
            .collect()
    });
    let shortest_s = plant.modes().iter().map(|m| 1.0 / m.mode.frequency_hz);
    let duration_s: f64 = stretches.iter().map(|s| s.length_s).sum();
    let looks_max = LOOKS_MAX / plant.modes().len().max(1) as f64;
    let look_s = (shortest_s.fold(f64::INFINITY, f64::min) / LOOKS_PER_PERIOD).max(duration_s / looks_max);
    let peaks = stretches.iter().map(|s| s.peak(look_s));
    StepFigures {
        residual,
        overshoot: peaks.fold(1.0, f64::max) - 1.0,
    }
}

/// Response to a shaped unit step, for plotting: `(seconds, position)` at `points` equally spaced times from 0.
pub fn step_response(plant: &Plant, impulses: &[Impulse], duration_s: f64, points: usize) -> Vec<(f64, f64)> {
    let stretches = stretches(plant, impulses);
    let intervals = points.saturating_sub(1).max(1) as f64;
    (0..points)
        .map(|point| {
            let time_s = duration_s * point as f64 / intervals;
            let index = stretches.partition_point(|s| s.start_s <= time_s);
            let current = index.checked_sub(1).and_then(|i| stretches.get(i));
            let position = current.map_or(0.0, |s| s.motion.ahead(time_s - s.start_s).0);
            (time_s, position)
        })
        .collect()
}

/// A time without a jump of the command.
struct Stretch<'a> {
    start_s: f64,
    length_s: f64,
    motion: Motion<'a>,
}

/// The response in stretches: from each impulse to the next, and a tail after the last.
fn stretches<'a>(plant: &'a Plant, impulses: &[Impulse]) -> Vec<Stretch<'a>> {
    let mut motion = Motion::at_rest(plant, 0.0);
    let ends = impulses.iter().skip(1).map(|i| i.time_s);
    let last_s = impulses.last().map_or(0.0, |i| i.time_s);
    let ends = ends.chain([last_s + tail_s(plant)]);
    impulses
        .iter()
        .zip(ends)
        .map(|(impulse, end_s)| {
            motion.step_to(motion.command + impulse.amplitude);
            let stretch = Stretch {
                start_s: impulse.time_s,
                length_s: end_s - impulse.time_s,
                motion: motion.clone(),
            };
            motion.advance(stretch.length_s);
            stretch
        })
        .collect()
}

/// How long after the last impulse a peak is looked for.
fn tail_s(plant: &Plant) -> f64 {
    let periods = if plant.modes().len() == 1 { 1.0 } else { TAIL_PERIODS };
    let each = plant.modes().iter().map(|m| {
        let settled_s = SETTLED / m.mode.decay();
        (periods * m.mode.damped_period_s()).min(settled_s)
    });
    each.fold(0.0, f64::max)
}

impl Stretch<'_> {
    /// Highest position in the stretch, its ends included.
    fn peak(&self, look_s: f64) -> f64 {
        let looks = (self.length_s / look_s).ceil().clamp(1.0, LOOKS_MAX) as u32;
        let mut highest = self.motion.ahead(0.0).0;
        let (mut before_s, mut rising) = (0.0, self.motion.ahead(0.0).1 > 0.0);
        for look in 1..=looks {
            let time_s = self.length_s * f64::from(look) / f64::from(looks);
            let (position, velocity) = self.motion.ahead(time_s);
            highest = highest.max(position);
            if rising && velocity <= 0.0 {
                highest = highest.max(self.turning_point(before_s, time_s));
            }
            (before_s, rising) = (time_s, velocity > 0.0);
        }
        highest
    }

    /// Position where the velocity falls through 0, between a time at which it is positive and one at which it is not.
    fn turning_point(&self, mut rising_s: f64, mut falling_s: f64) -> f64 {
        // Each round halves the interval: 60 exhaust the digits of a time.
        for _ in 0..60 {
            let middle_s = f64::midpoint(rising_s, falling_s);
            if self.motion.ahead(middle_s).1 > 0.0 {
                rising_s = middle_s;
            } else {
                falling_s = middle_s;
            }
        }
        self.motion.ahead(rising_s).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;
    use crate::mode::Mode;

    const UNSHAPED: [Impulse; 1] = [Impulse {
        time_s: 0.0,
        amplitude: 1.0,
    }];

    fn plant(modes: &[(f64, f64, f64)]) -> Plant {
        let modes: Vec<_> = modes
            .iter()
            .map(|&(frequency_hz, damping, share)| (Mode { frequency_hz, damping }, share))
            .collect();
        Plant::new(&modes).unwrap()
    }

    #[test]
    fn unit_unshaped_overshoot_is_the_closed_form() {
        for damping in [0.0, 0.01, 0.157799, 0.5, 0.9] {
            let figures = step_figures(&plant(&[(7.0, damping, 1.0)]), &UNSHAPED);
            let expected = (-std::f64::consts::PI * damping / (1.0 - damping * damping).sqrt()).exp();
            assert!((figures.overshoot - expected).abs() < 1e-12, "{damping}");
            assert!((figures.residual[0] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn unit_measured_residual_is_the_pole_sum() {
        let plant = plant(&[(5.0, 0.03, 1.0), (13.0, 0.2, 2.0)]);
        let impulses: Vec<Impulse> = [(0.0, 1.0), (0.031, -2.0), (0.05, 2.0)]
            .map(|(time_s, amplitude)| Impulse { time_s, amplitude })
            .to_vec();
        let figures = step_figures(&plant, &impulses);
        for (measured, m) in figures.residual.iter().zip(plant.modes()) {
            assert!((measured - residual_vibration(&impulses, &m.mode)).abs() < 1e-12);
        }
    }

    #[test]
    fn unit_two_modes_peak_between_samples() {
        // 1 − ½cos t − ½cos 2t is highest at cos t = −1/4: 1 + 1/8 + 7/16.
        let figures = step_figures(&plant(&[(1.0, 0.0, 1.0), (2.0, 0.0, 1.0)]), &UNSHAPED);
        assert!((figures.overshoot - 0.5625).abs() < 1e-12, "{}", figures.overshoot);
    }

    #[test]
    fn unit_step_response_starts_at_zero_and_ends_on_the_step() {
        let plant = plant(&[(2.0, 0.3, 1.0)]);
        let curve = step_response(&plant, &UNSHAPED, 10.0, 101);
        assert_eq!(curve.len(), 101);
        assert_eq!(curve[0], (0.0, 0.0));
        assert!((curve[100].1 - 1.0).abs() < 1e-12);
        let rigid = step_response(&Plant::new(&[]).unwrap(), &UNSHAPED, 1.0, 2);
        assert_eq!(rigid, [(0.0, 1.0), (1.0, 1.0)]);
        assert!(step_response(&plant, &[], 1.0, 3).iter().all(|p| p.1 == 0.0));
    }

    #[test]
    fn unit_absurd_plants_end() {
        let modes = [(1e-9, 0.0, 1.0), (1e9, 0.0, 1.0), (1.0, 1.0 - 1e-15, 1.0)];
        let figures = step_figures(&plant(&modes), &UNSHAPED);
        assert!(figures.overshoot.is_finite());
        assert_eq!(plant_figures(&plant(&[]), &UNSHAPED).nominal.overshoot, 0.0);
    }
}
