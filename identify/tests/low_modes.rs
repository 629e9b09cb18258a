//! Slow modes with a small share of the response, which ring more than the fast ones.

use posicast_identify::recommend::{Judgement, recommend};
use posicast_identify::sweep::{self, Sweep};
use posicast_identify::synthetic::{Sensor, known, present_test, resonance_test};

/// A sensor of 400 samples per second with the noise of an ADXL345.
fn sensor(noise: f64) -> Sensor {
    Sensor {
        sample_s: 1.0 / 400.0,
        noise,
        ..Sensor::default()
    }
}

#[test]
fn a_frame_mode_of_four_percent_is_reported_because_it_rings_most() {
    let truths = [known(12.0, 0.03, 0.04), known(90.0, 0.04, 0.96)];
    let log = resonance_test(&truths, &Sweep::default(), &sensor(0.04), 1);
    let found = sweep::identify(&log, &Sweep::default()).unwrap();
    assert_eq!(found.modes.len(), 2, "{:#?}", found.modes);
    for (found, truth) in found.modes.iter().zip(&truths) {
        assert!(
            (found.mode.frequency_hz / truth.mode.frequency_hz - 1.0).abs() < 0.005,
            "{found:?}"
        );
        assert!(
            (found.mode.damping / truth.mode.damping - 1.0).abs() < 0.15,
            "{found:?}"
        );
        assert!((found.participation - truth.share).abs() < 0.01, "{found:?}");
    }
    // p·a/ω² after a jump by 5 m/s²: 0.04·5/(2π·12)² = 35.2 µm and 0.96·5/(2π·90)² = 15.0 µm.
    assert!(
        (found.modes[0].ringing(5.0) - 35.2e-6).abs() < 4e-6,
        "{:e}",
        found.modes[0].ringing(5.0)
    );
    assert!(
        (found.modes[1].ringing(5.0) - 15.0e-6).abs() < 0.5e-6,
        "{:e}",
        found.modes[1].ringing(5.0)
    );
    // The shapers are judged by both.
    let best = &recommend(&found.modes, &Judgement::default())[0];
    assert!(Judgement::default().is_enough(best) && best.impulses.duration_s() > 0.5 / 12.0);
}

/// Logs of a slow mode beside one of 90 Hz: it is found, or the log says that it does not show it.
fn slow_modes_are_found_or_said_not_to_be_visible(slow: &[(f64, f64)], noises: &[f64]) {
    let mut seen = 0;
    for &(frequency_hz, share) in slow {
        for (seed, &noise) in noises.iter().enumerate() {
            let truths = [known(frequency_hz, 0.03, share), known(90.0, 0.04, 1.0 - share)];
            let log = resonance_test(&truths, &Sweep::default(), &sensor(noise), seed as u64);
            let found = sweep::identify(&log, &Sweep::default()).unwrap();
            match &found.modes[..] {
                [low, _] => {
                    seen += 1;
                    assert!(
                        (low.mode.frequency_hz / frequency_hz - 1.0).abs() < 0.02,
                        "{low:?} of {frequency_hz} Hz"
                    );
                    assert!(
                        (low.participation / share - 1.0).abs() < 0.35,
                        "{low:?} of {share}, noise {noise}, seed {seed}: {found:#?}"
                    );
                }
                [_] => assert!(
                    found.visible.unwrap().from_hz > frequency_hz,
                    "{frequency_hz} Hz, {share}, noise {noise}: {:?}",
                    found.visible
                ),
                other => panic!("{frequency_hz} Hz, {share}, noise {noise}: {other:#?}"),
            }
        }
    }
    assert!(2 * seen > slow.len() * noises.len(), "{seen}");
}

#[test]
fn slow_modes_are_found_where_the_log_shows_them() {
    slow_modes_are_found_or_said_not_to_be_visible(&[(6.5, 0.04), (9.0, 0.02), (20.0, 0.1)], &[0.04, 0.4]);
}

/// A mode turns the phase by half a turn, which looks like a clock that is wrong by 54 ppm over this sweep.
#[test]
fn the_phase_of_a_mode_is_not_taken_for_a_clock_error() {
    let truths = [known(20.0, 0.03, 0.1), known(90.0, 0.04, 0.9)];
    for seed in 0..3 {
        let log = resonance_test(&truths, &Sweep::default(), &sensor(0.4), seed);
        let found = sweep::identify(&log, &Sweep::default()).unwrap();
        assert!(found.clock_error.abs() < 1e-5, "{}", found.clock_error);
        assert!(
            (found.start_s - Sensor::default().start_s).abs() < 1e-3,
            "{}",
            found.start_s
        );
        assert_eq!(found.modes.len(), 2, "{:#?}", found.modes);
        for (found, truth) in found.modes.iter().zip(&truths) {
            assert!((found.participation - truth.share).abs() < 0.015, "{found:?}");
        }
    }
}

/// At 100 Hz, a quarter of the rate, the sensor shows the third harmonic as the sweep itself.
#[test]
fn aliases_of_a_slow_sensor_are_not_modes() {
    let truths = [known(70.0, 0.05, 0.9)];
    let log = resonance_test(&truths, &Sweep::default(), &sensor(0.1), 1);
    let found = sweep::identify(&log, &Sweep::default()).unwrap();
    assert_eq!(found.modes.len(), 1, "{:#?}", found.modes);
    assert!(found.reduced_square < 1.2, "{}", found.reduced_square);
    assert!(
        found.modes[0].frequency_interval_hz().holds(70.0),
        "{:?}",
        found.modes[0]
    );
}

/// 5.83 Hz is the seventh harmonic of the square wave beside the sweep. It rings with `0.05/5.833²`, the other mode with `0.9/70²`: 8.0 times
/// as much.
#[test]
fn a_mode_at_a_harmonic_of_the_square_wave_is_found_or_reported_invisible() {
    let truths = [known(5.833, 0.05, 0.05), known(70.0, 0.05, 0.9)];
    for (sample_hz, is_found) in [(400.0, false), (800.0, true)] {
        let sensor = Sensor {
            sample_s: 1.0 / sample_hz,
            ..sensor(0.1)
        };
        let log = resonance_test(&truths, &present_test(), &sensor, 1);
        let found = sweep::identify(&log, &Sweep::default()).unwrap();
        let visible = found.visible.unwrap();
        match found.modes[..] {
            [low, _] => assert!((low.mode.frequency_hz - 5.833).abs() < 0.1, "{low:?}"),
            [_] => assert!(
                !is_found && visible.from_hz > 5.833 && visible.least_ringing > 8.0,
                "{visible:?}"
            ),
            _ => panic!("{:#?}", found.modes),
        }
    }
}

#[test]
fn long_slow_modes_are_found_where_the_log_shows_them() {
    let mut slow = Vec::new();
    for frequency_hz in [5.5, 6.5, 8.0, 10.0, 12.0, 15.0, 20.0] {
        slow.extend([0.02, 0.04, 0.06, 0.1].map(|share| (frequency_hz, share)));
    }
    slow_modes_are_found_or_said_not_to_be_visible(&slow, &[0.02, 0.2, 1.0]);
}
