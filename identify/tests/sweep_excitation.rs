//! The excitation of a printer's log: with and without the square wave of Klipper's present test, and sweeps that the log itself tells.

use crate::expected::check_poles;
use posicast_identify::AccelerationLog;
use posicast_identify::log::{self, Log};
use posicast_identify::sweep::{self, FoundInSweep, SquareWave, Sweep, SweepError, Sweeping};
use posicast_identify::synthetic::{KnownMode, Sensor, known, present_test, resonance_test};

/// A rigid machine, and one with its mode above the band; and two with one weak mode or two strong ones.
fn machines() -> [Vec<KnownMode>; 4] {
    [
        vec![],
        vec![known(170.0, 0.03, 1.0)],
        vec![known(60.0, 0.04, 0.05)],
        vec![known(28.0, 0.03, 0.5), known(60.0, 0.05, 0.5)],
    ]
}

/// Klipper's test before December 2024.
fn old_test() -> Sweep {
    Sweep {
        acceleration_per_hz: 0.075,
        ..Sweep::default()
    }
}

/// Identifies logs of both tests of each machine at these rates of the sensor.
fn both_tests_tell_the_modes(rates_hz: &[f64]) {
    for (truths, rate_hz) in machines()
        .iter()
        .flat_map(|truths| rates_hz.iter().map(move |rate| (truths, rate)))
    {
        for driven in [old_test(), present_test()] {
            let sensor = Sensor {
                sample_s: 1.0 / rate_hz,
                ..Sensor::default()
            };
            let log = resonance_test(truths, &driven, &sensor, 1);
            let found = sweep::identify(&log, &Sweep::default()).unwrap();
            let seen: Vec<KnownMode> = truths.iter().filter(|t| t.mode.frequency_hz < 130.0).copied().collect();
            check_poles(&seen, &found.modes);
            match (driven.sweeping, found.wave) {
                (Sweeping::Wave(truth), Some(wave)) => {
                    assert!((wave.acceleration / truth.acceleration - 1.0).abs() < 0.1, "{wave:?}");
                    assert!((wave.period_s / truth.period_s - 1.0).abs() < 1e-3, "{wave:?}");
                }
                (Sweeping::Wave(_), None) | (_, Some(_)) => panic!("{driven:?} {:?}", found.wave),
                (_, None) => {}
            }
        }
    }
}

#[test]
fn both_firmware_tests_give_the_modes_at_400_and_800_hz() {
    both_tests_tell_the_modes(&[400.0, 800.0]);
}

#[test]
fn long_both_firmware_tests_give_the_modes_at_1600_and_3200_hz() {
    both_tests_tell_the_modes(&[1600.0, 3200.0]);
}

fn case() -> AccelerationLog {
    match log::read(include_bytes!("data/rigid-5-40.csv")).unwrap().log {
        Log::Acceleration(log) => log,
        other => panic!("{other:?}"),
    }
}

/// A rigid machine under Klipper's present test from 5 to 40 Hz, by a generator that is not ours.
#[test]
fn the_square_wave_in_a_rigid_machines_log_is_not_a_mode() {
    let sweep = Sweep {
        end_hz: 40.0,
        ..Sweep::default()
    };
    let is_right = |found: &FoundInSweep| {
        assert_eq!(found.modes, [], "{:?}", found.modes);
        let wave = found.wave.unwrap();
        assert!(
            (wave.acceleration - 0.4).abs() < 0.02 && (wave.period_s - 1.2).abs() < 2e-3,
            "{wave:?}"
        );
        assert!((found.static_gain - 1.0).abs() < 0.03, "{}", found.static_gain);
    };
    is_right(&sweep::identify(&case(), &sweep).unwrap());
    // Without a description, the log tells the sweep.
    let found = sweep::identify_any(&case()).unwrap();
    is_right(&found);
    assert!(found.is_estimated);
    assert_eq!(
        (found.sweep.start_hz, found.sweep.end_hz, found.sweep.rate_hz_per_s),
        (5.0, 40.0, 1.0)
    );
}

#[test]
fn a_wave_of_another_size_is_found_in_the_log() {
    let wave = SquareWave {
        acceleration: 0.25,
        period_s: 1.57,
    };
    let driven = Sweep {
        end_hz: 80.0,
        sweeping: Sweeping::Wave(wave),
        ..Sweep::default()
    };
    let sensor = Sensor {
        sample_s: 1.0 / 800.0,
        ..Sensor::default()
    };
    let truths = [known(31.0, 0.04, 1.0)];
    let log = resonance_test(&truths, &driven, &sensor, 2);
    for sweeping in [Sweeping::FromLog, driven.sweeping] {
        let found = sweep::identify(&log, &Sweep { sweeping, ..driven }).unwrap();
        check_poles(&truths, &found.modes);
        let found = found.wave.unwrap();
        assert!((found.acceleration / wave.acceleration - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.period_s / wave.period_s - 1.0).abs() < 1e-3, "{found:?}");
    }
}

