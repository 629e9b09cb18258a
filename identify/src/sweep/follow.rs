//! Follows a log with one description of its sweep and one clock.

use super::begin::{Begun, begin, placed, sought, timed};
use super::crossing::{crossing, outside, weighed};
use super::excitation::{Sweep, Sweeping, SweptAcceleration};
use super::measure::{Placed, measure};
use super::modes::{Told, modes, told};
use super::record::{Grid, Record};
use super::reduce::Reduced;
use super::transfer::{self, Band, Lines, Transfer};
use super::{FoundInSweep, SweepError, wave};
use crate::modal::{self, Lateness, Phase, Pole, ResponsePoint};
use crate::separable::Effort;
use nalgebra::Complex;

/// Margin of the band beyond the sweep's frequencies, relative.
const MARGIN: f64 = 0.02;
/// Smallest fraction of the power that the sweep must explain.
const LEAST_EXPLAINED: f64 = 0.2;
/// Smallest fraction of the transfer function's power that the modes must explain.
const LEAST_TOLD: f64 = 0.8;
/// Bend in seconds above which a log is followed again with a corrected clock: the fit compensates a smaller one.
const BEND_S: f64 = 3e-3;

/// Bend, over the period of the highest frequency, above which modes cannot cause it: a mode turns the phase by half a turn, which looks
/// like a bend of one period, and two modes double it.
const HALF_TURNS: f64 = 1.6;

/// Number of standard deviations by which a bend must exceed zero.
const CERTAIN: f64 = 6.0;

/// Range in which an error of the clock is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// Up to a tenth of a percent.
    Everywhere,
    /// Only as far as the fit moves without a search.
    Near,
    /// The clock is not corrected.
    Nowhere,
}

/// Result of following a log with one clock.
pub(super) enum Pass {
    /// The clock has this relative error.
    Drifts(f64),
    Ended(Box<Followed>),
}

/// A log followed with one description of its sweep.
#[derive(Debug)]
pub(super) struct Followed {
    pub(super) found: FoundInSweep,
    /// The poles of the fit, also those that are no modes.
    pub(super) poles: Vec<Pole>,
    /// Whether the poles are those of another description, moved to this one: enough to compare the two.
    pub(super) is_rough: bool,
}

/// What another description of the sweep found in the log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<'a> {
    poles: &'a [Pole],
    /// Gain of the square wave beside the sweep.
    gain: f64,
}

impl Followed {
    pub(super) fn known(&self) -> Known<'_> {
        Known {
            poles: &self.poles,
            gain: told_gain(self.found.static_gain),
        }
    }
}

