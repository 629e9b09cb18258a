//! Response of the simulated plant to a command: residual vibration, overshoot, the curve itself.
//!
//! The command is any [`Trajectory`]: a step, a ramp, a trapezoid, a jerk-limited move, shaped or not. Between the
//! jumps of the command the plant moves in closed form, so peaks between samples are found exactly: a sign change of
//! the velocity is located on a grid of 1/48 of the shortest period and refined to rounding.

use nalgebra::Vector2;

use super::{Motion, Plant, free_amplitude};
use crate::motion::Trajectory;
use posicast_shaper::impulse::Impulse;

/// Evaluations of the velocity per shortest period: two peaks of the sum lie farther apart than this.
const LOOKS_PER_PERIOD: f64 = 48.0;
/// Largest number of evaluations of one response, times modes; beyond it (with periods of a millisecond and of
/// minutes in one plant) they are spread out.
const LOOKS_MAX: f64 = 2e5;
/// Number of periods of the slowest mode in which the peak after the last impulse is searched; with a single mode it
/// lies in the first period.
const TAIL_PERIODS: f64 = 20.0;
/// Number of time constants after which a mode is at rest to rounding.
const SETTLED: f64 = 40.0;

/// Figures of one step response.
#[derive(Debug, Clone, PartialEq)]
pub struct StepFigures {
    /// Per mode: amplitude after the last impulse, as a fraction of that of an unshaped step at its own start. It is
    /// the measured counterpart of [`posicast_shaper::analysis::residual_vibration`].
    pub residual: Vec<f64>,
    /// Overshoot: highest position beyond the step, as a fraction of it; 0 if there is none.
    pub overshoot: f64,
}

/// Step figures for the modelled machine, and for machines whose frequencies differ.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantFigures {
    /// Figures with the frequencies of the machine file.
    pub nominal: StepFigures,
    /// Figures with all frequencies 10 % lower.
    pub minus_10_percent: StepFigures,
    /// Figures with all frequencies 10 % higher.
    pub plus_10_percent: StepFigures,
}

/// Step figures for one shaper. A single impulse of amplitude 1 gives those of the unshaped machine.
pub fn plant_figures(plant: &Plant, impulses: &[Impulse]) -> PlantFigures {
    PlantFigures {
        nominal: step_figures(plant, impulses),
        minus_10_percent: step_figures(&plant.scaled(0.9), impulses),
        plus_10_percent: step_figures(&plant.scaled(1.1), impulses),
    }
}

/// Response of a plant to one command, in the unit of the command.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseFigures {
    /// Per mode: residual displacement, which is the amplitude of its share of the vibration at the last jump of the
    /// command.
    pub residual_displacement: Vec<f64>,
    /// Highest position; at least 0, where the motion starts.
    pub highest: f64,
    /// Lowest position; at most 0, where the motion starts.
    pub lowest: f64,
    /// Largest distance from the command's end after its last jump. It is meaningless for a ramp without end.
    pub deviation_after: f64,
}

/// Measures the response to a command.
pub fn response_figures(plant: &Plant, command: &Trajectory) -> ResponseFigures {
    let stretches = stretches(plant, command);
    let look_s = look_s(plant, &stretches);
    let none = Extremes {
        lowest: 0.0,
        highest: 0.0,
    };
    let all = stretches.iter().map(|s| s.extremes(look_s)).fold(none, Extremes::with);
    let last = stretches.last();
    ResponseFigures {
        residual_displacement: last.map_or_else(Vec::new, |last| {
            let modes = plant.modes().iter().zip(&last.motion.states);
            modes
                .map(|(m, state)| m.share.abs() * last.motion.amplitude(&m.mode, state))
                .collect()
        }),
        highest: all.highest,
        lowest: all.lowest,
        deviation_after: last.map_or(0.0, |last| {
            let (tail, end) = (last.extremes(look_s), last.motion.command.position);
            (tail.highest - end).max(end - tail.lowest)
        }),
    }
}

/// Measures a unit step that is shaped by `impulses` (in order of time, the first at 0).
pub fn step_figures(plant: &Plant, impulses: &[Impulse]) -> StepFigures {
    let stretches = stretches(plant, &Trajectory::step(1.0).shaped(impulses));
    let residual = stretches.last().map_or_else(Vec::new, |last| {
        let modes = plant.modes().iter().zip(&last.motion.states);
        modes
            .map(|(m, state)| last.motion.amplitude(&m.mode, state) / free_amplitude(&m.mode, &Vector2::new(1.0, 0.0)))
            .collect()
    });
    let look_s = look_s(plant, &stretches);
    let peaks = stretches.iter().map(|s| s.extremes(look_s).highest);
    StepFigures {
        residual,
        overshoot: peaks.fold(1.0, f64::max) - 1.0,
    }
}

