//! The best of a firmware's own shapers, for firmware that cannot take the modes themselves.
//!
//! The search over kinds, frequencies and damping ratios minimises the ringing after a jump of the acceleration ([`ringing_left`]), with
//! every mode's frequency off by up to ±5 %. If several axes share a shaper, the axis with the most ringing counts.
//!
//! ```text
//! frequencies from half the lowest to twice the highest mode, in steps of 1 %; damping ratios 0, 0.1 and those of the modes
//! ─► the best of each kind, its neighbours in ever smaller steps ─► rounded to 0.1 Hz and 0.001
//! ```

use crate::analysis::{WeightedMode, residual_vibration, ringing_left, ringing_left_by};
use crate::impulse::{Impulse, ImpulseSequence};

/// Relative error of the modes' frequencies.
pub const BAND: f64 = 0.05;
/// Steps of the written frequency in Hz and of the written damping ratio.
const WRITTEN: [f64; 2] = [0.1, 0.001];
/// Ratio of two frequencies of the first search.
const STEP: f64 = 1.01;
/// Number of frequencies at which a mode's residual is computed during the search.
const LOOKS: u32 = 10;
/// Halvings of the steps of the second search.
const HALVINGS: u32 = 8;

/// A kind of a firmware.
pub struct OwnKind<'a> {
    /// Name that the user writes or reads.
    pub name: String,
    /// Damping ratios that the kind takes, smallest and largest.
    pub damping: [f64; 2],
    /// Frequencies that it takes in Hz, lowest and highest.
    pub frequency_hz: [f64; 2],
    /// The impulses that the firmware makes of a frequency in Hz and a damping ratio.
    pub impulses: Box<dyn Fn(f64, f64) -> Option<ImpulseSequence> + 'a>,
}

/// A shaper of the firmware's own.
#[derive(Debug, Clone, PartialEq)]
pub struct Closest {
    /// Index of the kind among the candidates.
    pub candidate: usize,
    /// Frequency in Hz, as it is written.
    pub frequency_hz: f64,
    /// Damping ratio, as it is written.
    pub damping: f64,
    /// Its impulses.
    pub impulses: ImpulseSequence,
    /// The part of the ringing that it leaves.
    pub left: f64,
}

/// The best frequency and damping ratio of each candidate, the best candidate first; of those within a hundredth of the ringing, the shortest. `damping` fixes the
/// damping ratio. Candidates that make no shaper are left out.
pub fn closest(candidates: &[OwnKind<'_>], axes: &[Vec<WeightedMode>], damping: Option<f64>) -> Vec<Closest> {
    let mut found: Vec<Closest> = candidates
        .iter()
        .enumerate()
        .filter_map(|(index, candidate)| best(index, candidate, axes, damping))
        .collect();
    found.sort_by(|a, b| a.left.total_cmp(&b.left));
    found
}

/// The part of the ringing that impulses leave: of several axes, the largest.
pub fn left(impulses: &[Impulse], axes: &[Vec<WeightedMode>]) -> f64 {
    axes.iter()
        .map(|modes| ringing_left(impulses, modes, BAND))
        .fold(0.0, f64::max)
}

/// As [`left`], at a few frequencies of each band.
fn roughly(impulses: &[Impulse], axes: &[Vec<WeightedMode>]) -> f64 {
    let worst = |mode: &crate::mode::Mode| {
        let at = |look: u32| 1.0 - BAND + 2.0 * BAND * f64::from(look) / f64::from(LOOKS);
        (0..=LOOKS)
            .map(|look| residual_vibration(impulses, &mode.scaled(at(look))))
            .fold(0.0, f64::max)
    };
    axes.iter()
        .map(|modes| ringing_left_by(modes, worst))
        .fold(0.0, f64::max)
}

fn best(index: usize, candidate: &OwnKind<'_>, axes: &[Vec<WeightedMode>], fixed: Option<f64>) -> Option<Closest> {
    let modes = || axes.iter().flatten().map(|weighted| weighted.mode);
    let lowest = modes().map(|mode| mode.frequency_hz).fold(f64::INFINITY, f64::min);
    let highest = modes().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    let [from, to] = candidate.frequency_hz;
    let (from, to) = ((0.5 * lowest).max(from), (2.0 * highest).min(to));
    let [least, most] = candidate.damping;
    if modes().next().is_none() || from > to || fixed.is_some_and(|damping| !(least..=most).contains(&damping)) {
        return None;
    }
    let cost = |point: [f64; 2]| {
        let [frequency_hz, damping] = point;
        let fits = (from..=to).contains(&frequency_hz) && (least..=most).contains(&damping);
        let impulses = fits.then(|| (candidate.impulses)(frequency_hz, damping)).flatten();
        impulses.map_or(f64::INFINITY, |impulses| roughly(impulses.impulses(), axes))
    };
    let dampings: Vec<f64> = match fixed {
        Some(damping) => vec![damping],
        None => modes()
            .map(|mode| mode.damping)
            .chain([0.0, 0.1])
            .map(|damping| damping.clamp(least, most))
            .collect(),
    };
    let frequencies = std::iter::successors(Some(from), |frequency| Some(frequency * STEP)).take_while(|f| *f <= to);
    let start = frequencies
        .flat_map(|frequency| dampings.iter().map(move |damping| [frequency, *damping]))
        .map(|point| (point, cost(point)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, cost)| cost.is_finite())?;
    let steps = [start.0[0] * (STEP - 1.0), if fixed.is_some() { 0.0 } else { 0.02 }];
    let (fine, _) = descend(start, steps, &cost);
    let written = descend_on_grid(fine, fixed, &cost);
    let impulses = (candidate.impulses)(written[0], written[1])?;
    Some(Closest {
        candidate: index,
        frequency_hz: written[0],
        damping: written[1],
        left: left(impulses.impulses(), axes),
        impulses,
    })
}

/// Goes to a better neighbour while there is one, then halves the steps.
fn descend(start: ([f64; 2], f64), mut steps: [f64; 2], cost: &dyn Fn([f64; 2]) -> f64) -> ([f64; 2], f64) {
    let mut best = start;
    let mut halvings = 0;
    while halvings < HALVINGS {
        let ([frequency, damping], _) = best;
        let neighbours = [
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, 1.0),
            (0.0, -1.0),
            (1.0, 1.0),
            (-1.0, -1.0),
        ];
        let better = neighbours
            .iter()
            .map(|(f, d)| [frequency + f * steps[0], damping + d * steps[1]])
            .map(|point| (point, cost(point)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, cost)| *cost < best.1);
        match better {
            Some(better) => best = better,
            None => {
                steps = steps.map(|step| 0.5 * step);
                halvings += 1;
            }
        }
    }
    best
}

/// The best of the written values around a point.
fn descend_on_grid(point: [f64; 2], fixed: Option<f64>, cost: &dyn Fn([f64; 2]) -> f64) -> [f64; 2] {
    let near = |value: f64, step: f64| {
        let whole = (value / step).round();
        // Dividing by the reciprocal gives the number that is nearest to its decimals.
        [-1.0, 0.0, 1.0].map(|offset| (whole + offset) / (1.0 / step).round())
    };
    let dampings = match fixed {
        Some(damping) => vec![damping],
        None => near(point[1], WRITTEN[1]).to_vec(),
    };
    let choices = near(point[0], WRITTEN[0])
        .into_iter()
        .flat_map(|frequency| dampings.iter().map(move |damping| [frequency, *damping]));
    choices
        .map(|choice| (choice, cost(choice)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, cost)| cost.is_finite())
        .map_or(point, |(choice, _)| choice)
}
