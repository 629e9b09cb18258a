//! Finds modes in an accelerometer log of a resonance test.
//!
//! The log does not contain the excitation. It is known by its description ([`Sweep`]); what the description leaves
//! open, the time at which it began and the order of its quarter periods, is found by trying.

mod excitation;
mod find;
mod measure;
mod record;
mod transfer;
mod wave;

pub use crate::modal::TOLD_RINGING;
pub use excitation::{QuarterOrder, Rise, SquareWave, Sweep, Sweeping, SweptAcceleration};
pub use transfer::{Band, Transfer};

use crate::found::{FoundMode, LEAST_PARTICIPATION, that_ring};
use crate::modal::{self, Fit, Lateness, Phase, ResponsePoint};
use crate::separable::Effort;
use crate::signal::AccelerationLog;
use measure::{Placed, explained, measure};
use nalgebra::Complex;
use posicast_model::mode::Mode;
use record::{Grid, Record};
use thiserror::Error;
use transfer::Lines;

/// Result for an accelerometer log of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundInSweep {
    /// The modes, sorted by frequency.
    pub modes: Vec<FoundMode>,
    /// Name of the sensor direction that was used.
    pub direction: String,
    /// The sweep that was taken.
    pub sweep: Sweep,
    /// Whether it was estimated from the log.
    pub is_estimated: bool,
    /// Gain of the sensor's acceleration over that of the sweep at the lowest frequencies: 1 where `acceleration_per_hz` is right.
    pub static_gain: f64,
    /// The square wave beside the sweep, where there is one.
    pub wave: Option<SquareWave>,
    /// Bands that the axis was shaken at while samples are missing: modes there are not seen.
    pub unseen: Vec<Band>,
    /// Time from the first sample to the start of the sweep, in seconds; negative where the log begins later.
    pub start_s: f64,
    /// Relative amount by which the log's clock runs faster than that of the sweep: 1e-4 is 10 ms in 100 s. 0 where
    /// it was not corrected.
    pub clock_error: f64,
    /// Order of the quarter periods that fits the log.
    pub order: QuarterOrder,
    /// Way in which the frequency rises that fits the log.
    pub rise: Rise,
    /// The frequencies at which the log has the axis shaken; modes outside are not reported.
    pub covered: Band,
    /// Frequency in Hz from which on a further mode below the lowest would have been found, if it rang with [`TOLD_RINGING`] of what
    /// all ring with; `None` without modes.
    pub visible_from_hz: Option<f64>,
    /// The measured transfer function.
    pub transfer: Transfer,
    /// The fitted transfer function, at the same points.
    pub fitted: Vec<Complex<f64>>,
    /// Sum of squares of the residuals relative to the noise: 1 where only noise is left.
    pub reduced_square: f64,
}

/// Why the sweep gives no modes of a log.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SweepError {
    /// There are too few samples.
    #[error("the log has {samples} samples, {seconds:.2} s: a sweep needs 2 s at least")]
    Short {
        /// Number of samples.
        samples: usize,
        /// Duration in seconds.
        seconds: f64,
    },
    /// The description of the sweep is invalid.
    #[error("a sweep from {} to {} Hz at {} Hz/s with {} m/s² per Hz is not possible: all must be finite and above 0, the second frequency above the first and below half the rate of the samples", .0.start_hz, .0.end_hz, .0.rate_hz_per_s, .0.acceleration_per_hz)]
    Description(Sweep),
    /// No direction follows the sweep.
    #[error("no direction of the sensor follows the sweep: it explains {:.1} % of the log at most", 100.0 * .0)]
    Unrelated(f64),
    /// The log has neither end of the sweep.
    #[error(
        "the log follows this sweep only as a piece of it, from {:.1} to {:.1} Hz, without its beginning and its end: it was another sweep, or the log was cut",
        .0.low_hz, .0.high_hz
    )]
    Piece(Band),
    /// The log follows the sweep in a way that modes do not explain.
    #[error("modes tell {:.0} % of how the sensor follows this sweep: it was another one, or the machine is far from linear", 100.0 * .0)]
    Unlike(f64),
    /// The transfer function does not determine a mode.
    #[error("the log fixes no transfer function in the band of the sweep")]
    Empty,
}

