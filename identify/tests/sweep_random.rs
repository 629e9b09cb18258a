//! Random sweeps of random machines, of which nothing is said: what is found is right, or it is remarked or refused.

use posicast_identify::sweep::{self, FoundInSweep, SquareWave, Sweep, Sweeping};
use posicast_identify::synthetic::{KnownMode, Sensor, known, resonance_test};
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// Reduced square from which on a remark says that the modes do not explain the log.
const REMARKED: f64 = 4.0;

/// A machine, its sweep and its sensor. Some modes are beyond an end of the sweep.
fn case(seed: u64) -> (Vec<KnownMode>, Sweep, Sensor) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let start_hz = (random.random_range(5.0..30.0f64) * 2.0).round() / 2.0;
    let end_hz = (start_hz + random.random_range(40.0..130.0f64)).round().min(175.0);
    let rate_hz_per_s = [0.5, 1.0, 1.0, 1.5, 2.0, 3.0][random.random_range(0..6)];
    let sweeping = match random.random_range(0..2) {
        0 => Sweeping::Off,
        _ => Sweeping::Wave(SquareWave::default()),
    };
    let sample_hz = [400.0, 800.0, 1600.0, 3200.0][random.random_range(0..4)];
    let count = random.random_range(1..=3);
    let mut frequency_hz = random.random_range(0.9 * start_hz + 3.0..0.6 * end_hz);
    let mut modes = Vec::new();
    for _ in 0..count {
        if frequency_hz < 1.1 * end_hz {
            modes.push(known(
                frequency_hz,
                random.random_range(0.015..0.08),
                random.random_range(0.2..1.0),
            ));
        }
        frequency_hz *= random.random_range(1.3..1.9);
    }
    let whole: f64 = modes.iter().map(|mode| mode.share).sum();
    modes.iter_mut().for_each(|mode| mode.share /= whole);
    let driven = Sweep {
        start_hz,
        end_hz,
        rate_hz_per_s,
        acceleration_per_hz: [0.06, 0.075, 0.1][random.random_range(0..3)],
        sweeping,
    };
    let sensor = Sensor {
        sample_s: 1.0 / sample_hz,
        noise: random.random_range(0.03..0.4),
        start_s: random.random_range(0.05..1.2),
        rest_s: random.random_range(0.1..0.8),
        ..Sensor::default()
    };
    (modes, driven, sensor)
}

/// What is wrong without a remark.
fn wrong(truths: &[KnownMode], driven: &Sweep, found: &FoundInSweep) -> Option<String> {
    let sweep = &found.sweep;
    let is_other = (sweep.start_hz - driven.start_hz).abs() > 0.3
        || (sweep.end_hz - driven.end_hz).abs() > 0.6
        || (sweep.rate_hz_per_s / driven.rate_hz_per_s - 1.0).abs() > 3e-3;
    if is_other {
        return Some(format!("sweep {sweep:?}"));
    }
    if found.reduced_square > REMARKED {
        return None;
    }
    for mode in found.modes.iter().filter(|mode| !found.is_at_end(mode)) {
        let is_true = |truth: &&KnownMode| {
            (mode.mode.frequency_hz / truth.mode.frequency_hz - 1.0).abs() < 0.01
                && (mode.mode.damping / truth.mode.damping - 1.0).abs() < 0.15
        };
        if !truths.iter().any(|truth| is_true(&truth)) {
            return Some(format!("false {mode:?}"));
        }
    }
    let covered = found.covered;
    for truth in truths {
        let frequency_hz = truth.mode.frequency_hz;
        let half_hz = truth.mode.damping * frequency_hz;
        let is_seen = frequency_hz - half_hz > covered.low_hz && frequency_hz + half_hz < covered.high_hz;
        let near = |other: f64| (other / frequency_hz - 1.0).abs() < 0.02;
        let is_told = found.modes.iter().any(|mode| near(mode.mode.frequency_hz))
            || found.doubtful_hz.iter().any(|other| near(*other))
            || found.visible.is_some_and(|visible| visible.from_hz > frequency_hz);
        if is_seen && !is_told {
            return Some(format!("missing {truth:?}"));
        }
    }
    None
}

fn right_or_remarked(seeds: impl IntoIterator<Item = u64>) {
    let mut all = Vec::new();
    for seed in seeds {
        let (truths, driven, sensor) = case(seed);
        let log = resonance_test(&truths, &driven, &sensor, seed);
        if let Ok(found) = sweep::identify_any(&log) {
            let wrong = wrong(&truths, &driven, &found);
            all.extend(wrong.map(|wrong| format!("{seed}: {wrong}, of {driven:?}, {truths:?}")));
        }
    }
    assert!(all.is_empty(), "{all:#?}");
}

/// A first frequency that is not whole (3), and a pole at the first frequency that is no mode (65).
#[test]
fn results_for_an_unusual_sweep_are_right_or_remarked() {
    right_or_remarked([3, 65]);
}

/// First frequencies beside the usual one with the usual rate and end (49), and lower ones that are as like (26); a last one that a mode rings
/// beyond (39).
#[test]
fn long_results_for_other_unusual_sweeps_are_right_or_remarked() {
    right_or_remarked([26, 39, 49]);
}
