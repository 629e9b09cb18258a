//! Measures the transfer function of a log under a known excitation: divides the transforms and fills the missing samples in turn, until
//! nothing changes.

use super::excitation::SweptAcceleration;
use super::record::{Grid, Record};
use super::transfer::{Band, Division, Lines, Transfer, estimate};
use nalgebra::Complex;

/// An excitation in the grid of a log.
pub(super) struct Placed {
    pulses: Lines,
    pulses_sampled: Vec<Complex<f64>>,
    /// Aliases of the integrals of the pulses, which modes show if the samples are few.
    integrals: Vec<Lines>,
    wave: Option<PlacedWave>,
}

/// Rate of the samples in Hz above which the aliases of the integrals do not matter.
const FAST_HZ: f64 = 1500.0;

struct PlacedWave {
    lines: Lines,
    sampled: Vec<Complex<f64>>,
    /// Amplitude of the wave, relative to that of `lines`.
    gain: f64,
    /// Power of each line relative to that of the pulses around it.
    outweighs: Vec<f64>,
}

/// Measured transfer function, with the quality of the measurement.
pub(super) struct Measured {
    pub(super) transfer: Transfer,
    /// Fraction of the log's power that the excitation explains before anything is filled.
    pub(super) explained: f64,
    /// Bands in which the axis was shaken while too many samples are missing.
    pub(super) unseen: Vec<Band>,
}

impl Placed {
    /// Places the pulses, given by their lines and those of their samples, and the square wave beside them with its gain. Both begin
    /// `start_s` after the start of the grid.
    pub(super) fn new(
        grid: &Grid,
        (lines, pulses_sampled): (Lines, Vec<Complex<f64>>),
        pulses: &SweptAcceleration,
        wave: Option<(&SweptAcceleration, f64)>,
        start_s: f64,
    ) -> Self {
        let wave = wave.map(|(wave, gain)| {
            let of_wave = grid.excitation(wave, start_s);
            PlacedWave {
                outweighs: outweighs(&of_wave, &lines),
                lines: of_wave,
                sampled: grid.sampled(wave, start_s),
                gain,
            }
        });
        Self {
            integrals: if 1.0 / grid.fine_s() < FAST_HZ && !grid.is_cut() {
                grid.folded_integrals(pulses, &lines, start_s).into()
            } else {
                Vec::new()
            },
            pulses_sampled,
            pulses: lines,
            wave,
        }
    }

    fn total(&self) -> Lines {
        match &self.wave {
            None => self.pulses.clone(),
            Some(wave) => self.pulses.plus(wave.gain, &wave.lines),
        }
    }

    fn sampled(&self) -> Vec<Complex<f64>> {
        match &self.wave {
            None => self.pulses_sampled.clone(),
            Some(wave) => {
                let both = self.pulses_sampled.iter().zip(&wave.sampled);
                both.map(|(pulses, other)| pulses + other * wave.gain).collect()
            }
        }
    }

    /// Lines at which the pulses outweigh the square wave. At its harmonics the wave is so strong that the smallest error of its period or
    /// of a clock would look like a mode.
    pub(super) fn trusted(&self) -> Vec<bool> {
        /// Largest power of the wave relative to that of the pulses for a line that counts.
        const WEAK: f64 = 0.1;
        match &self.wave {
            None => vec![true; self.pulses.values.len()],
            Some(wave) => wave.outweighs.iter().map(|ratio| *ratio <= WEAK).collect(),
        }
    }
}

/// Power of each line of a wave, over the mean power of the pulses around it.
fn outweighs(wave: &Lines, pulses: &Lines) -> Vec<f64> {
    /// Lines on either side over which the pulses are averaged.
    const NEAR: usize = 8;
    let powers: Vec<f64> = pulses.values.iter().map(Complex::norm_sqr).collect();
    let ratio = |n: usize| {
        let near = &powers[n.saturating_sub(NEAR)..(n + NEAR + 1).min(powers.len())];
        let mean = near.iter().sum::<f64>() / near.len() as f64;
        wave.values[n].norm_sqr() / mean.max(f64::MIN_POSITIVE)
    };
    (0..powers.len()).map(ratio).collect()
}

/// Residual of an excitation on the samples, relative to that of one between them, below which the excitation acted on the samples.
const HELD: f64 = 0.8;
/// Largest number of turns, and the relative change of the missing samples below which a turn is the last.
const TURNS: usize = 30;
const SETTLED: f64 = 1e-3;

/// Measures the transfer function. `seen` returns, for a frequency in Hz, the fraction of the samples at which it shakes the axis that were
/// measured.
pub(super) fn measure(
    grid: &Grid,
    record: &mut Record,
    placed: &Placed,
    band: Band,
    seen: impl Fn(f64) -> f64,
) -> Measured {
    let (mut on_samples, mut change, mut turn, mut explained) = (None, f64::INFINITY, 0, 0.0);
    loop {
        let (response, _) = grid.lines(record);
        let (mut excitation, sampled, trusted) = (placed.total(), placed.sampled(), placed.trusted());
        let samples = grid.cut(&sampled, band);
        let mut folded = vec![samples.plus(-1.0, &excitation)];
        folded.extend(placed.integrals.iter().cloned());
        let divide = |excitation: &Lines, folded: &[Lines]| {
            let division = Division {
                response: &response,
                excitation,
                folded,
                trusted: &trusted,
            };
            estimate(&division, &seen)
        };
        let between = || divide(&excitation, &folded);
        // A real axis is excited at the time of the sweep; a simulated one often only from the next sample on, by everything that
        // the samples alias.
        let found = match on_samples {
            None => {
                let (between, held) = (between(), divide(&samples, &[]));
                let is_held = 1.0 - held.explained < HELD * (1.0 - between.explained);
                on_samples = Some(is_held);
                if is_held { held } else { between }
            }
            Some(true) => divide(&samples, &[]),
            Some(false) => between(),
        };
        if on_samples == Some(true) {
            excitation = samples;
        }
        if turn == 0 {
            explained = found.explained;
        }
        let transfer = found.lines(&excitation);
        let is_last = turn >= TURNS || (turn > 0 && change < SETTLED);
        if is_last {
            return Measured {
                unseen: found.unseen(&excitation),
                explained,
                transfer: found.transfer(),
            };
        }
        let mut predicted = placed.sampled();
        let (low, high) = (found.gain(false), found.gain(true));
        let total = placed.total();
        let first = total.first;
        for (n, line) in predicted.iter_mut().enumerate() {
            let in_band = n.checked_sub(first).filter(|n| *n < transfer.len());
            *line = match in_band {
                None => *line * if n < first { low } else { high },
                Some(n) if on_samples == Some(true) => *line * transfer[n],
                Some(n) => {
                    let parts = found.folded.iter().zip(&folded);
                    total.values[n] * transfer[n]
                        + parts.map(|(share, part)| part.values[n] * *share).sum::<Complex<f64>>()
                }
            };
        }
        change = record.fill(&grid.samples(predicted), grid.is_cut());
        turn += 1;
    }
}