#[test]
fn another_sweep_is_found_in_the_log() {
    let truths = [known(44.0, 0.04, 0.6), known(71.0, 0.05, 0.4)];
    for (start_hz, end_hz, rate_hz_per_s, acceleration_per_hz, start_s) in [
        (30.0, 85.0, 2.0, 0.060, 0.437),
        (5.0, 1e4 / 75.0, 1.0, 0.075, 0.001),
        (20.0, 110.0, 1.5, 0.100, 0.3),
    ] {
        let driven = Sweep {
            start_hz,
            end_hz,
            rate_hz_per_s,
            acceleration_per_hz,
            sweeping: Sweeping::Off,
        };
        let sensor = Sensor {
            sample_s: 1.0 / 800.0,
            start_s,
            rest_s: 0.1,
            ..Sensor::default()
        };
        let log = resonance_test(&truths, &driven, &sensor, 3);
        let found = sweep::identify_any(&log).unwrap();
        check_poles(&truths, &found.modes);
        let sweep = found.sweep;
        assert!(found.is_estimated, "{sweep:?}");
        let close = |a: f64, b: f64, by: f64| (a - b).abs() < by;
        assert!(
            close(sweep.start_hz, start_hz, 0.11)
                && close(sweep.end_hz, end_hz, 0.3)
                && close(sweep.rate_hz_per_s, rate_hz_per_s, 2e-3),
            "{sweep:?} {driven:?}"
        );
        let told = sweep.acceleration_per_hz * found.static_gain;
        assert!(
            close(told / acceleration_per_hz, 1.0, 0.03),
            "{told} {acceleration_per_hz}"
        );
    }
}

#[test]
fn no_sweep_is_found_where_there_is_none() {
    let mut noise = posicast_identify::synthetic::Noise::new(7);
    let log = AccelerationLog {
        sample_s: 1.0 / 800.0,
        directions: vec![("accel_x".into(), (0..20_000).map(|_| noise.draw()).collect())],
        missing: Vec::new(),
    };
    assert!(matches!(sweep::identify_any(&log), Err(SweepError::Unrelated(_))));
}

/// An antiresonance or a mode's phase takes the slowest pulses off the line in time and frequency, but the motion begins with them.
#[test]
fn the_first_frequency_is_that_at_which_the_motion_begins() {
    let machines = [
        ([known(36.3, 0.057, 0.48), known(57.0, 0.065, 0.52)], (11.0, 140.0, 1.5)),
        ([known(20.0, 0.038, 0.19), known(31.5, 0.016, 0.81)], (8.0, 85.0, 1.0)),
        ([known(22.5, 0.038, 0.63), known(34.5, 0.073, 0.37)], (8.0, 129.0, 3.0)),
    ];
    for (n, (truths, (start_hz, end_hz, rate_hz_per_s))) in machines.into_iter().enumerate() {
        let driven = Sweep {
            start_hz,
            end_hz,
            rate_hz_per_s,
            sweeping: Sweeping::Off,
            ..Sweep::default()
        };
        let sensor = Sensor {
            sample_s: 1.0 / 800.0,
            start_s: 0.69,
            ..Sensor::default()
        };
        let log = resonance_test(&truths, &driven, &sensor, n as u64);
        let found = sweep::identify_any(&log).unwrap();
        assert_eq!(
            (found.sweep.start_hz, found.sweep.rate_hz_per_s),
            (start_hz, rate_hz_per_s)
        );
        check_poles(&truths, &found.modes);
    }
}

#[test]
fn a_log_shorter_than_a_test_with_a_square_wave_is_analysed() {
    let described = |end_hz: f64| Sweep {
        start_hz: 11.0,
        end_hz,
        rate_hz_per_s: 10.0,
        ..present_test()
    };
    let sensor = Sensor {
        sample_s: 1.0 / 800.0,
        ..Sensor::default()
    };
    let truths = [known(31.0, 0.06, 1.0)];
    let log = resonance_test(&truths, &described(60.0), &sensor, 7);
    // The log has the first 5 s of a test of 12 s.
    match sweep::identify(&log, &described(135.0)) {
        Ok(found) => check_poles(&truths, &found.modes),
        Err(error) => panic!("{error}"),
    }
}
