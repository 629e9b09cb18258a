//! Finds modes in a position log (time, command, response), or in the free decay of a response.
//!
//! The method minimises the output error of modes under a held command. It is unbiased under sensor noise, and exact without noise, for
//! steps, decays, pseudo-random commands and chirps. [`arx`] has the models of equations (2-1) to (2-4) of the XY stage, whose result is
//! compared with that of this method.

pub mod arx;
mod held;
mod memory;
pub mod motor;
pub mod recursive;
mod rigid;
mod search;

use crate::found::{FoundMode, that_ring};
use crate::separable::{self, Effort, Separable};
use crate::signal::{Between, PositionLog};
use held::HeldModes;
use memory::beside_noise;
use posicast_shaper::mode::Mode;
use rigid::{clipped, is_tone, onset, rigid_delay};
use search::{Found, LEAST_GAIN, search};
use thiserror::Error;

/// Result for a position log.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundInPosition {
    /// The modes, sorted by frequency.
    pub modes: Vec<FoundMode>,
    /// Whether the command drove the modes; otherwise they decay freely.
    pub is_forced: bool,
    /// Number of samples in a row of the fit: the fastest mode has 4 to 15 rows per period, if the log has that many samples.
    pub decimation: usize,
    /// Time in seconds from the first sample to the first row, and from row to row.
    pub row_s: f64,
    /// The rows of the response.
    pub response: Vec<f64>,
    /// The rows that modes and command explain.
    pub fitted: Vec<f64>,
    /// Root mean square of the residuals.
    pub noise: f64,
    /// What the log does not determine.
    pub remarks: Vec<PositionRemark>,
}

/// Why a position log cannot be analysed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PositionError {
    /// There are too few samples.
    #[error("the log has {0} samples: modes need at least {LEAST_SAMPLES}")]
    Short(usize),
    /// Command and response have different lengths, or contain values that are not finite.
    #[error(
        "the log has {commands} commands and {responses} responses: their numbers must be equal, and all values finite; or leave the commands out"
    )]
    Uneven {
        /// Number of commands.
        commands: usize,
        /// Number of responses.
        responses: usize,
    },
    /// The response is constant.
    #[error(
        "the response is {value:e} in all {samples} samples: the sensor is dead, not connected, or coarser than the motion"
    )]
    Dead {
        /// Its only value.
        value: f64,
        /// Number of samples.
        samples: usize,
    },
    /// The time between samples is not positive and finite.
    #[error("{0} s between samples is not possible")]
    Sample(f64),
}