/// Response to a shaped unit step, for plotting: `(seconds, position)` at `points` equally spaced times from 0.
pub fn step_response(plant: &Plant, impulses: &[Impulse], duration_s: f64, points: usize) -> Vec<(f64, f64)> {
    response_curve(plant, &Trajectory::step(1.0).shaped(impulses), duration_s, points)
}

/// Response to a command, for plotting: `(seconds, position)` at `points` equally spaced times from 0.
pub fn response_curve(plant: &Plant, command: &Trajectory, duration_s: f64, points: usize) -> Vec<(f64, f64)> {
    let stretches = stretches(plant, command);
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

/// An interval without a jump of the command.
struct Stretch<'a> {
    start_s: f64,
    length_s: f64,
    motion: Motion<'a>,
}

/// Lowest and highest position of the plant.
#[derive(Debug, Clone, Copy)]
struct Extremes {
    lowest: f64,
    highest: f64,
}

impl Extremes {
    fn with(self, other: Self) -> Self {
        Self {
            lowest: self.lowest.min(other.lowest),
            highest: self.highest.max(other.highest),
        }
    }

    fn at(position: f64) -> Self {
        Self {
            lowest: position,
            highest: position,
        }
    }
}

/// Splits the response into intervals: from each jump to the next, and a tail after the last.
fn stretches<'a>(plant: &'a Plant, command: &Trajectory) -> Vec<Stretch<'a>> {
    let mut motion = Motion::at_rest(plant);
    let pieces = command.pieces();
    let ends_s = pieces.iter().skip(1).map(|p| p.start_s);
    let ends_s = ends_s.chain([command.end_s() + tail_s(plant)]);
    pieces
        .iter()
        .zip(ends_s)
        .map(|(piece, end_s)| {
            motion.jump(&piece.jump, piece.cubic);
            let stretch = Stretch {
                start_s: piece.start_s,
                length_s: end_s - piece.start_s,
                motion: motion.clone(),
            };
            motion.advance(stretch.length_s);
            stretch
        })
        .collect()
}

