//! Modes from accelerometer logs, compared with machines whose modes are known.

use crate::expected::check;
use posicast_identify::AccelerationLog;
use posicast_identify::sweep::{self, Sweep, SweepError};
use posicast_identify::synthetic::{Noise, Sensor, known, resonance_test};

/// Returns a sweep of 13 s, used where many logs are checked.
fn quick() -> Sweep {
    Sweep {
        rate_hz_per_s: 10.0,
        ..Sweep::default()
    }
}

#[test]
fn the_modes_of_a_printers_log_are_found() {
    // One mode; two; a pair 8 % apart; a weak one beside a strong one; four; one behind a rigid part of 30 %.
    let machines = [
        vec![known(44.3, 0.053, 1.0)],
        vec![known(35.0, 0.03, 0.7), known(72.0, 0.05, 0.3)],
        vec![known(50.0, 0.04, 0.5), known(54.0, 0.05, 0.5)],
        vec![known(28.0, 0.02, 0.88), known(61.0, 0.06, 0.12)],
        vec![
            known(23.0, 0.05, 0.4),
            known(41.0, 0.03, 0.3),
            known(68.0, 0.06, 0.2),
            known(101.0, 0.02, 0.1),
        ],
        vec![known(39.0, 0.1, 0.4), known(90.0, 0.012, 0.3)],
    ];
    for (n, truths) in machines.iter().enumerate() {
        let sensor = Sensor {
            // Every other case holds the command, as a simulation on a grid does.
            held: n % 2 == 1,
            ..Sensor::default()
        };
        let log = resonance_test(truths, &Sweep::default(), &sensor, n as u64);
        let found = sweep::identify(&log, &Sweep::default()).unwrap();
        check(truths, &found.modes);
        assert_eq!(found.direction, "accel_x");
        assert!((found.start_s - sensor.start_s).abs() < 2e-3, "{}", found.start_s);
    }
}

/// Requires that at least nine tenths of the stated intervals hold the truth, over this many logs.
fn intervals_hold_the_truth(logs: u32) {
    let (mut modes, mut frequencies, mut dampings) = (0, 0, 0);
    for seed in 0..logs {
        let truths = [known(31.0, 0.04, 0.6), known(58.0, 0.03, 0.4)];
        let sensor = Sensor {
            sample_s: 1.0 / 1600.0,
            noise: 0.4,
            start_s: 0.1 + 1e-3 * f64::from(seed),
            ..Sensor::default()
        };
        let log = resonance_test(&truths, &quick(), &sensor, seed.into());
        let found = sweep::identify(&log, &quick()).unwrap();
        check(&truths, &found.modes);
        for (truth, found) in truths.iter().zip(&found.modes) {
            modes += 1;
            frequencies += usize::from(found.frequency_interval_hz().holds(truth.mode.frequency_hz));
            dampings += usize::from(found.damping_interval().holds(truth.mode.damping));
        }
    }
    let least = modes * 9 / 10;
    assert!(
        frequencies >= least && dampings >= least,
        "{frequencies} and {dampings} of {modes}"
    );
}

#[test]
fn stated_intervals_hold_the_truth() {
    intervals_hold_the_truth(30);
}

#[test]
fn long_stated_intervals_hold_the_truth_over_200_logs() {
    intervals_hold_the_truth(200);
}

#[test]
fn no_mode_is_invented() {
    // A rigid axis, and one whose only mode is negligible.
    for truths in [vec![], vec![known(60.0, 0.03, 0.0005)]] {
        let log = resonance_test(&truths, &quick(), &Sensor::default(), 3);
        let found = sweep::identify(&log, &quick()).unwrap();
        assert!(found.modes.len() <= truths.len(), "{:#?}", found.modes);
        assert!(found.transfer.explained > 0.9);
    }
}

