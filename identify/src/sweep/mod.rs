//! Finds modes in an accelerometer log of a resonance test.
//!
//! The log does not contain the excitation. Its description ([`Sweep`]) is known; what the description leaves open, the start time and the
//! order of its quarter periods, is found by trying.

mod begin;
mod choose;
mod crossing;
mod excitation;
mod find;
mod first;
mod follow;
mod line;
mod measure;
mod modes;
mod record;
mod reduce;
mod transfer;
mod wave;

pub use crate::modal::{TOLD_RINGING, Visible};
pub use excitation::{QuarterOrder, Rise, SquareWave, Sweep, Sweeping, SweptAcceleration};
pub use transfer::{Band, Transfer};

use crate::found::FoundMode;
use crate::signal::AccelerationLog;
use choose::likelier;
use follow::{Followed, Known, Look, Pass};
use nalgebra::Complex;
use posicast_shaper::mode::Mode;
use reduce::Reduced;
use thiserror::Error;

/// Result for an accelerometer log of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundInSweep {
    /// The modes, sorted by frequency.
    pub modes: Vec<FoundMode>,
    /// Frequencies in Hz of narrow poles at the ends of the covered band: they may be modes, or errors at the ends of the transfer
    /// function.
    pub doubtful_hz: Vec<f64>,
    /// Name of the sensor direction that was used.
    pub direction: String,
    /// The sweep that was used.
    pub sweep: Sweep,
    /// Whether it was estimated from the log.
    pub is_estimated: bool,
    /// Gain of the sensor's acceleration relative to that of the sweep at the lowest frequencies: 1 if `acceleration_per_hz` is right.
    pub static_gain: f64,
    /// The square wave beside the sweep, if there is one.
    pub wave: Option<SquareWave>,
    /// Bands in which the axis was shaken while samples are missing: modes there are not found.
    pub unseen: Vec<Band>,
    /// Time from the first sample to the start of the sweep, in seconds; negative if the log begins later.
    pub start_s: f64,
    /// Relative amount by which the log's clock runs faster than that of the sweep: 1e-4 is 10 ms in 100 s. 0 where
    /// it was not corrected.
    pub clock_error: f64,
    /// Order of the quarter periods that fits the log.
    pub order: QuarterOrder,
    /// Way in which the frequency rises that fits the log.
    pub rise: Rise,
    /// The frequencies at which the axis was shaken during the log; modes outside are not reported.
    pub covered: Band,
    /// Further modes below the lowest that the log would have shown; `None` without modes.
    pub visible: Option<Visible>,
    /// The measured transfer function.
    pub transfer: Transfer,
    /// The fitted transfer function, at the same points.
    pub fitted: Vec<Complex<f64>>,
    /// Sum of squares of the residuals relative to the noise: 1 if only noise is left.
    pub reduced_square: f64,
}

impl FoundInSweep {
    /// Whether a mode's resonance reaches beyond the covered band, so that only one side of it was measured.
    pub fn is_at_end(&self, found: &FoundMode) -> bool {
        let Mode { frequency_hz, damping } = found.mode;
        let half_hz = damping * frequency_hz;
        frequency_hz - half_hz < self.covered.low_hz || frequency_hz + half_hz > self.covered.high_hz
    }
}

/// Why no modes of a sweep are found in a log.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SweepError {
    /// There are too few samples.
    #[error("the log has {samples} samples, {seconds:.2} s: a sweep needs at least 2 s")]
    Short {
        /// Number of samples.
        samples: usize,
        /// Duration in seconds.
        seconds: f64,
    },
    /// The description of the sweep is invalid.
    #[error("a sweep from {} to {} Hz at {} Hz/s with {} m/s² per Hz is not possible: all must be finite and above 0, the second frequency above the first and below half the rate of the samples", .0.start_hz, .0.end_hz, .0.rate_hz_per_s, .0.acceleration_per_hz)]
    Description(Sweep),
    /// No direction follows the sweep; the value is the fraction that the sweep explains.
    #[error("no direction of the sensor follows the sweep: it explains at most {:.1} % of the log", 100.0 * .0)]
    Unrelated(f64),
    /// The log has neither end of the sweep.
    #[error(
        "the log contains only a piece of this sweep, from {:.1} to {:.1} Hz, without its beginning and its end: it was another sweep, \
         or the log was cut",
        .0.low_hz, .0.high_hz
    )]
    Piece(Band),
    /// The log follows the sweep in a way that modes do not explain.
    #[error("the fitted modes explain only {:.0} % of the response to this sweep: it was another sweep, or the machine is far from linear", 100.0 * .0)]
    Unlike(f64),
    /// The transfer function does not determine a mode.
    #[error("the log does not determine a transfer function in the band of the sweep")]
    Empty,
}

/// Largest number of times that a log is followed with a corrected clock.
const PASSES: usize = 4;

