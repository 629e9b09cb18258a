//! Least durations that were computed independently of this crate, to one step of the grid.

use crate::support::{SIGNED, TWO_MODES, four_modes, request, worst_ratio};
use posicast_optimal::{Request, shortest};

/// The least duration in samples; the taps are within the tolerances, and one sample less is excluded.
#[track_caller]
fn check(request: &Request, figure_s: f64) {
    let found = shortest(request).unwrap();
    let expected = figure_s * request.sample_hz;
    let samples = f64::from(found.least_samples);
    assert!(
        (samples - expected).abs() < 1.5,
        "{samples} samples, {expected} in the figures"
    );
    assert_eq!(found.taps.last().unwrap().0, found.least_samples);
    let worst = worst_ratio(request, &found.taps);
    assert!(worst <= 1.0 + 1e-6, "{worst}");
    let proof = found.shorter.unwrap();
    assert_eq!(proof.samples, found.least_samples - 1);
    assert!(proof.ratio > 1.0);
}

#[test]
fn golden_one_mode_by_its_insensitivity() {
    // The full width relative to the mode, and the duration in its periods, on a grid of 1/200.
    for (insensitivity, periods) in [(0.2, 0.890), (0.4, 1.005), (0.73, 1.520), (0.964, 2.000)] {
        check(&request(200.0, &[(1.0, 0.0)], 0.05, insensitivity / 2.0), periods);
    }
}

#[test]
fn golden_four_modes_by_their_uncertainty() {
    for (width, duration_s) in [(0.0, 0.3975), (0.05, 0.5325), (0.1, 0.6575), (0.2, 0.7575)] {
        check(&request(400.0, &four_modes(), 0.05, width), duration_s);
    }
}

#[test]
fn golden_two_modes_with_positive_and_with_signed_commands() {
    check(&request(20_000.0, &TWO_MODES, 0.001, 0.0), 7.80e-3);
    for (tolerance, duration_s) in [(0.001, 4.90e-3), (0.05, 4.85e-3)] {
        let signed = Request {
            command: SIGNED,
            ..request(20_000.0, &TWO_MODES, tolerance, 0.0)
        };
        check(&signed, duration_s);
    }
}
