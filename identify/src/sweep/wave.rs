//! Finds the square wave that firmware adds to a sweep, in the part of a log's spectrum below the sweep.

use super::excitation::{SquareWave, SweptAcceleration};
use super::record::Grid;
use super::transfer::{Band, Lines};
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};

/// Highest frequency at which the wave is sought, as a fraction of the sweep's lowest frequency.
const BELOW: f64 = 0.9;
/// Smallest energy of the wave, relative to the median of a line below the sweep; noise reaches a few times the median by chance.
const LEAST_ENERGY: f64 = 200.0;
/// Smallest ratio of what the wave explains with its phase to what it would explain with the best phase.
const IN_PHASE: f64 = 0.8;
/// Smallest fraction of the best period's energy with which the usual period is chosen.
const USUAL: f64 = 0.8;

/// Finds the square wave in a log. `all` are the log's lines and `pulses` those of the sweep's pulses, which begin `start_s` after the
/// start of the grid and end `end_s` later. Returns `None` if there is no wave.
pub(super) fn find(
    grid: &Grid,
    all: &[Complex<f64>],
    pulses: &[Complex<f64>],
    lowest_hz: f64,
    start_s: f64,
    end_s: f64,
) -> Option<SquareWave> {
    let band = Band {
        low_hz: 2.0 / grid.seconds(),
        high_hz: BELOW * lowest_hz,
    };
    let lines = grid.cut(all, band).plus(-1.0, &grid.cut(pulses, band));
    let mut powers: Vec<f64> = lines.values.iter().map(Complex::norm_sqr).collect();
    if powers.len() < 8 {
        return None;
    }
    let strongest = (0..powers.len()).max_by(|a, b| powers[*a].total_cmp(&powers[*b]))?;
    let peak_hz = lines.frequency_hz(strongest);
    let middle = powers.len() / 2;
    let (_, median, _) = powers.select_nth_unstable_by(middle, f64::total_cmp);
    let least = LEAST_ENERGY * *median;
    let tried = |period_s: f64| Tried::new(&lines, grid, period_s, start_s, end_s);
    let usual = tried(SquareWave::default().period_s);
    // The strongest line is the wave's first harmonic, so its frequency is known to the distance of a line.
    let off = |part: f64| 1.0 / (peak_hz + part * lines.resolution_hz);
    let coarse = (-10..=10).map(|n| tried(off(0.1 * f64::from(n))));
    let best = coarse.max_by(|a, b| a.energy.total_cmp(&b.energy))?;
    let close = (-20..=20).map(|n| tried(1.0 / (1.0 / best.period_s + 0.005 * f64::from(n) * lines.resolution_hz)));
    let best = close.max_by(|a, b| a.energy.total_cmp(&b.energy))?;
    let chosen = if usual.energy > USUAL * best.energy {
        usual
    } else {
        best
    };
    let is_one = chosen.energy > least && chosen.in_phase > IN_PHASE && chosen.period_s * lowest_hz * BELOW > 1.0;
    is_one.then_some(SquareWave {
        acceleration: chosen.acceleration,
        period_s: chosen.period_s,
    })
}

/// A square wave of some period, and how much it explains.
struct Tried {
    period_s: f64,
    acceleration: f64,
    energy: f64,
    in_phase: f64,
}

impl Tried {
    fn new(lines: &Lines, grid: &Grid, period_s: f64, start_s: f64, end_s: f64) -> Self {
        let unit = SquareWave {
            acceleration: 1.0,
            period_s,
        };
        let of_wave = wave_spectrum(&unit, lines, grid.sample_s(), start_s, end_s);
        let (mut cross, mut square) = (Complex::new(0.0, 0.0), f64::MIN_POSITIVE);
        for (line, wave) in lines.values.iter().zip(&of_wave) {
            cross += line * wave.conj();
            square += wave.norm_sqr();
        }
        Self {
            period_s,
            acceleration: cross.re.abs() / square,
            energy: cross.norm_sqr() / square,
            in_phase: cross.re.abs() / cross.norm().max(f64::MIN_POSITIVE),
        }
    }
}