/// Margin of the band beyond the sweep's frequencies, relative.
const MARGIN: f64 = 0.02;
/// Smallest fraction of the power that the sweep must explain.
const LEAST_EXPLAINED: f64 = 0.2;
/// Smallest fraction of the transfer function's power that the modes must explain.
const LEAST_TOLD: f64 = 0.8;
/// Sharpness of the impulse response below which other orders of the quarters are tried.
const SHARP: f64 = 30.0;

/// Finds the modes that the sweep excited.
///
/// # Errors
/// [`SweepError`] where there are none that can be determined.
pub fn identify(log: &AccelerationLog, sweep: &Sweep) -> Result<FoundInSweep, SweepError> {
    let samples = log.directions.iter().map(|(_, record)| record.len()).min().unwrap_or(0);
    let seconds = samples as f64 * log.sample_s;
    if seconds < 2.0 {
        return Err(SweepError::Short { samples, seconds });
    }
    check(sweep, log.sample_s)?;
    let mut clock = 1.0;
    for pass in 0..PASSES {
        let look = if pass == 0 { Look::Everywhere } else { Look::Near };
        match followed(log, sweep, samples, log.sample_s / clock, look)? {
            Pass::Drifts(error) => clock *= 1.0 + error,
            Pass::Ended(found) => {
                return Ok(FoundInSweep {
                    clock_error: clock - 1.0,
                    ..*found
                });
            }
        }
    }
    // The clock's error does not converge, so nothing shows that the clock is wrong.
    match followed(log, sweep, samples, log.sample_s, Look::Nowhere)? {
        Pass::Ended(found) => Ok(*found),
        Pass::Drifts(_) => Err(SweepError::Empty),
    }
}

/// Finds the modes and the sweep that excited them: the usual one, or what the log itself tells of another.
///
/// # Errors
/// [`SweepError`] where neither gives modes that can be determined.
pub fn identify_any(log: &AccelerationLog) -> Result<FoundInSweep, SweepError> {
    /// How far what is told of a sweep may be off the usual one to be that: of its rate, and in Hz.
    const RATE: f64 = 0.02;
    const HZ: f64 = 1.0;
    /// What the first description must explain for others not to be tried.
    const EXPLAINED: f64 = 0.97;
    /// The same for the usual one, of which only the start is in doubt.
    const NEARLY_EXPLAINED: f64 = 0.85;
    let usual = Sweep::default();
    let told = find::find(log);
    let rises_as_usual = |sweep: &Sweep| {
        (sweep.rate_hz_per_s / usual.rate_hz_per_s - 1.0).abs() < RATE && (sweep.end_hz - usual.end_hz).abs() < HZ
    };
    let by_default = || identify(log, &usual);
    let mut tried = told.clone();
    if told.first().is_none_or(rises_as_usual) {
        let found = by_default();
        // The slowest pulses are the weakest, so that a start is the least certain.
        let is_near = told
            .first()
            .is_none_or(|sweep| (sweep.start_hz - usual.start_hz).abs() < HZ);
        let is_it = |found: &FoundInSweep| is_near || found.transfer.explained > NEARLY_EXPLAINED;
        if found.as_ref().is_ok_and(is_it) || told.is_empty() {
            return found;
        }
        tried.insert(0, usual);
    }
    let mut likeliest: Option<FoundInSweep> = None;
    for sweep in &tried {
        let Ok(found) = identify(log, sweep) else { continue };
        let explained = found.transfer.explained;
        if likeliest
            .as_ref()
            .is_none_or(|best| explained > best.transfer.explained)
        {
            likeliest = Some(found);
        }
        if explained > EXPLAINED {
            break;
        }
    }
    match likeliest {
        Some(found) => Ok(FoundInSweep {
            is_estimated: found.sweep != usual,
            ..found
        }),
        None => by_default(),
    }
}

