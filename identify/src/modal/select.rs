//! Determines the number of modes: one more is added as long as it explains more than noise would.

use super::ResponsePoint;
use super::fit::{Fit, Gains, Phase, Pole, refine};
use crate::found::FoundMode;
use crate::parallel::mapped;
use crate::separable::Effort;

/// Largest number of poles that are sought.
const MOST: usize = 8;
/// Damping ratios at which a further pole is sought.
const TRIED_DAMPING: [f64; 3] = [0.01, 0.04, 0.15];
/// Ratio of neighbouring frequencies at which it is sought.
const TRIED_STEP: f64 = 1.015;
/// The search uses every point with this stride.
const STRIDE: usize = 3;
/// Relative distance below which poles may represent one pole that has to be split.
const NEAR: f64 = 0.2;
/// Sum of squares that a further pole must explain, in variances of the noise: far above what six unknowns explain by
/// chance.
const LEAST_GAIN: f64 = 80.0;

/// Adds poles that explain the points, one after the other; `None` if there are too few points for a pole.
pub(crate) fn select(points: &[ResponsePoint], phase: Phase) -> Option<Fit> {
    Some(grown(points, refine(points, &[], phase, Effort::Rough)?))
}

/// Returns a fit with the further poles that the points need.
pub(crate) fn grown(points: &[ResponsePoint], fit: Fit) -> Fit {
    let (mut kept, mut fit, mut idle) = (fit.clone(), fit, 0);
    while fit.poles.len() < MOST && idle < 2 {
        let Some(next) = with_one_more(points, &fit) else { break };
        // A pole that explains little may enable the next, which explains much.
        let better = kept.square - next.square
            > LEAST_GAIN * next.reduced_square().max(1.0) * (next.poles.len() - kept.poles.len()) as f64;
        fit = next;
        if better {
            kept = fit.clone();
            idle = 0;
        } else {
            idle += 1;
        }
    }
    kept
}

/// Returns a fit without unnecessary poles, which explain no more beside the others than noise might.
pub(crate) fn pruned(points: &[ResponsePoint], fit: Fit) -> Fit {
    /// Multiple of the required gain above which a rough fit without a pole shows that the pole is necessary.
    const FAR: f64 = 20.0;
    let mut kept = fit;
    loop {
        let least_gain = LEAST_GAIN * kept.reduced_square().max(1.0);
        let without = |k: usize| {
            let mut poles = kept.poles.clone();
            poles.remove(k);
            let rough = refine(points, &poles, kept.phase, Effort::Rough)?;
            // A fit that misses by far when it has nearly converged will still miss after converging.
            if rough.square - kept.square > FAR * least_gain {
                return None;
            }
            refine(points, &rough.poles, rough.phase, Effort::Full)
        };
        let better = |a: &Fit, b: &Fit| a.square.total_cmp(&b.square);
        let each: Vec<usize> = (0..kept.poles.len()).collect();
        match mapped(&each, |&k| without(k)).into_iter().flatten().min_by(better) {
            Some(best) if best.square - kept.square < least_gain => kept = best,
            _ => return kept,
        }
    }
}

fn with_one_more(points: &[ResponsePoint], fit: &Fit) -> Option<Fit> {
    let (gain, found) = strongest(points, fit)?;
    // The gain is a lower bound of what the pole explains, which may be a few times as much.
    if gain * (STRIDE as f64) < 0.25 * LEAST_GAIN * fit.reduced_square().max(1.0) {
        return None;
    }
    let mut starts = vec![added(&fit.poles, found)];
    for (k, pole) in fit.poles.iter().enumerate() {
        if (pole.frequency_hz / found.frequency_hz).ln().abs() < NEAR {
            let mut split = fit.poles.clone();
            let at = |factor: f64| Pole {
                frequency_hz: pole.frequency_hz * factor,
                damping: 0.5 * pole.damping,
            };
            split[k] = at(0.97);
            split.push(at(1.03));
            starts.push(split);
        }
    }
    let fits = starts
        .iter()
        .filter_map(|start| refine(points, start, fit.phase, Effort::Rough));
    fits.min_by(|a, b| a.square.total_cmp(&b.square))
}

fn added(poles: &[Pole], pole: Pole) -> Vec<Pole> {
    let mut poles = poles.to_vec();
    poles.push(pole);
    poles
}

/// Share of all ringing for which [`Visible::from_hz`] is reported.
pub const TOLD_RINGING: f64 = 0.05;

/// Further modes below the lowest that the log would have shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Visible {
    /// Frequency in Hz above which a mode would have been found if it rang with [`TOLD_RINGING`] of the ringing of all modes found.
    pub from_hz: f64,
    /// Frequency in Hz, at most `from_hz`, at which a mode must ring most to be found.
    pub least_at_hz: f64,
    /// Ringing that a mode needs at that frequency to be found, over that of all modes found.
    pub least_ringing: f64,
}

/// Returns which further mode the points would have shown beside these modes; `None` without modes. The slower a mode is, the smaller is
/// its share of the response for the same ringing, and the weaker is its excitation.
pub(crate) fn visible(points: &[ResponsePoint], fit: &Fit, modes: &[FoundMode]) -> Option<Visible> {
    /// Damping ratio of the mode that would have been found.
    const DAMPING: f64 = 0.04;
    /// Ratio of neighbouring frequencies that are examined.
    const STEP: f64 = 1.02;
    let whole: f64 = modes.iter().map(|found| found.ringing(1.0)).sum();
    modes.first()?;
    let (low, high) = (points.first()?.frequency_hz, points.last()?.frequency_hz);
    let gains = Gains::new(points, fit, STRIDE);
    let least_ringing = |frequency_hz: f64| {
        let mode = Pole {
            frequency_hz,
            damping: DAMPING,
        };
        let gain = gains.of_unit_share(&mode) * STRIDE as f64;
        let share = (LEAST_GAIN * fit.reduced_square().max(1.0) / gain.max(f64::MIN_POSITIVE)).sqrt();
        share / (std::f64::consts::TAU * frequency_hz).powi(2) / whole
    };
    let steps = ((high / low).ln() / STEP.ln()).max(0.0) as i32;
    let tried = || (0..=steps).map(|step| (high / STEP.powi(step), least_ringing(high / STEP.powi(step))));
    let seen = tried().take_while(|(_, ringing)| *ringing < TOLD_RINGING);
    let from_hz = seen.last().map_or(high, |(frequency_hz, _)| frequency_hz);
    let below = tried().filter(|(frequency_hz, _)| *frequency_hz <= from_hz);
    let (least_at_hz, least_ringing) = below.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Visible {
        from_hz,
        least_at_hz,
        least_ringing,
    })
}

/// The pole that explains most of a fit's residual.
fn strongest(points: &[ResponsePoint], fit: &Fit) -> Option<(f64, Pole)> {
    let gains = Gains::new(points, fit, STRIDE);
    let (low, high) = (points.first()?.frequency_hz, points.last()?.frequency_hz);
    let steps = ((high / low).ln() / TRIED_STEP.ln()) as i32;
    let tried = (0..=steps).flat_map(|step| {
        TRIED_DAMPING.map(|damping| Pole {
            frequency_hz: low * TRIED_STEP.powi(step),
            damping,
        })
    });
    tried
        .map(|pole| (gains.of(&pole), pole))
        .max_by(|a, b| a.0.total_cmp(&b.0))
}