/// Time between two evaluations of the velocity, s.
fn look_s(plant: &Plant, stretches: &[Stretch<'_>]) -> f64 {
    let periods_s = plant.modes().iter().map(|m| 1.0 / m.mode.frequency_hz);
    let duration_s: f64 = stretches.iter().map(|s| s.length_s).sum();
    let looks_max = LOOKS_MAX / plant.modes().len().max(1) as f64;
    (periods_s.fold(f64::INFINITY, f64::min) / LOOKS_PER_PERIOD).max(duration_s / looks_max)
}

/// Time after the last impulse in which a peak is searched, s.
fn tail_s(plant: &Plant) -> f64 {
    let periods = if plant.modes().len() == 1 { 1.0 } else { TAIL_PERIODS };
    let each = plant.modes().iter().map(|m| {
        let settled_s = SETTLED / m.mode.decay();
        (periods * m.mode.damped_period_s()).min(settled_s)
    });
    each.fold(0.0, f64::max)
}

impl Stretch<'_> {
    /// Lowest and highest position in the interval, its ends included.
    fn extremes(&self, look_s: f64) -> Extremes {
        let looks = (self.length_s / look_s).ceil().clamp(1.0, LOOKS_MAX) as u32;
        let (start, velocity) = self.motion.ahead(0.0);
        let mut extremes = Extremes::at(start);
        let (mut before_s, mut rising) = (0.0, velocity > 0.0);
        for look in 1..=looks {
            let time_s = self.length_s * f64::from(look) / f64::from(looks);
            let (position, velocity) = self.motion.ahead(time_s);
            extremes = extremes.with(Extremes::at(position));
            if rising != (velocity > 0.0) {
                extremes = extremes.with(Extremes::at(self.turning_point(before_s, time_s, rising)));
                rising = !rising;
            }
            before_s = time_s;
        }
        extremes
    }

    /// Position at the instant in an interval at which the velocity changes its sign.
    fn turning_point(&self, mut before_s: f64, mut after_s: f64, rising: bool) -> f64 {
        // Each round halves the interval; 60 rounds exhaust the digits of a time.
        for _ in 0..60 {
            let middle_s = f64::midpoint(before_s, after_s);
            if (self.motion.ahead(middle_s).1 > 0.0) == rising {
                before_s = middle_s;
            } else {
                after_s = middle_s;
            }
        }
        self.motion.ahead(before_s).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_shaper::analysis::residual_vibration;
    use posicast_shaper::mode::Mode;

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
    fn unshaped_overshoot_is_the_closed_form() {
        for damping in [0.0, 0.01, 0.157799, 0.5, 0.9] {
            let figures = step_figures(&plant(&[(7.0, damping, 1.0)]), &UNSHAPED);
            let expected = (-std::f64::consts::PI * damping / (1.0 - damping * damping).sqrt()).exp();
            assert!((figures.overshoot - expected).abs() < 1e-12, "{damping}");
            assert!((figures.residual[0] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn measured_residual_is_the_pole_sum() {
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
    fn two_modes_peak_between_samples() {
        // 1 − ½cos t − ½cos 2t has its maximum at cos t = −1/4: 1 + 1/8 + 7/16.
        let figures = step_figures(&plant(&[(1.0, 0.0, 1.0), (2.0, 0.0, 1.0)]), &UNSHAPED);
        assert!((figures.overshoot - 0.5625).abs() < 1e-12, "{}", figures.overshoot);
    }

    #[test]
    fn step_response_starts_at_zero_and_ends_on_the_step() {
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
    fn ramp_and_move_solve_the_differential_equation() {
        // y″ + 2σy′ + ω²y = ω²u, checked by central differences on the curve itself.
        let mode = Mode {
            frequency_hz: 5.0,
            damping: 0.2,
        };
        let plant = plant(&[(5.0, 0.2, 1.0)]);
        let profile = crate::motion::Profile::new(0.0, 0.05, 0.3, 4.0, 90.0).unwrap();
        let commands = [
            Trajectory::ramp(0.7),
            Trajectory::trapezoid(0.05, 0.3, 4.0).unwrap(),
            Trajectory::of_profile(&profile),
        ];
        for command in commands {
            let points = 40_001;
            let curve = response_curve(&plant, &command, 0.4, points);
            let step_s = 0.4 / (points - 1) as f64;
            for at in (100..points - 100).step_by(997) {
                let [before, here, after] = [at - 1, at, at + 1].map(|k| curve[k].1);
                let acceleration = (after - 2.0 * here + before) / (step_s * step_s);
                let velocity = (after - before) / (2.0 * step_s);
                let stiffness = mode.omega() * mode.omega();
                let force = stiffness * (command.position(curve[at].0) - here) - 2.0 * mode.decay() * velocity;
                assert!(
                    (acceleration - force).abs() < 2e-3 * stiffness * 0.05,
                    "{at}: {acceleration} {force}"
                );
            }
        }
    }

    #[test]
    fn an_undamped_mode_trails_a_ramp_by_its_oscillation() {
        // y = vt − (v/ω) sin ωt
        let figures = response_figures(&plant(&[(2.0, 0.0, 1.0)]), &Trajectory::ramp(3.0));
        let amplitude = 3.0 / (2.0 * std::f64::consts::TAU);
        assert!((figures.residual_displacement[0] - amplitude).abs() < 1e-13);
    }

    #[test]
    fn residual_displacement_of_a_shaped_move_is_the_unshaped_one_times_the_residual() {
        // At an undamped mode: |S| · |amplitude of the unshaped move|, whatever the move.
        let plant = plant(&[(7.0, 0.0, 1.0), (12.0, 0.0, 3.0)]);
        let impulses: Vec<Impulse> = [(0.0, 0.3), (0.06, 0.7)]
            .map(|(time_s, amplitude)| Impulse { time_s, amplitude })
            .to_vec();
        let profile = crate::motion::Profile::new(0.0, 0.05, 0.3, 4.0, 90.0).unwrap();
        for command in [
            Trajectory::step(1.0),
            Trajectory::trapezoid(-0.05, 0.3, 4.0).unwrap(),
            Trajectory::of_profile(&profile),
        ] {
            let plain = response_figures(&plant, &command);
            let shaped = response_figures(&plant, &command.shaped(&impulses));
            for (k, m) in plant.modes().iter().enumerate() {
                let expected = plain.residual_displacement[k] * residual_vibration(&impulses, &m.mode);
                assert!((shaped.residual_displacement[k] - expected).abs() < 1e-13);
            }
            let sum: f64 = shaped.residual_displacement.iter().sum();
            assert!(shaped.deviation_after <= sum + 1e-13 && shaped.deviation_after > 0.9 * sum);
        }
    }

    #[test]
    fn absurd_plants_end() {
        let modes = [(1e-9, 0.0, 1.0), (1e9, 0.0, 1.0), (1.0, 1.0 - 1e-15, 1.0)];
        let figures = step_figures(&plant(&modes), &UNSHAPED);
        assert!(figures.overshoot.is_finite());
        assert_eq!(plant_figures(&plant(&[]), &UNSHAPED).nominal.overshoot, 0.0);
    }
}