/// Largest number of times that a log is followed with a corrected clock, and the bend in seconds above which that is
/// done: the fit compensates a smaller one.
const PASSES: usize = 4;
const BEND_S: f64 = 3e-3;

/// Number of standard deviations by which a bend must exceed zero.
const CERTAIN: f64 = 6.0;

/// Range in which an error of the clock is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Look {
    /// Up to a tenth of a percent.
    Everywhere,
    /// Only as far as the fit moves by itself.
    Near,
    /// The clock is not corrected.
    Nowhere,
}

/// Result of following a log with one clock.
enum Pass {
    /// Its clock has this relative error.
    Drifts(f64),
    Ended(Box<FoundInSweep>),
}

fn followed(
    log: &AccelerationLog,
    sweep: &Sweep,
    samples: usize,
    sample_s: f64,
    look: Look,
) -> Result<Pass, SweepError> {
    let seconds = samples as f64 * sample_s;
    let band = Band {
        low_hz: sweep.start_hz * (1.0 + MARGIN),
        high_hz: sweep.end_hz * (1.0 - MARGIN),
    };
    // A clock that is fast by ε sees f later by ε·f/rate, and takes it for f/(1 + ε), which was due earlier by as
    // much: together this is the group delay, which is twice the bend.
    let error = |bend_s: f64| bend_s * sweep.rate_hz_per_s / band.high_hz;
    let mut grid = Grid::new(samples, sample_s, band);
    let strongest = strongest(log, &mut grid).ok_or(SweepError::Empty)?;
    let Strongest {
        direction,
        mut record,
        response,
        all,
    } = strongest;
    let begun = begin(&mut grid, &response, sweep).ok_or(SweepError::Empty)?;
    let ends_s = begun.start_s + begun.excitation.duration_s() - grid.before_s();
    if begun.start_s < grid.before_s() - CUT_S || ends_s > seconds + CUT_S {
        grid.cut_to_log();
    }
    let smooth = placed(&mut grid, &begun, begun.start_s);
    if look == Look::Everywhere {
        let bend_s = transfer::bend(&response, &smooth, band.high_hz);
        if bend_s.abs() > BEND_S {
            return Ok(Pass::Drifts(error(bend_s)));
        }
    }
    let pulses = grid.sampled(&begun.excitation, begun.start_s);
    let covered = covered(sweep, &band, &begun, begun.start_s - grid.before_s(), seconds);
    let harmonic = begun.order.first_harmonic();
    let wave = match sweep.sweeping {
        Sweeping::Off => None,
        Sweeping::Wave(wave) => Some(wave),
        Sweeping::FromLog => wave::find(
            &grid,
            &all,
            &pulses,
            harmonic * sweep.start_hz,
            begun.start_s,
            begun.excitation.duration_s(),
        ),
    };
    let moved = wave.map(|wave| SweptAcceleration::square_wave(&wave, begun.excitation.duration_s()));
    if wave.is_some() {
        // The axis then stops in a way that is not known.
        let end = (begun.start_s + begun.excitation.duration_s() - STOP_S) / sample_s;
        record.forget_from(end.max(0.0) as usize);
    }
    // A frequency is shaken for about the time in which the sweep passes its own bandwidth.
    let passes_s = 0.5 / sweep.rate_hz_per_s.sqrt();
    let unfilled = record.clone();
    let seen = |start_s: f64| {
        let unfilled = &unfilled;
        let ends_s = (start_s, start_s + begun.excitation.duration_s());
        move |frequency_hz: f64| {
            let at_s = start_s + (frequency_hz / harmonic - sweep.start_hz) / sweep.rate_hz_per_s;
            let within = |time_s: f64| time_s.clamp(ends_s.0, ends_s.1) / sample_s;
            unfilled.seen(within(at_s - passes_s), within(at_s + passes_s))
        }
    };
    let first = moved.as_ref().map(|wave| (wave, 1.0));
    let rough = Placed::new(&mut grid, smooth, &begun.excitation, first, begun.start_s);
    let rough = measure(&mut grid, &mut record, &rough, band, seen(begun.start_s));
    let (explained_alone, rough) = (rough.explained, rough.transfer);
    // The wave's amplitude is known as the sensor shows it, that of the sweep as it was described.
    let mut gain = 1.0;
    if explained_alone < LEAST_EXPLAINED {
        return Err(SweepError::Unrelated(explained_alone));
    }
    let covered = covered?;
    let rough = rough.within(&covered);
    let timed = timed(&rough).ok_or(SweepError::Empty)?;
    let late = timed.phase.lateness();
    let bends = late.bend_s.abs() > BEND_S && late.bend_s.abs() > CERTAIN * timed.bend_deviation_s;
    if bends && look != Look::Nowhere {
        return Ok(Pass::Drifts(error(late.bend_s)));
    }
    // The aliased part is known only once the start is known to a small part of a sample.
    let mut start_s = begun.start_s + late.delay_s;
    if sample_s * SLOW_HZ > 1.0 {
        // The phase is not enough where most of the edges are between few samples: those tell the start.
        let mut best = (f64::MIN, start_s);
        for (steps, step) in SOUGHT_STEPS {
            let middle_s = best.1;
            for n in -steps..=steps {
                let tried_s = middle_s + f64::from(n) * step * sample_s;
                let smooth = self::placed(&mut grid, &begun, tried_s);
                let again = moved.as_ref().map(|wave| (wave, gain));
                let tried = Placed::new(&mut grid, smooth, &begun.excitation, again, tried_s);
                let share = explained(&mut grid, &record, &tried, band);
                if share > best.0 {
                    best = (share, tried_s);
                }
            }
        }
        start_s = best.1;
    }
    let mut poles = timed.poles;
    let mut turn = 0;
    let (measured, transfer, fit) = loop {
        let smooth = self::placed(&mut grid, &begun, start_s);
        let again = moved.as_ref().map(|wave| (wave, gain));
        let exact = Placed::new(&mut grid, smooth, &begun.excitation, again, start_s);
        let mut measured = measure(&mut grid, &mut record, &exact, band, seen(start_s));
        let transfer = std::mem::replace(&mut measured.transfer, Transfer::empty()).within(&covered);
        let points = &transfer.points;
        let rest = Phase::Late(Lateness::default());
        let start = modal::refine(points, &poles, rest, Effort::Rough).ok_or(SweepError::Empty)?;
        let delay_s = start.phase.lateness().delay_s;
        let told = 1.0 / start.still.abs().clamp(0.1, 10.0);
        let is_louder = sweep.sweeping == Sweeping::FromLog && wave.is_some() && (gain / told).ln().abs() > SAME_GAIN;
        let is_late = delay_s.abs()
            > sample_s
                * if sample_s * SLOW_HZ > 1.0 {
                    START_SAMPLES
                } else {
                    START_FAST
                };
        if (is_late || is_louder) && turn < START_TURNS {
            start_s += delay_s;
            gain = if is_louder { told } else { gain };
            poles = start.poles;
            turn += 1;
            continue;
        }
        let grown = modal::pruned(points, modal::grown(points, start));
        let fit = modal::refine(points, &grown.poles, grown.phase, Effort::Full).ok_or(SweepError::Empty)?;
        break (measured, transfer, fit);
    };
    let told = told(&transfer, &fit);
    if told < LEAST_TOLD {
        return Err(SweepError::Unlike(told));
    }
    let modes = modes(&fit, &transfer.points, &covered, &measured.unseen);
    Ok(Pass::Ended(Box::new(FoundInSweep {
        visible_from_hz: modal::visible_from_hz(&transfer.points, &fit, &modes),
        modes,
        direction,
        sweep: *sweep,
        is_estimated: false,
        static_gain: fit.still.abs(),
        wave,
        unseen: measured.unseen,
        start_s: start_s - grid.before_s() + fit.phase.lateness().delay_s,
        clock_error: 0.0,
        order: begun.order,
        rise: begun.rise,
        covered,
        reduced_square: fit.reduced_square(),
        fitted: fit.values,
        transfer,
    })))
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

/// Rate of the samples in Hz below which the start is sought on the samples, and the steps of the search in samples.
const SLOW_HZ: f64 = 600.0;
const SOUGHT_STEPS: [(i32, f64); 3] = [(6, 0.1), (4, 0.025), (4, 0.006)];
/// Ratio, as a logarithm, up to which the gain of sweep and square wave is the same.
const SAME_GAIN: f64 = 0.03;
/// Part of a sample to which the start must be known, where samples are few and where they are many, and the number of times that it is
/// mended.
const START_SAMPLES: f64 = 0.01;
const START_FAST: f64 = 0.05;
const START_TURNS: usize = 3;
/// Time in seconds of a sweep that a log may lack to count as whole.
const CUT_S: f64 = 0.3;
/// Time in seconds before the end of a sweep with a square wave from which on the motion is not known: the firmware brakes.
const STOP_S: f64 = 0.05;

/// The direction with the most power in the band.
struct Strongest {
    direction: String,
    record: Record,
    response: Lines,
    all: Vec<Complex<f64>>,
}

fn strongest(log: &AccelerationLog, grid: &mut Grid) -> Option<Strongest> {
    let directions = log.directions.iter().map(|(name, values)| {
        let record = grid.record(values, &log.missing);
        let (response, all) = grid.lines(&record);
        Strongest {
            direction: name.clone(),
            record,
            response,
            all,
        }
    });
    directions.max_by(|a, b| a.response.power().total_cmp(&b.response.power()))
}

/// A sweep whose start is known to a few milliseconds.
struct Begun {
    excitation: SweptAcceleration,
    /// Lines of the excitation when it begins at the start of the grid.
    lines: Lines,
    order: QuarterOrder,
    rise: Rise,
    /// Time from the start of the grid.
    start_s: f64,
}

fn begin(grid: &mut Grid, response: &Lines, sweep: &Sweep) -> Option<Begun> {
    let mut best: Option<(f64, Begun)> = None;
    for order in QuarterOrder::ALL {
        for rise in Rise::ALL {
            let excitation = SweptAcceleration::new(sweep, order, rise);
            let lines = grid.excitation(&excitation, 0.0);
            let (start_s, sharpness) = transfer::delay(response, &lines);
            let begun = Begun {
                excitation,
                lines,
                order,
                rise,
                start_s,
            };
            if sharpness > SHARP {
                return Some(begun);
            }
            if best.as_ref().is_none_or(|(best, _)| sharpness > *best) {
                best = Some((sharpness, begun));
            }
        }
    }
    best.map(|(_, begun)| begun)
}

/// The part of the band at which the log has the axis shaken. The harmonics of the sweep shake it above, but too little to be trusted.
///
/// # Errors
/// [`SweepError::Piece`]: the division of the transforms needs a log from rest to rest, and one that has neither end rests on nothing.
fn covered(sweep: &Sweep, band: &Band, begun: &Begun, start_s: f64, seconds: f64) -> Result<Band, SweepError> {
    let after = |time_s: f64| sweep.start_hz + sweep.rate_hz_per_s * time_s.max(0.0);
    let (low_hz, high_hz) = (after(-start_s), after(seconds - start_s));
    if low_hz > band.low_hz && high_hz < band.high_hz {
        return Err(SweepError::Piece(Band { low_hz, high_hz }));
    }
    let harmonic = begun.order.first_harmonic();
    Ok(Band {
        low_hz: band.low_hz.max(harmonic * low_hz),
        high_hz: band.high_hz.min(harmonic * high_hz),
    })
}

/// Lines of the sweep that begins at `start_s`.
fn placed(grid: &mut Grid, begun: &Begun, start_s: f64) -> Lines {
    if !grid.is_cut() && start_s >= 0.0 && start_s + begun.excitation.duration_s() <= grid.seconds() {
        grid.later(&begun.lines, start_s)
    } else {
        grid.excitation(&begun.excitation, start_s)
    }
}

/// Fits poles without knowledge of the phase, then finds the lateness that matches them.
fn timed(transfer: &Transfer) -> Option<Fit> {
    const TRIED_S: f64 = 0.25e-3;
    const TRIED: i32 = 60;
    // For start values a third of the points is as good, and takes a third of the time.
    let points = &modal::thinned(&transfer.points, 3);
    let free = modal::select(points, Phase::Free)?;
    let delays = (-TRIED..=TRIED).map(|n| Lateness {
        delay_s: f64::from(n) * TRIED_S,
        bend_s: 0.0,
    });
    modal::refine(points, &free.poles, best(points, &free, delays)?, Effort::Full)
}

/// The lateness that explains most.
fn best(points: &[ResponsePoint], free: &Fit, tried: impl Iterator<Item = Lateness>) -> Option<Phase> {
    let squares = tried.filter_map(|late| {
        let phase = Phase::Late(late);
        Some((modal::square(points, &free.poles, phase)?, phase))
    });
    squares.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, phase)| phase)
}