/// Lines of a square wave that ends `end_s` after its start, in the form of [`spectrum`]. All edges between the second and the last are
/// half a period apart and alternate in sign, so their sum is that of a geometric series: a period below the sweep may have thousands.
fn wave_spectrum(wave: &SquareWave, lines: &Lines, sample_s: f64, start_s: f64, end_s: f64) -> Vec<Complex<f64>> {
    let mut edges_s = wave.edges_s();
    let (first_s, second_s) = (edges_s.next().unwrap_or(end_s), edges_s.next().unwrap_or(end_s));
    let half_s = 0.5 * wave.period_s;
    // The wave has only the edges before its end.
    let later = ((end_s - second_s) / half_s).ceil().max(0.0);
    let is_positive = match (first_s < end_s, later % 2.0 == 0.0) {
        (false, _) => true,
        (true, is_even) => !is_even,
    };
    let line = |n: usize| {
        let omega = TAU * lines.frequency_hz(n);
        let at = |time_s: f64, size: f64| Complex::from_polar(size, -omega * (start_s + time_s));
        let mut sum = at(0.0, 1.0) - at(end_s, if is_positive { 1.0 } else { -1.0 });
        if first_s < end_s {
            sum -= at(first_s, 2.0);
        }
        if later > 0.0 {
            // Σ (−q)^n with q = e^{−jωP/2}, by the sines of half the angle of −q, which are exact where −q is near 1.
            let angle = (PI - omega * half_s).rem_euclid(TAU);
            let angle = if angle > PI { angle - TAU } else { angle };
            let size = match (0.5 * angle).sin() {
                0.0 => later,
                sine => (0.5 * later * angle).sin() / sine,
            };
            sum += at(second_s, 2.0 * size) * Complex::from_polar(1.0, 0.5 * (later - 1.0) * angle);
        }
        sum * (wave.acceleration / (omega * sample_s)) * Complex::new(0.0, -1.0)
    };
    (0..lines.values.len()).map(line).collect()
}

/// Lines of an acceleration, from its edges: `Σ Δa·e^{−j2πft}/(j2πf)` over the time between samples.
pub(super) fn spectrum(
    excitation: &SweptAcceleration,
    lines: &Lines,
    sample_s: f64,
    start_s: f64,
) -> Vec<Complex<f64>> {
    /// Edges whose phases turn side by side: the next phase of one edge waits for its last one.
    const BESIDE: usize = 8;
    let mut sum = vec![Complex::ZERO; lines.values.len()];
    let mut before = 0.0;
    let edges = excitation.pieces().map(|(begin_s, acceleration)| {
        let (late_s, size) = (start_s + begin_s, acceleration - before);
        before = acceleration;
        (late_s, size)
    });
    let edges: Vec<(f64, f64)> = edges.collect();
    for edges in edges.chunks(BESIDE) {
        let (mut turns, mut steps) = ([Complex::ZERO; BESIDE], [Complex::ZERO; BESIDE]);
        for (n, &(late_s, size)) in edges.iter().enumerate() {
            turns[n] = Complex::from_polar(size, -TAU * lines.frequency_hz(0) * late_s);
            steps[n] = Complex::from_polar(1.0, -TAU * lines.resolution_hz * late_s);
        }
        for line in &mut sum {
            for (turn, step) in turns.iter_mut().zip(&steps) {
                *line += *turn;
                *turn *= step;
            }
        }
    }
    for (n, line) in sum.iter_mut().enumerate() {
        *line /= Complex::new(0.0, TAU * lines.frequency_hz(n) * sample_s);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_a_square_wave_match_the_sum_over_its_edges() {
        let lines = Lines {
            first: 2,
            resolution_hz: 0.0125,
            dense: 1,
            values: vec![Complex::new(0.0, 0.0); 400],
        };
        // A period of 1.6 s has its harmonics on lines; the last three waves end before the third, the second and the first edge.
        for (period_s, end_s) in [
            (1.6, 60.0),
            (1.6, 60.4),
            (1.2, 77.77),
            (0.3, 79.0),
            (1.6, 0.95),
            (1.6, 0.8),
            (1.6, 0.2),
        ] {
            let wave = SquareWave {
                acceleration: 0.4,
                period_s,
            };
            let found = wave_spectrum(&wave, &lines, 1e-3, 0.7, end_s);
            let expected = spectrum(&SweptAcceleration::square_wave(&wave, end_s), &lines, 1e-3, 0.7);
            let largest = expected.iter().map(|line| line.norm()).fold(0.0, f64::max);
            for (n, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).norm() < 1e-9 * largest,
                    "{period_s} {end_s} {n}: {found} {expected}"
                );
            }
        }
    }
}
