//! One known move: the axis's shaper behind the fastest move, beside a move whose jerk time is a period of a mode.
//!
//! A jerk-limited move is a jump of the position that is convolved with three boxes, each of integral 1:
//!
//! ```text
//! t_1 = d/v,  t_2 = v/a,  t_3 = a/j      total t_1 + t_2 + t_3
//! a box of t leaves (1 − e^(−pt))/(pt) of a mode,  p = ω(ζ + j√(1−ζ²))
//! ```
//!
//! so a box of one damped period leaves no vibration of an undamped mode, and a move with such a jerk time needs no shaper. Its price
//! is the time of that box. Three lengths `s_1 ≥ s_2 ≥ s_3` have the peaks `d/s_1`, `d/(s_1 s_2)` and `d/(s_1 s_2 s_3)`, which the
//! limits bound.

use super::profile::{Profile, motion_limits};
use crate::machine_file::AxisSection;
use nalgebra::Complex;
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::impulse::Impulse;
use posicast_shaper::mode::{Mode, ModeBand};

/// Number of frequencies of a band at which a residual is computed.
const LOOKS: u32 = 200;
/// Relative slack of a limit, for products that are equal to it but for rounding.
const SLACK: f64 = 1.0 + 1e-12;

/// A way to make a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveFigures {
    /// Time of the motion command in seconds.
    pub command_s: f64,
    /// Time that the shaper adds in seconds.
    pub shaper_s: f64,
    /// Largest amplitude of a mode at the end, in m or rad, over the frequencies of the bands that were tried.
    pub residual: f64,
}

impl MoveFigures {
    /// Time from the beginning to the end in seconds.
    pub fn total_s(&self) -> f64 {
        self.command_s + self.shaper_s
    }
}

/// A move whose jerk time is a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodMove {
    /// Index of the mode whose period it is.
    pub mode: usize,
    /// The period in seconds.
    pub jerk_s: f64,
    /// Largest velocity, acceleration and jerk.
    pub peaks: [f64; 3],
    /// Its time and residual.
    pub figures: MoveFigures,
}

/// One move of an axis in both ways.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveComparison {
    /// The fastest move within the limits, and the axis's shaper.
    pub shaped: MoveFigures,
    /// The moves whose jerk time is the period of a mode, in the order of the modes.
    pub by_period: Vec<PeriodMove>,
    /// Tolerated residual in m or rad: the smallest tolerance times the most that the fastest move can excite without a shaper.
    pub tolerated: f64,
}

/// The better of two ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BetterMove {
    /// The shaper.
    Shaped,
    /// The move with this index of [`MoveComparison::by_period`].
    ByPeriod(usize),
}

impl MoveComparison {
    /// Returns the shortest way within the tolerated residual; `None` if every way exceeds it.
    pub fn better(&self) -> Option<BetterMove> {
        let ways = std::iter::once((BetterMove::Shaped, self.shaped));
        let periods = self.by_period.iter().enumerate();
        let ways = ways.chain(periods.map(|(index, found)| (BetterMove::ByPeriod(index), found.figures)));
        let enough = ways.filter(|(_, figures)| figures.residual <= self.tolerated * (1.0 + 1e-6));
        let shortest = enough.min_by(|a, b| a.1.total_s().total_cmp(&b.1.total_s()));
        shortest.map(|(way, _)| way)
    }
}

/// Compares both ways for a move of `distance` in m or rad at a velocity of at most `velocity`, with the axis's other limits and the
/// taps of its shaper as impulses. Without modes nothing has to be suppressed; the list of periods is then empty.
pub fn compare_move(axis: &AxisSection, taps: &[Impulse], distance: f64, velocity: f64) -> Option<MoveComparison> {
    let [_, acceleration, jerk] = motion_limits(axis.limits.as_ref());
    let size = distance.abs();
    let profile = Profile::new(0.0, size, velocity, acceleration, jerk).ok()?;
    let [jerk_s, constant_s, cruise_s] = profile.stretches_s();
    let boxes = [2.0 * jerk_s + constant_s + cruise_s, jerk_s + constant_s, jerk_s];
    let modes: Vec<(ModeBand, f64)> = axis
        .modes
        .iter()
        .map(|mode| (mode.band(), axis.shaped().tolerance_of(mode)))
        .collect();
    let shaped = worst(&modes, |mode| {
        size * left_by_boxes(&boxes, mode) * residual_vibration(taps, mode)
    });
    let tolerated = modes
        .iter()
        .map(|(band, tolerance)| tolerance * size * excited(&boxes, band));
    let by_period = axis.modes.iter().enumerate().filter_map(|(index, mode)| {
        let period_s = mode.mode.damped_period_s();
        let boxes = least_boxes(size, [velocity, acceleration, jerk], period_s)?;
        let [first, second, third] = sorted(boxes);
        Some(PeriodMove {
            mode: index,
            jerk_s: period_s,
            peaks: [size / first, size / (first * second), size / (first * second * third)],
            figures: MoveFigures {
                command_s: boxes.iter().sum(),
                shaper_s: 0.0,
                residual: worst(&modes, |mode| size * left_by_boxes(&boxes, mode)),
            },
        })
    });
    Some(MoveComparison {
        shaped: MoveFigures {
            command_s: profile.duration_s(),
            shaper_s: taps.last().map_or(0.0, |impulse| impulse.time_s),
            residual: shaped,
        },
        by_period: by_period.collect(),
        tolerated: tolerated.fold(f64::INFINITY, f64::min),
    })
}