/// What a position log does not determine, and why.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PositionRemark {
    /// The command does not move, and nothing decays.
    #[error(
        "the command does not move and the response does not ring: no mode was excited; log a step, a pseudo-random command, or a stop"
    )]
    NoExcitation,
    /// The command moves, and the response follows without ringing.
    #[error(
        "the response follows the command without a mode that stands out from noise of {noise:.3e} (root mean square, in the unit of the \
         response): a smooth move excites little, so log a step, a pseudo-random command or a sudden stop"
    )]
    NoRinging {
        /// Root mean square of the residuals.
        noise: f64,
    },
    /// The command moves, and the response follows rigidly, some samples late.
    #[error(
        "the response equals the command, {samples} samples late: the axis is rigid, or the response is not measured at the part that rings"
    )]
    Late {
        /// Delay in samples.
        samples: usize,
    },
    /// The log contains too little of a mode to determine it.
    #[error(
        "the log is {seconds:.4} s long and shows {periods:.2} periods of something at about {frequency_hz:.4} Hz: log {:.4} s at least, three periods",
        3.0 / frequency_hz
    )]
    TooShort {
        /// Length of the log in seconds.
        seconds: f64,
        /// Number of periods in it.
        periods: f64,
        /// Frequency in Hz, approximately.
        frequency_hz: f64,
    },
    /// The ringing does not decay.
    #[error(
        "the response has a tone of {frequency_hz:.4} Hz that does not decay in the log: something drives it, or it is a mode that rings \
         longer than the log"
    )]
    Tone {
        /// Frequency of the tone in Hz.
        frequency_hz: f64,
    },
    /// Samples before the ringing were left out.
    #[error("the first {samples} samples, before the response begins to ring, are left out")]
    Onset {
        /// Number of samples left out.
        samples: usize,
    },
    /// The log contains few periods of a mode.
    #[error("the log shows {periods:.1} periods of the mode at {frequency_hz:.4} Hz: log at least three")]
    FewPeriods {
        /// Frequency of the mode in Hz.
        frequency_hz: f64,
        /// Number of periods in the log.
        periods: f64,
    },
    /// A mode has few samples per period.
    #[error(
        "the mode at {frequency_hz:.4} Hz has {samples:.1} samples in a period: one above half the rate of the samples would look the same"
    )]
    FewSamples {
        /// Frequency of the mode in Hz.
        frequency_hz: f64,
        /// Number of samples per period.
        samples: f64,
    },
    /// The response decays without forcing, so the shares are those of the decay.
    #[error(
        "the command does not move in this log: the participations are computed from the amplitudes at its first sample, as if a jump of \
         the acceleration had made them"
    )]
    Free,
    /// A drive whose command does not move.
    #[error(
        "the command of the drive does not move: nothing excited a mode; shake the axis with a pseudo-random test signal while you log"
    )]
    NoDrive,
    /// A motor under a force that nothing swings at.
    #[error(
        "the motor moves as a rigid mass: no load on it swings strongly enough to stand out from noise; shake it harder or log longer, \
         or measure at the load"
    )]
    RigidMotor,
    /// A motor under dry friction.
    #[error(
        "the motor reverses in the log: dry friction then looks like damping, unless it is a small part of the drive's force; let the \
         axis move one way while you shake it"
    )]
    TurnsRound,
    /// A motor that follows its velocity.
    #[error(
        "the motor follows the velocity command of its drive, whatever the load does: such a drive hides the vibration; log the torque \
         or current instead of the velocity, or measure at the load"
    )]
    StiffDrive,
    /// What rings while nothing holds the motor.
    #[error(
        "with the motor free, motor and load swing against each other at {frequency_hz:.4} Hz with a damping ratio of {damping:.3}; a shaper in front of a position loop is for the modes with the motor held"
    )]
    MotorFree {
        /// Its frequency in Hz.
        frequency_hz: f64,
        /// Its damping ratio.
        damping: f64,
    },
    /// Another method found something else.
    #[error(
        "a second method, least squares with instruments (ARX), finds {frequency_hz:.4} Hz and a damping ratio of {damping:.3} instead: \
         the log does not determine this mode"
    )]
    Differs {
        /// Frequency that it found, in Hz.
        frequency_hz: f64,
        /// Damping ratio that it found.
        damping: f64,
    },
    /// The mode changed during the log.
    #[error(
        "the frequency moves from {from_hz:.4} to {to_hz:.4} Hz during the log: one mode for the whole log is an average; log where the \
         machine works, or a part at a time"
    )]
    Moves {
        /// Frequency in the first half in Hz.
        from_hz: f64,
        /// Frequency in the second half in Hz.
        to_hz: f64,
    },
}

/// Smallest number of samples of a log.
pub const LEAST_SAMPLES: usize = 24;
/// Number of rows in which modes are sought.
const SEARCH_ROWS: usize = 3000;
/// Rows per period of the fastest mode in the last fit, if the log has that many samples.
const ROWS_PER_PERIOD: f64 = 8.0;
/// Largest number of rows of the last fit.
const MOST_ROWS: usize = 30_000;
/// Smallest damping ratio of a pole that does not count as a vibration.
const NO_VIBRATION: f64 = 0.6;
/// Share of the response below which a mode is reported only if it is certain, and the largest relative deviation of its damping and the
/// smallest number of its periods in the log that make it certain.
const LEAST_SHARE: f64 = 0.05;
const SURE_DAMPING: f64 = 0.2;
const SURE_PERIODS: f64 = 5.0;
/// Relative standard deviations of a mode's damping and frequency above which the log does not determine it.
const VAGUE_DAMPING: f64 = 0.4;
const VAGUE_FREQUENCY: f64 = 0.03;
/// Number of periods of a mode that a log needs to determine it.
const ONE_PERIOD: f64 = 1.0;
/// Length of the intervals of a log that show how much the noise's memory adds to the variance, as a multiple of the
/// time for which a mode rings (noise may ring as long), and the number of such intervals.
const MEMORY: f64 = 4.0;
const STRETCHES: (f64, f64) = (6.0, 40.0);

/// Finds the modes of a log.
///
/// # Errors
/// [`PositionError`] for a log that cannot be analysed.
pub fn identify(log: &PositionLog) -> Result<FoundInPosition, PositionError> {
    identify_response(log, Quantity::Position)
}

/// Physical quantity of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Position,
    Acceleration,
}

