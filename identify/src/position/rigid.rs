//! Logs that seem to contain a mode but do not: a rigid axis with a delay, or a tone that does not decay. Also finds
//! the rows at rest before an impact, and the flat tops of a saturated sensor.

use super::held::HeldModes;
use super::search::{Found, LEAST_GAIN};
use crate::separable::{Effort, refine};
use crate::signal::{PositionLog, within};
use nalgebra::DVector;
use posicast_shaper::mode::Mode;

/// Longest delay that is tried, in samples.
const LONGEST_DELAY: usize = 64;

/// Returns the delay in samples of an axis that follows its command rigidly, if this explains a log as well as modes
/// do.
///
/// ```text
/// y(k) = g·u(k−delay) + h·u(k−delay−1) + offset
/// ```
///
/// The first rows, whose command lies before the log, are ignored in both cases.
pub(super) fn rigid_delay(
    log: &PositionLog,
    decimation: usize,
    found: &Found,
    residual: &DVector<f64>,
) -> Option<usize> {
    let modes = found.modes.len();
    let longest = LONGEST_DELAY.min(log.response.len() / 8);
    if modes == 0 || log.command.is_empty() {
        return None;
    }
    let delays = (1..=longest).filter_map(|delay| {
        let late = PositionLog {
            sample_s: log.sample_s,
            between: log.between,
            command: log.command[..log.command.len() - delay].to_vec(),
            response: log.response[delay..].to_vec(),
            missing: within(&log.missing, delay..log.response.len()),
        };
        let problem = HeldModes::new(&late, 0..late.response.len(), decimation);
        if !problem.is_forced() {
            return None;
        }
        let square = refine(&problem, &[], Effort::Rough)?.square;
        Some((square / problem.len() as f64, delay))
    });
    let (variance, delay) = delays.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let first = longest / decimation + 1;
    let rows = residual.len().saturating_sub(first).max(1);
    let left = residual.iter().skip(first).map(|x| x * x).sum::<f64>() / rows as f64;
    let explained = rows as f64 * (variance / left).ln();
    let is_rigid = explained.is_nan() || explained < LEAST_GAIN * modes as f64;
    is_rigid.then_some(delay)
}

/// Sample at which a response that was at rest begins to ring; 0 if it rings from the start.
pub(super) fn onset(response: &[f64]) -> usize {
    /// Fractions of the largest distance from the first samples: above the first the ringing begins; below the second
    /// the response counts as at rest.
    const BEGINS: f64 = 0.3;
    const IS_QUIET: f64 = 0.06;
    /// Number of samples at rest needed to find a beginning, and largest fraction of the log before it.
    const QUIET: usize = 16;
    const MOST: f64 = 0.75;
    let Some(first) = response.get(..QUIET) else {
        return 0;
    };
    let level = first.iter().sum::<f64>() / QUIET as f64;
    let farthest = response.iter().map(|y| (y - level).abs()).fold(0.0, f64::max);
    let Some(begin) = response.iter().position(|y| (y - level).abs() > BEGINS * farthest) else {
        return 0;
    };
    let quiet = &response[..begin * 3 / 4];
    let square: f64 = quiet.iter().map(|y| (y - level).powi(2)).sum();
    let is_quiet = begin >= QUIET
        && (begin as f64) < MOST * response.len() as f64
        && (square / quiet.len() as f64).sqrt() < IS_QUIET * farthest;
    if !is_quiet {
        return 0;
    }
    // From its first reversal on, the machine moves freely.
    let way = (response[begin] - level).signum();
    let turn = response[begin..]
        .windows(2)
        .position(|pair| (pair[1] - pair[0]) * way <= 0.0);
    begin + turn.unwrap_or(0)
}

/// Marks the samples of a response that are at its extremes again and again, because the true value lies beyond them.
/// Marks none if there are no such samples, or if they are most of the log, as for an axis that moves back and forth
/// between two positions.
pub(super) fn clipped(response: &[f64]) -> Vec<bool> {
    /// Number of consecutive samples at an extreme that is too large for a coincidence, number of such runs, and
    /// largest fraction of the samples of a log at its extremes.
    const LEAST: usize = 4;
    const RUNS: usize = 3;
    const MOST: f64 = 0.6;
    let (low, high) = response
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    let mut clipped = Vec::new();
    let mut runs = 0;
    for run in response.chunk_by(|a, b| a == b) {
        let is_clipped = run[0] == low || run[0] == high;
        runs += usize::from(is_clipped && run.len() >= LEAST);
        clipped.extend(std::iter::repeat_n(is_clipped, run.len()));
    }
    let samples = clipped.iter().filter(|clipped| **clipped).count() as f64;
    if runs >= RUNS && samples < MOST * response.len() as f64 {
        clipped
    } else {
        vec![false; response.len()]
    }
}

/// Whether a mode of a fit is a tone: it keeps its amplitude where nothing drives it, or has no damping at all.
pub(super) fn is_tone(mode: &Mode, is_forced: bool, seconds: f64) -> bool {
    /// Damping ratio below that of any machine, and smallest decrease of the amplitude during a log that shows a decay.
    const UNDAMPED: f64 = 1e-4;
    const DECREASE: f64 = 0.1;
    if is_forced {
        mode.damping < UNDAMPED
    } else {
        mode.decay() * seconds < DECREASE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_begins_where_it_is_struck() {
        let ring = |n: usize| (-0.01 * n as f64).exp() * (0.2 * n as f64).cos();
        let from_the_first: Vec<f64> = (0..500).map(ring).collect();
        assert_eq!(onset(&from_the_first), 0);
        let struck: Vec<f64> = (0..500).map(|n| if n < 100 { 0.0 } else { ring(n - 100) }).collect();
        assert_eq!(onset(&struck), 100);
        assert_eq!((onset(&[1.0; 100]), onset(&[]), onset(&[0.0; 5])), (0, 0, 0));
    }
}