/// Fraction of the transfer function's power, above its noise's, that a fit explains.
fn told(transfer: &Transfer, fit: &Fit) -> f64 {
    let weighted = |value: Complex<f64>, deviation: f64| (value / deviation).norm_sqr();
    let points = || transfer.points.iter().zip(&fit.values);
    let whole: f64 = points().map(|(p, _)| weighted(p.value, p.deviation)).sum();
    let left: f64 = points()
        .map(|(p, fitted)| weighted(p.value - fitted, p.deviation))
        .sum();
    1.0 - left / whole
}

/// Damping ratio from which on a pole does not count as a vibration, but as a slope of the transfer function.
const NO_VIBRATION: f64 = 0.5;
/// Share of the axis's own displacement below which errors of the excitation's description look like a mode.
const LEAST_OF_AXIS: f64 = 0.003;
/// Number of standard deviations by which a share must exceed zero.
const SIGNIFICANT: f64 = 6.0;

/// Distance, as a fraction of the frequency, up to which what is cut off by a gap can look like a faint mode beside the band that the gap hides.
const EDGE: f64 = 0.1;

fn modes(fit: &Fit, points: &[ResponsePoint], band: &Band, unseen: &[Band]) -> Vec<FoundMode> {
    let whole: f64 = fit.shares.iter().map(|(share, _)| share.max(0.0)).sum();
    let told = |k: &usize| {
        let pole = &fit.poles[*k];
        let (share, deviation) = fit.shares[*k];
        let inside = pole.frequency_hz > band.low_hz && pole.frequency_hz < band.high_hz;
        let is_faint = share < LEAST_PARTICIPATION * whole;
        let margin_hz = pole.frequency_hz * if is_faint { pole.damping.max(EDGE) } else { pole.damping };
        let is_seen =
            |band: &Band| pole.frequency_hz + margin_hz < band.low_hz || pole.frequency_hz - margin_hz > band.high_hz;
        inside
            && unseen.iter().all(is_seen)
            && pole.damping < NO_VIBRATION
            && modal::is_resolved(points, pole)
            && share > SIGNIFICANT * deviation
            && share > LEAST_OF_AXIS * fit.still.abs()
    };
    let modes = (0..fit.poles.len()).filter(told).map(|k| FoundMode {
        mode: Mode {
            frequency_hz: fit.poles[k].frequency_hz,
            damping: fit.poles[k].damping,
        },
        participation: fit.shares[k].0,
        frequency_sd_hz: fit.deviations[k].0,
        damping_sd: fit.deviations[k].1,
    });
    that_ring(modes.collect())
}