/// As [`identify`], for a response of this quantity, which decides how the amplitudes of a free decay are interpreted.
pub(crate) fn identify_response(log: &PositionLog, quantity: Quantity) -> Result<FoundInPosition, PositionError> {
    check(log)?;
    let (response_unit, command_unit) = (largest(&log.response), largest(&log.command));
    let in_units = |values: &[f64], unit: f64| values.iter().map(|value| value / unit).collect::<Vec<f64>>();
    let found = identify_scaled(
        &PositionLog {
            command: in_units(&log.command, command_unit),
            response: in_units(&log.response, response_unit),
            missing: log.missing.clone(),
            ..*log
        },
        quantity,
    )?;
    let in_log = |values: Vec<f64>| values.iter().map(|value| value * response_unit).collect();
    let mut remarks = found.remarks;
    for remark in &mut remarks {
        if let PositionRemark::NoRinging { noise } = remark {
            *noise *= response_unit;
        }
    }
    Ok(FoundInPosition {
        response: in_log(found.response),
        fitted: in_log(found.fitted),
        noise: found.noise * response_unit,
        remarks,
        ..found
    })
}

/// Returns the largest magnitude of a signal; 1 for a signal of zeros.
fn largest(values: &[f64]) -> f64 {
    let largest = values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Finds the modes of a log scaled to a largest command and response of 1, so that its squares are finite in any unit.
fn identify_scaled(log: &PositionLog, quantity: Quantity) -> Result<FoundInPosition, PositionError> {
    let begin = if held::moves(&log.command) {
        0
    } else {
        onset(&log.response)
    };
    if begin > 0 && log.response.len() >= begin + LEAST_SAMPLES {
        let mut found = identify_scaled(
            &PositionLog {
                command: Vec::new(),
                response: log.response[begin..].to_vec(),
                missing: crate::signal::within(&log.missing, begin..log.response.len()),
                ..*log
            },
            quantity,
        )?;
        found.remarks.push(PositionRemark::Onset { samples: begin });
        return Ok(found);
    }
    let samples = log.response.len();
    let coarse = samples.div_ceil(SEARCH_ROWS);
    let clipped = clipped(&log.response);
    let problem = |range: std::ops::Range<usize>, decimation| {
        HeldModes::new(log, range.clone(), decimation)
            .of(quantity)
            .without(&clipped[range])
    };
    let mut found = search(&problem(0..samples, coarse), &[]);
    if coarse > 1 {
        // A mode too fast for the rows of the whole log is sought where the command first moves.
        let first = log.command.windows(2).position(|pair| pair[0] != pair[1]).unwrap_or(0);
        let begin = first.min(samples - SEARCH_ROWS);
        let fast = search(&problem(begin..begin + SEARCH_ROWS, 1), &[]);
        let slow = found
            .as_ref()
            .map_or(0, |found| reported_modes(&problem(0..samples, coarse), found).len());
        if fast
            .as_ref()
            .is_some_and(|fast| reported_modes(&problem(begin..begin + SEARCH_ROWS, 1), fast).len() > slow)
        {
            found = fast;
        }
    }
    let modes = found.map_or(Vec::new(), |found| found.modes);
    let fastest = modes.iter().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    let wanted = if fastest > 0.0 {
        (1.0 / (fastest * log.sample_s * ROWS_PER_PERIOD)).round() as usize
    } else {
        coarse
    };
    let decimation = wanted.clamp(samples.div_ceil(MOST_ROWS), (samples / LEAST_SAMPLES).max(1));
    let last = problem(0..samples, decimation);
    let (fitted_rows, found) = beside_noise(last, &modes).ok_or(PositionError::Short(samples))?;
    let modes = reported_modes(&fitted_rows, &found);
    let last = HeldModes::with_filled(log, 0..samples, decimation);
    let solution = &found.solution;
    let fitted = last.basis(&solution.unknowns) * &solution.coefficients;
    let mut residual = last.measured() - &fitted;
    fitted_rows.zero_clipped(residual.as_mut_slice());
    let noise = (residual.norm_squared() / solution.freedoms / fitted_rows.counted()).sqrt();
    let late = match modes[..] {
        [] => None,
        _ if clipped.contains(&true) => None,
        _ => rigid_delay(log, decimation, &found, &residual),
    };
    let (modes, remarks) = match late {
        Some(samples) => (Vec::new(), vec![PositionRemark::Late { samples }]),
        None => {
            let remarks = remarks(log, &fitted_rows, &found, &modes, noise);
            (modes, remarks)
        }
    };
    Ok(FoundInPosition {
        is_forced: last.is_forced(),
        decimation,
        row_s: last.row_s(),
        response: last.measured().iter().copied().collect(),
        fitted: fitted.iter().copied().collect(),
        noise,
        remarks,
        modes,
    })
}

fn check(log: &PositionLog) -> Result<(), PositionError> {
    let (commands, responses) = (log.command.len(), log.response.len());
    let finite = log.command.iter().chain(&log.response).all(|value| value.is_finite());
    if !(log.sample_s > 0.0 && log.sample_s.is_finite()) {
        return Err(PositionError::Sample(log.sample_s));
    }
    if !finite || (commands != 0 && commands != responses) {
        return Err(PositionError::Uneven { commands, responses });
    }
    if responses < LEAST_SAMPLES {
        return Err(PositionError::Short(responses));
    }
    if log.response.iter().all(|value| *value == log.response[0]) {
        return Err(PositionError::Dead {
            value: log.response[0],
            samples: responses,
        });
    }
    Ok(())
}

/// Number of intervals of a log that are longer than the memory of something that decays.
fn stretches(decay: f64, seconds: f64) -> usize {
    (seconds * decay / MEMORY).clamp(STRETCHES.0, STRETCHES.1) as usize
}

/// Returns the modes of a fit that are vibrations, and that the fit determines.
fn reported_modes(problem: &HeldModes<'_>, found: &Found) -> Vec<FoundMode> {
    let solution = &found.solution;
    let row = (solution.reduced_square() / problem.counted()).sqrt();
    let width = problem.per_mode();
    let seconds = problem.row_s() * problem.len() as f64;
    let deviation = |n: usize, mode: &Mode| {
        let with_memory = solution.deviation_with_memory(n, stretches(mode.decay(), seconds));
        solution.deviation(n, row).max(with_memory)
    };
    let all: Vec<(FoundMode, f64)> = found
        .modes
        .iter()
        .enumerate()
        .map(|(k, &mode)| {
            let coefficients: Vec<f64> = solution.coefficients.rows(width * k, width).iter().copied().collect();
            let found = FoundMode {
                mode,
                participation: 0.0,
                frequency_sd_hz: mode.frequency_hz * deviation(2 * k, &mode),
                damping_sd: mode.damping * deviation(2 * k + 1, &mode),
            };
            (found, problem.strength(&mode, &coefficients))
        })
        .collect();
    let is_vibration = |found: &FoundMode| {
        found.mode.damping < NO_VIBRATION
            && found.damping_sd < VAGUE_DAMPING * found.mode.damping.max(0.01)
            && found.frequency_sd_hz < VAGUE_FREQUENCY * found.mode.frequency_hz
            && found.mode.frequency_hz * seconds > ONE_PERIOD
            && !is_tone(&found.mode, problem.is_forced(), seconds)
    };
    let kept: Vec<(FoundMode, f64)> = all.into_iter().filter(|(found, _)| is_vibration(found)).collect();
    let whole: f64 = kept.iter().map(|(_, strength)| strength).sum();
    // A drift looks like a slow mode of little strength, which would seem to ring most.
    let is_sure = |found: &FoundMode| {
        found.damping_sd < SURE_DAMPING * found.mode.damping.max(0.01)
            && found.mode.frequency_hz * seconds > SURE_PERIODS
    };
    let modes = kept
        .into_iter()
        .filter(|(found, strength)| *strength >= LEAST_SHARE * whole || is_sure(found))
        .map(|(found, strength)| FoundMode {
            participation: problem.participation(&found.mode, strength),
            ..found
        });
    that_ring(modes.collect())
}

/// Returns why the modes of a fit are not reported.
fn reasons_not_reported(problem: &HeldModes<'_>, found: &Found) -> Vec<PositionRemark> {
    /// Number of periods above which a motion is more than a drift.
    const SOME_OF_A_PERIOD: f64 = 0.3;
    let seconds = problem.row_s() * problem.len() as f64;
    let mut remarks: Vec<PositionRemark> = Vec::new();
    for mode in &found.modes {
        let (frequency_hz, periods) = (mode.frequency_hz, seconds * mode.frequency_hz);
        let is_known = |remark: &PositionRemark| matches!(remark, PositionRemark::Tone { frequency_hz: other } if seconds * (other - frequency_hz).abs() < 1.0);
        if mode.damping < NO_VIBRATION && (SOME_OF_A_PERIOD..=ONE_PERIOD).contains(&periods) {
            remarks.push(PositionRemark::TooShort {
                seconds,
                periods,
                frequency_hz,
            });
        } else if periods > ONE_PERIOD && is_tone(mode, problem.is_forced(), seconds) && !remarks.iter().any(is_known) {
            remarks.push(PositionRemark::Tone { frequency_hz });
        }
    }
    remarks
}

fn remarks(
    log: &PositionLog,
    problem: &HeldModes<'_>,
    found: &Found,
    modes: &[FoundMode],
    noise: f64,
) -> Vec<PositionRemark> {
    const FEW_PERIODS: f64 = 3.0;
    const FEW_SAMPLES: f64 = 3.0;
    let mut remarks = reasons_not_reported(problem, found);
    if modes.is_empty() {
        if remarks.is_empty() {
            remarks.push(if problem.is_forced() {
                PositionRemark::NoRinging { noise }
            } else {
                PositionRemark::NoExcitation
            });
        }
        return remarks;
    }
    if !problem.is_forced() && modes.len() > 1 {
        remarks.push(PositionRemark::Free);
    }
    let seconds = log.sample_s * log.response.len() as f64;
    for found in modes {
        let frequency_hz = found.mode.frequency_hz;
        let (periods, samples) = (seconds * frequency_hz, 1.0 / (frequency_hz * log.sample_s));
        if periods < FEW_PERIODS {
            remarks.push(PositionRemark::FewPeriods { frequency_hz, periods });
        }
        if samples < FEW_SAMPLES {
            remarks.push(PositionRemark::FewSamples { frequency_hz, samples });
        }
    }
    remarks.extend(moved(log, problem, modes));
    // The models of the stage assume held commands.
    if let ([only], Between::Held) = (modes, log.between) {
        remarks.extend(beside(log, &only.mode));
    }
    remarks
}

/// Returns a remark if the strongest mode differs between the first and the second half of a log.
fn moved(log: &PositionLog, problem: &HeldModes<'_>, modes: &[FoundMode]) -> Option<PositionRemark> {
    const DEVIATIONS: f64 = 5.0;
    const LEAST: f64 = 0.005;
    let strongest = (0..modes.len()).max_by(|a, b| modes[*a].ringing(1.0).total_cmp(&modes[*b].ringing(1.0)))?;
    let mut others: Vec<Mode> = modes.iter().map(|found| found.mode).collect();
    let start = HeldModes::unknowns(&others);
    others.remove(strongest);
    let others = HeldModes::unknowns(&others);
    let middle = log.response.len() / 2;
    let in_part = |range| {
        let part = HeldModes::new(log, range, problem.decimation()).with_memory_of(problem);
        let solution = separable::refine(&part, &start, Effort::Full)?;
        // A part in which the mode does not ring fits noise instead, at any frequency and with any apparent certainty.
        let still = separable::refine(&part, &others, Effort::Full)?;
        let explained = (still.square - solution.square) / solution.reduced_square();
        if explained < 2.0 * LEAST_GAIN {
            return None;
        }
        let deviation = solution.deviation(2 * strongest, solution.reduced_square().sqrt());
        Some((HeldModes::modes(&solution.unknowns)[strongest].frequency_hz, deviation))
    };
    let ((from_hz, from_sd), (to_hz, to_sd)) = (in_part(0..middle)?, in_part(middle..log.response.len())?);
    let far = (to_hz / from_hz).ln().abs();
    let is_certain = far > LEAST && far > DEVIATIONS * from_sd.hypot(to_sd);
    is_certain.then_some(PositionRemark::Moves { from_hz, to_hz })
}

/// Returns a remark if the XY stage's models give another result for a log with one mode.
fn beside(log: &PositionLog, mode: &Mode) -> Option<PositionRemark> {
    const FREQUENCY: f64 = 0.05;
    const DAMPING: f64 = 0.5;
    let differs = |other: &Mode| {
        (other.frequency_hz / mode.frequency_hz - 1.0).abs() > FREQUENCY
            || (other.damping - mode.damping).abs() > DAMPING * mode.damping + 0.01
    };
    let decimated = arx::decimated(log, mode.frequency_hz);
    let other = arx::with_instruments(&decimated, 2).ok()?.modes();
    match other[..] {
        [other] if differs(&other) => Some(PositionRemark::Differs {
            frequency_hz: other.frequency_hz,
            damping: other.damping,
        }),
        _ => None,
    }
}
