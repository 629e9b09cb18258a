//! Tests the methods on logs of random machines, chosen by a seed: the modes that [`synthetic`](crate::synthetic) simulates must be found
//! again.
//!
//! A machine has one to three modes from 20 to 150 Hz, at least 35 % apart, with damping ratios of 0.015 to 0.08 and comparable shares.
//! Its log is a resonance test with an accelerometer, or positions after a pseudo-random command or a step.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::found::FoundMode;
use crate::position;
use crate::sweep::{self, Sweep};
use crate::synthetic::{KnownMode, Sensor, known, position_log, pseudo_random, resonance_test, step};

/// Largest relative error of a frequency.
pub const FREQUENCY_ERROR: f64 = 0.01;
/// Largest relative error of a damping ratio.
pub const DAMPING_ERROR: f64 = 0.15;
/// Largest error of a modal participation.
pub const PARTICIPATION_ERROR: f64 = 0.05;

/// Results for some logs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TrialReport {
    /// Number of logs.
    pub logs: u64,
    /// Number of modes of their machines.
    pub modes: u64,
    /// Number of modes whose stated 95 % interval of the frequency contains the true one.
    pub frequencies_held: u64,
    /// The same for the damping ratio.
    pub dampings_held: u64,
    /// One sentence for each log in which another number of modes was found, or one with a larger error.
    pub wrong: Vec<String>,
}

/// Identifies the logs of these seeds.
pub fn run(seeds: impl IntoIterator<Item = u64>) -> TrialReport {
    let mut report = TrialReport::default();
    for seed in seeds {
        let truths = machine(seed);
        report.logs += 1;
        report.modes += truths.len() as u64;
        match identified(&truths, seed) {
            Ok(found) => compare(&truths, &found, seed, &mut report),
            Err(problem) => report.wrong.push(format!("log {seed}: {problem}")),
        }
    }
    report
}

/// The modes of a machine, in order of frequency.
fn machine(seed: u64) -> Vec<KnownMode> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut frequency_hz = rng.random_range(20.0..45.0);
    let mut modes: Vec<KnownMode> = (0..rng.random_range(1..=3))
        .map(|_| {
            let mode = known(frequency_hz, rng.random_range(0.015..0.08), rng.random_range(0.4..1.0));
            frequency_hz *= rng.random_range(1.35..1.8);
            mode
        })
        .collect();
    let sum: f64 = modes.iter().map(|mode| mode.share).sum();
    modes.iter_mut().for_each(|mode| mode.share /= sum);
    modes
}

/// The modes that are found in a log of this machine.
fn identified(truths: &[KnownMode], seed: u64) -> Result<Vec<FoundMode>, String> {
    if seed.is_multiple_of(2) {
        let sweep = Sweep {
            end_hz: 180.0,
            rate_hz_per_s: 10.0,
            ..Sweep::default()
        };
        let sensor = Sensor {
            sample_s: 1.0 / 1600.0,
            noise: 0.4,
            ..Sensor::default()
        };
        let log = resonance_test(truths, &sweep, &sensor, seed);
        return sweep::identify(&log, &sweep)
            .map(|found| found.modes)
            .map_err(|error| error.to_string());
    }
    let command = if seed % 4 == 1 {
        pseudo_random(4000, 4)
    } else {
        step(3000)
    };
    let log = position_log(truths, &command, 1e-3, 0.002, seed).map_err(|error| error.to_string())?;
    position::identify(&log)
        .map(|found| found.modes)
        .map_err(|error| error.to_string())
}

fn compare(truths: &[KnownMode], found: &[FoundMode], seed: u64, report: &mut TrialReport) {
    if truths.len() != found.len() {
        let list = |modes: &mut dyn Iterator<Item = f64>| {
            let words: Vec<String> = modes.map(|frequency_hz| format!("{frequency_hz:.2}")).collect();
            format!("[{}] Hz", words.join(", "))
        };
        report.wrong.push(format!(
            "log {seed}: found modes at {}, but the machine has {}",
            list(&mut found.iter().map(|found| found.mode.frequency_hz)),
            list(&mut truths.iter().map(|truth| truth.mode.frequency_hz))
        ));
        return;
    }
    let mut wrong = None;
    for (truth, found) in truths.iter().zip(found) {
        report.frequencies_held += u64::from(found.frequency_interval_hz().holds(truth.mode.frequency_hz));
        report.dampings_held += u64::from(found.damping_interval().holds(truth.mode.damping));
        let frequency = found.mode.frequency_hz / truth.mode.frequency_hz - 1.0;
        let damping = found.mode.damping / truth.mode.damping - 1.0;
        let participation = found.participation - truth.share;
        let is_close = frequency.abs() <= FREQUENCY_ERROR
            && damping.abs() <= DAMPING_ERROR
            && participation.abs() <= PARTICIPATION_ERROR;
        if !is_close {
            wrong = Some(format!(
                "log {seed}: the mode at {:.2} Hz is wrong by {:.2} % in frequency, {:.1} % in damping and {participation:.3} in participation",
                truth.mode.frequency_hz,
                100.0 * frequency,
                100.0 * damping
            ));
        }
    }
    report.wrong.extend(wrong);
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_shaper::mode::Mode;

    fn found(truth: &KnownMode, frequency: f64, damping: f64, participation: f64) -> FoundMode {
        FoundMode {
            mode: Mode {
                frequency_hz: truth.mode.frequency_hz * frequency,
                damping: truth.mode.damping * damping,
            },
            participation: truth.share + participation,
            frequency_sd_hz: 0.01,
            damping_sd: 1e-4,
        }
    }

    #[test]
    fn wrong_results_are_counted_and_named() {
        let truths = [known(30.0, 0.05, 0.6), known(60.0, 0.03, 0.4)];
        let report_of = |list: &[FoundMode]| {
            let mut report = TrialReport::default();
            compare(&truths, list, 7, &mut report);
            report
        };
        let right = truths.map(|truth| found(&truth, 1.0, 1.0, 0.0));
        let report = report_of(&right);
        assert_eq!((report.frequencies_held, report.dampings_held), (2, 2));
        assert_eq!(report.wrong, [""; 0]);
        for wrong in [
            found(&truths[1], 1.02, 1.0, 0.0),
            found(&truths[1], 1.0, 0.8, 0.0),
            found(&truths[1], 1.0, 1.0, 0.06),
        ] {
            let report = report_of(&[right[0], wrong]);
            assert!(
                report.wrong[0].starts_with("log 7: the mode at 60.00 Hz is wrong by"),
                "{report:?}"
            );
        }
        let report = report_of(&right[..1]);
        assert_eq!(
            report.wrong,
            ["log 7: found modes at [30.00] Hz, but the machine has [30.00, 60.00] Hz"]
        );
    }
}