/// Follows the log whose clock is assumed to run faster than that of the sweep by the factor `clock`. With a `known` description, whose
/// poles are moved, no others are sought and the transfer function is measured once.
///
/// # Errors
/// [`SweepError`] if no modes can be determined.
pub(super) fn pass(
    log: &Reduced<'_>,
    sweep: &Sweep,
    clock: f64,
    look: Look,
    known: Option<Known<'_>>,
) -> Result<Pass, SweepError> {
    let band = Band {
        low_hz: sweep.start_hz * (1.0 + MARGIN),
        high_hz: sweep.end_hz * (1.0 - MARGIN),
    };
    // A clock that is fast by ε sees f later by ε·f/rate and takes it for f/(1 + ε), which was due earlier by as much. The sum is the group
    // delay, which is twice the bend.
    let error = |bend_s: f64| bend_s * sweep.rate_hz_per_s / band.high_hz;
    let mut grid = Grid::new(log, clock, band);
    let (sample_s, fine_s, seconds) = (grid.sample_s(), grid.fine_s(), log.seconds() / clock);
    let strongest = strongest(log, &grid).ok_or(SweepError::Empty)?;
    let Strongest {
        direction,
        mut record,
        response,
        all,
    } = strongest;
    let begun = begin(&grid, &response, sweep).ok_or(SweepError::Empty)?;
    let ends_s = begun.start_s + begun.excitation.duration_s() - grid.before_s();
    if begun.start_s < grid.before_s() - CUT_S || ends_s > seconds + CUT_S {
        grid.cut_to_log();
    }
    let smooth = placed(&grid, &begun, begun.start_s);
    if look == Look::Everywhere {
        let bend_s = transfer::bend(&response, &smooth, band.high_hz);
        if bend_s.abs() > HALF_TURNS / band.high_hz {
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
        // The axis then stops in an unknown way.
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
    // The wave's amplitude is known as the sensor shows it; that of the sweep only from its description.
    let mut gain = known.map_or(1.0, |known| known.gain);
    let first = moved.as_ref().map(|wave| (wave, gain));
    let rough_placed = Placed::new(&grid, (smooth, pulses), &begun.excitation, first, begun.start_s);
    let mut measured = measure(&grid, &mut record, &rough_placed, band, seen(begun.start_s));
    if measured.explained < LEAST_EXPLAINED {
        return Err(SweepError::Unrelated(measured.explained));
    }
    let covered = covered?;
    let mut transfer = std::mem::replace(&mut measured.transfer, Transfer::empty()).within(&covered);
    let crossing = crossing(fine_s);
    let timed =
        timed(&outside(&transfer.points, &crossing), known.map(|known| known.poles)).ok_or(SweepError::Empty)?;
    let late = timed.phase.lateness();
    let bends = late.bend_s.abs() > BEND_S && late.bend_s.abs() > CERTAIN * timed.bend_deviation_s;
    if bends && look != Look::Nowhere {
        return Ok(Pass::Drifts(error(late.bend_s)));
    }
    let is_slow = fine_s * SLOW_HZ > 1.0;
    let (mut start_s, mut near) = (begun.start_s, timed);
    if known.is_none() || is_slow {
        start_s += late.delay_s;
        // The aliased part is known only after the start is known to a small part of a sample.
        if is_slow {
            let (response, _) = grid.lines(&record);
            let both = moved.as_ref().map(|wave| begun.excitation.beside(wave));
            start_s = sought(
                &grid,
                &response,
                &rough_placed.trusted(),
                both.as_ref().unwrap_or(&begun.excitation),
                start_s,
            );
        }
        for turn in 0.. {
            let smooth = placed(&grid, &begun, start_s);
            let again = moved.as_ref().map(|wave| (wave, gain));
            let pulses = grid.sampled(&begun.excitation, start_s);
            let exact = Placed::new(&grid, (smooth, pulses), &begun.excitation, again, start_s);
            measured = measure(&grid, &mut record, &exact, band, seen(start_s));
            transfer = std::mem::replace(&mut measured.transfer, Transfer::empty()).within(&covered);
            let points = &outside(&transfer.points, &crossing);
            let rest = Phase::Late(Lateness::default());
            near = modal::refine(points, &near.poles, rest, Effort::Rough).ok_or(SweepError::Empty)?;
            let delay_s = near.phase.lateness().delay_s;
            let told = told_gain(near.still.abs());
            let is_louder =
                sweep.sweeping == Sweeping::FromLog && wave.is_some() && (gain / told).ln().abs() > SAME_GAIN;
            let known_to = if is_slow { START_SAMPLES } else { START_FAST };
            let is_late = delay_s.abs() > fine_s * known_to;
            if !(is_late || is_louder) || turn == START_TURNS {
                break;
            }
            start_s += delay_s;
            gain = if is_louder { told } else { gain };
        }
    }
    if known.is_none() {
        let points = &outside(&transfer.points, &crossing);
        near = modal::pruned(points, modal::grown(points, near));
    }
    let all = |points: &[ResponsePoint], effort| modal::refine(points, &near.poles, near.phase, effort);
    if outside(&transfer.points, &crossing).len() < transfer.points.len() {
        let fit = all(&transfer.points, Effort::Rough).ok_or(SweepError::Empty)?;
        weighed(&mut transfer.points, &crossing, &fit);
    }
    let fit = all(&transfer.points, Effort::Full).ok_or(SweepError::Empty)?;
    let told = told(&transfer, &fit);
    if told < LEAST_TOLD {
        return Err(SweepError::Unlike(told));
    }
    let Told { modes, doubtful } = modes(&fit, &transfer.points, &covered, &measured.unseen, sweep.rate_hz_per_s);
    let found = FoundInSweep {
        visible: modal::visible(&transfer.points, &fit, &modes),
        modes,
        doubtful_hz: doubtful.iter().map(|found| found.mode.frequency_hz).collect(),
        direction,
        sweep: *sweep,
        is_estimated: false,
        static_gain: fit.still.abs(),
        wave,
        unseen: measured.unseen,
        start_s: start_s - grid.log_begins_s() + fit.phase.lateness().delay_s,
        clock_error: 0.0,
        order: begun.order,
        rise: begun.rise,
        covered,
        reduced_square: fit.reduced_square(),
        fitted: fit.values,
        transfer,
    };
    Ok(Pass::Ended(Box::new(Followed {
        found,
        poles: fit.poles,
        is_rough: known.is_some(),
    })))
}

/// Rate of the samples in Hz below which the start is sought on the samples.
const SLOW_HZ: f64 = 600.0;
/// Largest logarithm of the ratio for which the gains of sweep and square wave count as equal.
const SAME_GAIN: f64 = 0.03;
/// Part of a sample to which the start must be known, if samples are few and if they are many, and the largest number of corrections.
const START_SAMPLES: f64 = 0.01;
const START_FAST: f64 = 0.05;
const START_TURNS: usize = 3;
/// Time in seconds of a sweep that a log may lack and still count as whole.
const CUT_S: f64 = 0.3;
/// Time in seconds before the end of a sweep with a square wave from which on the motion is unknown, because the firmware brakes.
const STOP_S: f64 = 0.05;

/// Gain of a square wave beside a sweep with this static gain.
fn told_gain(static_gain: f64) -> f64 {
    1.0 / static_gain.clamp(0.1, 10.0)
}

/// The direction with the most power in the band.
struct Strongest {
    direction: String,
    record: Record,
    response: Lines,
    all: Vec<Complex<f64>>,
}

fn strongest(log: &Reduced<'_>, grid: &Grid) -> Option<Strongest> {
    let directions = log.directions.iter().map(|(name, values)| {
        let record = grid.record(values, log.missing);
        let (response, all) = grid.lines(&record);
        Strongest {
            direction: (*name).to_owned(),
            record,
            response,
            all,
        }
    });
    directions.max_by(|a, b| a.response.power().total_cmp(&b.response.power()))
}

/// Returns the part of the band in which the axis is shaken during the log. The harmonics of the sweep shake it above, but too little to be
/// trusted.
///
/// # Errors
/// [`SweepError::Piece`]: dividing the transforms needs a log from rest to rest, and a log with neither end of the sweep has no rest at
/// all.
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