/// Returns the largest residual over all bands, at the frequencies that are tried and at both ends of the damping.
fn worst(modes: &[(ModeBand, f64)], residual: impl Fn(&Mode) -> f64) -> f64 {
    let mut worst = 0.0f64;
    for (band, _) in modes {
        let [low, high] = band.frequency_hz;
        for look in 0..=LOOKS {
            let frequency_hz = low + (high - low) * f64::from(look) / f64::from(LOOKS);
            for damping in band.damping {
                worst = worst.max(residual(&Mode { frequency_hz, damping }));
            }
        }
    }
    worst
}

/// Returns the residual of a mode at the end of these boxes, as a fraction of the jump.
fn left_by_boxes(boxes: &[f64; 3], mode: &Mode) -> f64 {
    let pole = Complex::new(mode.decay(), mode.omega_damped());
    let left = boxes.iter().filter(|length_s| **length_s > 0.0).map(|length_s| {
        let angle = pole * *length_s;
        (Complex::new(1.0, 0.0) - (-angle).exp()) / angle
    });
    left.product::<Complex<f64>>().norm()
}

/// Returns the largest residual of a mode in a band after boxes of nearly these lengths, as a fraction of the jump: the product of
/// `2/(ωt)`, at most 1, for each.
fn excited(boxes: &[f64; 3], band: &ModeBand) -> f64 {
    let omega = std::f64::consts::TAU * band.frequency_hz[0];
    boxes
        .iter()
        .map(|length_s| (2.0 / (omega * length_s)).min(1.0))
        .product()
}

fn sorted(mut boxes: [f64; 3]) -> [f64; 3] {
    boxes.sort_by(|a, b| b.total_cmp(a));
    boxes
}

/// Returns the three boxes of the shortest move within the limits, given the length of one box; `None` for numbers that are not finite.
///
/// The sum of the other two is least at a corner of the region that the limits allow or, where only their product is bounded, with both
/// equal. So it is the best of a few candidates.
fn least_boxes(distance: f64, [velocity, acceleration, jerk]: [f64; 3], given: f64) -> Option<[f64; 3]> {
    let is_allowed = |boxes: [f64; 3]| {
        let [first, second, third] = sorted(boxes);
        distance <= velocity * first * SLACK
            && distance <= acceleration * first * second * SLACK
            && distance <= jerk * first * second * third * SLACK
    };
    let by_acceleration = distance / acceleration;
    let by_jerk = distance / (jerk * given);
    let firsts = [
        given,
        distance / velocity,
        by_acceleration / given,
        by_acceleration.sqrt(),
        by_jerk.sqrt(),
    ];
    let pairs = firsts.into_iter().flat_map(|first| {
        let seconds = [
            given,
            by_acceleration / first,
            by_jerk / first,
            by_acceleration / given,
            first,
        ];
        seconds.into_iter().map(move |second| [first, second, given])
    });
    let allowed =
        pairs.filter(|boxes| boxes.iter().all(|length| length.is_finite() && *length > 0.0) && is_allowed(*boxes));
    allowed.min_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum::<f64>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: [f64; 3] = [0.2, 4.0, 300.0];

    /// The least sum of two boxes beside a given one, on a grid of their logarithms.
    fn least_on_grid(distance: f64, given: f64) -> f64 {
        let [velocity, acceleration, jerk] = LIMITS;
        let steps = 900;
        let at = |step: i32| 1e-4 * 1.013f64.powi(step);
        let mut least = f64::INFINITY;
        for first in 0..steps {
            for second in 0..=first {
                let boxes = [at(first), at(second), given];
                let [a, b, c] = sorted(boxes);
                if distance <= velocity * a && distance <= acceleration * a * b && distance <= jerk * a * b * c {
                    least = least.min(boxes.iter().sum());
                    break;
                }
            }
        }
        least
    }

    #[test]
    fn the_boxes_are_the_shortest_within_the_limits() {
        for distance in [1e-6, 1e-4, 2e-3, 0.05, 1.0] {
            for given in [1e-3, 0.02, 0.3] {
                let found: f64 = least_boxes(distance, LIMITS, given).unwrap().iter().sum();
                let on_grid = least_on_grid(distance, given);
                assert!(found <= on_grid * (1.0 + 1e-9), "{distance} {given}: {found} {on_grid}");
                assert!(found >= on_grid * 0.98, "{distance} {given}: {found} {on_grid}");
            }
        }
    }

    #[test]
    fn a_period_as_jerk_time_leaves_nothing_of_an_undamped_mode() {
        let mode = Mode {
            frequency_hz: 25.0,
            damping: 0.0,
        };
        let boxes = [0.31, 0.07, mode.damped_period_s()];
        assert!(left_by_boxes(&boxes, &mode) < 1e-15);
        // Half a period leaves 2/π of a step.
        let half = [mode.damped_period_s() / 2.0, 0.0, 0.0];
        assert!((left_by_boxes(&half, &mode) - 2.0 / std::f64::consts::PI).abs() < 1e-12);
    }

    #[test]
    fn boxes_leave_what_impulses_close_together_leave() {
        let mode = Mode {
            frequency_hz: 13.0,
            damping: 0.08,
        };
        let count = 4000;
        let length_s = 0.061;
        let impulses: Vec<Impulse> = (0..count)
            .map(|index| Impulse {
                time_s: length_s * (f64::from(index) + 0.5) / f64::from(count),
                amplitude: 1.0 / f64::from(count),
            })
            .collect();
        let expected = residual_vibration(&impulses, &mode);
        let found = left_by_boxes(&[length_s, 0.0, 0.0], &mode);
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
}
