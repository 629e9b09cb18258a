//! Determines the number of modes in a log: one more is added as long as it explains more than noise would.

use super::held::HeldModes;
use crate::separable::{Effort, Gram, Separable, Solution, refine};
use nalgebra::{DMatrix, DVector};
use posicast_shaper::mode::Mode;

/// Largest number of modes that are sought.
const MOST: usize = 6;
/// Damping ratios at which a further mode is sought; the last only beside a motor, because drives damp its modes.
const TRIED_DAMPING: [f64; 3] = [0.015, 0.08, 0.3];
/// Number of periods in the log of the slowest mode that is sought; more beside a motor, whose motion as a whole is as
/// slow.
const LEAST_PERIODS: f64 = 2.0;
const LEAST_PERIODS_OF_MOTOR: f64 = 4.0;
/// Distance of the frequencies at which it is looked for.
const TRIED_STEP: f64 = 1.03;
/// Relative distance below which modes may represent one mode that has to be split.
const NEAR: f64 = 0.2;
/// Sum of squares that a further mode must explain, in variances of the noise: far above what its six unknowns
/// explain by chance.
pub(super) const LEAST_GAIN: f64 = 60.0;
/// Fraction of the response's power below which a remainder is rounding error.
pub(super) const ROUNDING: f64 = 1e-20;

/// Modes with the fit that gave them.
pub(super) struct Found {
    pub(super) modes: Vec<Mode>,
    pub(super) solution: Solution,
}

/// Adds modes that explain the rows, one after the other, to the known ones; `None` if there are too few rows for a
/// mode.
pub(super) fn search(problem: &HeldModes<'_>, known: &[Mode]) -> Option<Found> {
    let mut kept = refine(problem, &HeldModes::unknowns(known), Effort::Rough)?;
    let mut now = kept.clone();
    let mut idle = 0;
    let power = problem.measured().variance() * problem.len() as f64;
    while now.unknowns.len() < 2 * MOST && idle < 2 && kept.square > ROUNDING * power {
        let Some(next) = with_one_more(problem, &now) else {
            break;
        };
        let added = (next.unknowns.len() - kept.unknowns.len()) as f64 / 2.0;
        let better = kept.square - next.square > LEAST_GAIN * added * next.reduced_square();
        now = next;
        if better {
            kept = now.clone();
            idle = 0;
        } else {
            idle += 1;
        }
    }
    Some(Found {
        modes: HeldModes::modes(&kept.unknowns),
        solution: kept,
    })
}

fn with_one_more(problem: &HeldModes<'_>, fit: &Solution) -> Option<Solution> {
    let (gain, found) = strongest(problem, fit)?;
    // The gain is that of the best mode tried; at its optimum, the mode may explain several times as much.
    if gain < 0.25 * LEAST_GAIN * fit.reduced_square() {
        return None;
    }
    let modes = HeldModes::modes(&fit.unknowns);
    let mut starts = vec![[&modes[..], &[found]].concat()];
    for (k, mode) in modes.iter().enumerate() {
        if (mode.frequency_hz / found.frequency_hz).ln().abs() < NEAR {
            let at = |factor: f64| Mode {
                frequency_hz: mode.frequency_hz * factor,
                damping: 0.5 * mode.damping,
            };
            let mut split = modes.clone();
            split[k] = at(0.97);
            split.push(at(1.03));
            starts.push(split);
        }
    }
    let fits = starts
        .iter()
        .filter_map(|modes| refine(problem, &HeldModes::unknowns(modes), Effort::Rough));
    fits.min_by(|a, b| a.square.total_cmp(&b.square))
}

/// The mode that explains most of a fit's residual, without the part that the fit's columns absorb.
fn strongest(problem: &HeldModes<'_>, fit: &Solution) -> Option<(f64, Mode)> {
    let basis = problem.basis(&fit.unknowns);
    let gram = Gram::of(&basis)?;
    let residual = problem.measured() - &fit.fitted;
    let (least_periods, damping) = if problem.has_body() {
        (LEAST_PERIODS_OF_MOTOR, &TRIED_DAMPING[..])
    } else {
        (LEAST_PERIODS, &TRIED_DAMPING[..2])
    };
    let seconds = problem.row_s() * problem.len() as f64;
    let (lowest, highest) = (least_periods / seconds, 0.45 / problem.row_s());
    let steps = ((highest / lowest).ln() / TRIED_STEP.ln()) as i32;
    let tried = (0..=steps).flat_map(|step| {
        damping.iter().map(move |&damping| Mode {
            frequency_hz: lowest * TRIED_STEP.powi(step),
            damping,
        })
    });
    let gains = tried.map(|mode| (gain(problem, &basis, &gram, &residual, &mode), mode));
    gains.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn gain(problem: &HeldModes<'_>, basis: &DMatrix<f64>, gram: &Gram, residual: &DVector<f64>, mode: &Mode) -> f64 {
    let columns = problem.mode_columns(mode);
    let shared = gram.solve(&basis.tr_mul(&columns));
    let own = columns - basis * shared;
    let products = own.tr_mul(residual);
    Gram::of(&own).map_or(0.0, |gram| products.dot(&gram.solve_one(&products)))
}