#[test]
fn a_log_of_something_else_is_refused() {
    let mut noise = Noise::new(7);
    let record = (0..40_000).map(|_| noise.draw()).collect();
    let log = AccelerationLog {
        sample_s: 1.0 / 3200.0,
        directions: vec![("accel_x".into(), record)],
        missing: Vec::new(),
    };
    assert!(matches!(sweep::identify(&log, &quick()), Err(SweepError::Unrelated(_))));
    let short = AccelerationLog {
        directions: vec![("accel_x".into(), vec![1.0; 100])],
        ..log.clone()
    };
    assert!(matches!(
        sweep::identify(&short, &quick()),
        Err(SweepError::Short { .. })
    ));
    for wrong in [
        Sweep { end_hz: 4.0, ..quick() },
        Sweep {
            rate_hz_per_s: 0.0,
            ..quick()
        },
        Sweep {
            end_hz: 1700.0,
            ..quick()
        },
        Sweep {
            start_hz: f64::NAN,
            ..quick()
        },
        Sweep {
            rate_hz_per_s: 1e-9,
            ..quick()
        },
    ] {
        assert!(matches!(sweep::identify(&log, &wrong), Err(SweepError::Description(_))));
    }
}

#[test]
fn a_log_that_begins_within_the_sweep_gives_the_modes_it_covers() {
    let truths = [known(60.0, 0.04, 1.0)];
    let mut log = resonance_test(&truths, &quick(), &Sensor::default(), 5);
    for (_, record) in &mut log.directions {
        record.drain(..3200 * 2);
    }
    let found = sweep::identify(&log, &quick()).unwrap();
    check(&truths, &found.modes);
    assert!(found.start_s < -1.5, "{}", found.start_s);
}

#[test]
fn a_log_with_neither_end_of_the_sweep_is_refused() {
    // The shaking from 30 to 85 Hz at 2 Hz/s is also that of one from 5 to 135 Hz at 1 Hz/s, at twice its frequencies and in one direction.
    let driven = Sweep {
        start_hz: 30.0,
        end_hz: 85.0,
        rate_hz_per_s: 2.0,
        ..Sweep::default()
    };
    let truths = [known(44.3, 0.053, 0.75), known(71.0, 0.04, 0.25)];
    let sensor = Sensor {
        sample_s: 1.0 / 400.0,
        ..Sensor::default()
    };
    let log = resonance_test(&truths, &driven, &sensor, 5);
    check(&truths, &sweep::identify(&log, &driven).unwrap().modes);
    let error = sweep::identify(&log, &Sweep::default()).unwrap_err();
    assert!(matches!(error, SweepError::Piece(_)), "{error}");
}

#[test]
fn no_mode_is_reported_at_frequencies_the_log_lacks() {
    let truths = [known(30.0, 0.04, 0.6), known(90.0, 0.03, 0.4)];
    let mut log = resonance_test(&truths, &quick(), &Sensor::default(), 5);
    for (_, record) in &mut log.directions {
        // 5.8 s of the sweep, up to 63 Hz.
        record.truncate((0.437_21 * 3200.0) as usize + 18_560);
    }
    let found = sweep::identify(&log, &quick()).unwrap();
    assert!((found.covered.high_hz - 63.0).abs() < 0.5, "{:?}", found.covered);
    check(&truths[..1], &found.modes);
}

#[test]
fn a_clock_that_drifts_is_set_by_the_sweep() {
    let truths = [known(38.0, 0.04, 0.7), known(66.0, 0.05, 0.3)];
    for error in [-2e-4, 1e-4, 5e-4] {
        let mut log = resonance_test(&truths, &Sweep::default(), &Sensor::default(), 5);
        log.sample_s *= 1.0 + error;
        let found = sweep::identify(&log, &Sweep::default()).unwrap();
        check(&truths, &found.modes);
        assert!(
            (found.clock_error - error).abs() < 2e-5,
            "{error} {}",
            found.clock_error
        );
    }
}

#[test]
fn modes_are_found_in_a_log_that_is_mostly_noise() {
    let truths = [known(45.0, 0.05, 1.0)];
    let sensor = Sensor {
        noise: 15.0,
        ..Sensor::default()
    };
    let log = resonance_test(&truths, &Sweep::default(), &sensor, 5);
    check(&truths, &sweep::identify(&log, &Sweep::default()).unwrap().modes);
}