/// Finds the modes that the sweep excited.
///
/// # Errors
/// [`SweepError`] if no modes can be determined.
pub fn identify(log: &AccelerationLog, sweep: &Sweep) -> Result<FoundInSweep, SweepError> {
    long_enough(log)?;
    check(sweep, log.sample_s)?;
    Ok(followed(&Reduced::new(log, sweep.end_hz), sweep, None)?.found)
}

/// Requires that a log is long enough for a sweep.
fn long_enough(log: &AccelerationLog) -> Result<(), SweepError> {
    const LEAST_S: f64 = 2.0;
    let samples = log.directions.iter().map(|(_, record)| record.len()).min().unwrap_or(0);
    let seconds = samples as f64 * log.sample_s;
    if seconds < LEAST_S {
        Err(SweepError::Short { samples, seconds })
    } else {
        Ok(())
    }
}

/// Follows a log with a description, whose clock is corrected until it fits. `known` is of another description: see [`follow::pass`].
fn followed(log: &Reduced<'_>, sweep: &Sweep, known: Option<Known<'_>>) -> Result<Followed, SweepError> {
    let mut clock = 1.0;
    for pass in 0..PASSES {
        let look = if pass == 0 { Look::Everywhere } else { Look::Near };
        match follow::pass(log, sweep, clock, look, known)? {
            Pass::Drifts(error) => clock *= 1.0 + error,
            Pass::Ended(mut followed) => {
                followed.found.clock_error = clock - 1.0;
                return Ok(*followed);
            }
        }
    }
    // The clock's error does not converge, so there is no evidence that the clock is wrong.
    match follow::pass(log, sweep, 1.0, Look::Nowhere, known)? {
        Pass::Ended(followed) => Ok(*followed),
        Pass::Drifts(_) => Err(SweepError::Empty),
    }
}

/// Finds the modes and the sweep that excited them: the usual sweep, or another that the log itself shows.
///
/// # Errors
/// [`SweepError`] if neither gives modes that can be determined.
pub fn identify_any(log: &AccelerationLog) -> Result<FoundInSweep, SweepError> {
    /// Fraction that the usual sweep must explain for no others to be tried.
    const EXPLAINED: f64 = 0.85;
    long_enough(log)?;
    let usual = Sweep::default();
    let reduced = Reduced::new(log, usual.end_hz);
    let described = |sweep: &Sweep, known: Option<Known<'_>>| {
        check(sweep, log.sample_s)?;
        followed(&reduced, sweep, known)
    };
    let whole = |sweep: &Sweep| Ok(described(sweep, None)?.found);
    let Some(course) = find::course(&reduced) else {
        return whole(&usual);
    };
    let mut likeliest = None;
    if course.is_of(&usual) {
        let followed = described(&usual, None);
        let is_it = |found: &FoundInSweep| found.transfer.explained > EXPLAINED && course.may_begin_at(usual.start_hz);
        if followed.as_ref().is_ok_and(|followed| is_it(&followed.found)) {
            return Ok(followed?.found);
        }
        likeliest = followed.ok();
    }
    likeliest = likelier(likeliest, &course.by_start(), described);
    let rounded = course.at_round_rate();
    if let Some(rounded) = &rounded {
        likeliest = likelier(likeliest, &rounded.by_start(), described);
    }
    if let Some(Followed { found, .. }) = &likeliest {
        let courses = [Some(&course), rounded.as_ref()].into_iter().flatten();
        let ends = courses.filter(|course| course.rises_as(&found.sweep));
        let ends: Vec<Sweep> = ends.flat_map(|course| course.by_end(&found.sweep)).collect();
        likeliest = likelier(likeliest, &ends, described);
    }
    let Some(Followed { found, is_rough, .. }) = likeliest else {
        return whole(&usual);
    };
    let found = if is_rough { whole(&found.sweep)? } else { found };
    Ok(FoundInSweep {
        is_estimated: found.sweep != usual,
        ..found
    })
}

fn check(sweep: &Sweep, sample_s: f64) -> Result<(), SweepError> {
    let values = [
        sweep.start_hz,
        sweep.end_hz,
        sweep.rate_hz_per_s,
        sweep.acceleration_per_hz,
        sample_s,
    ];
    let possible = values.iter().all(|value| value.is_finite() && *value > 0.0)
        && sweep.end_hz > sweep.start_hz
        && sweep.end_hz < 0.5 / sample_s;
    // A sweep with more periods than this is a mistake, and would fill the memory.
    let periods = (sweep.end_hz + sweep.start_hz) / 2.0 * (sweep.end_hz - sweep.start_hz) / sweep.rate_hz_per_s;
    if possible && periods < 1e7 {
        Ok(())
    } else {
        Err(SweepError::Description(*sweep))
    }
}
