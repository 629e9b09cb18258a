//! Slow modes with a small share of the response, which ring more than the fast ones.

use posicast_identify::recommend::{Judgement, recommend};
use posicast_identify::sweep::{self, Sweep};
use posicast_identify::synthetic::{Sensor, known, resonance_test};

/// A sensor of 400 samples per second with the noise of an ADXL345.
fn sensor(noise: f64) -> Sensor {
    Sensor {
        sample_s: 1.0 / 400.0,
        noise,
        ..Sensor::default()
    }
}

#[test]
fn unit_a_frame_mode_of_four_percent_is_reported_because_it_rings_most() {
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
                    found.visible_from_hz.unwrap() > frequency_hz,
                    "{frequency_hz} Hz, {share}, noise {noise}: {:?}",
                    found.visible_from_hz
                ),
                other => panic!("{frequency_hz} Hz, {share}, noise {noise}: {other:#?}"),
            }
        }
    }
    assert!(2 * seen > slow.len() * noises.len(), "{seen}");
}

#[test]
fn unit_slow_modes_are_found_where_the_log_shows_them() {
    slow_modes_are_found_or_said_not_to_be_visible(&[(6.5, 0.04), (9.0, 0.02), (20.0, 0.1)], &[0.04]);
}

#[test]
fn long_slow_modes_are_found_where_the_log_shows_them() {
    let mut slow = Vec::new();
    for frequency_hz in [5.5, 6.5, 8.0, 10.0, 12.0, 15.0, 20.0] {
        slow.extend([0.02, 0.04, 0.06, 0.1].map(|share| (frequency_hz, share)));
    }
    slow_modes_are_found_or_said_not_to_be_visible(&slow, &[0.02, 0.2, 1.0]);
}
