//! Amplitudes within bounds. For one undamped mode the least residual of a duration follows from the vector diagram.

use crate::support::{four_modes, request, worst_ratio};
use posicast_optimal::{Command, OptimalError, Prefer, Request, round_taps, shortest};
use std::f64::consts::TAU;

/// Samples per period.
const PERIOD: u32 = 200;

fn bounded(low: f64, high: f64, tolerance: f64) -> Request {
    Request {
        command: Command::Amplitudes { low, high },
        ..request(f64::from(PERIOD), &[(1.0, 0.0)], tolerance, 0.0)
    }
}

/// The least residual of `samples` samples, up to a period. Seen from the middle of the shaper, the sines of two
/// samples at equal distances cancel, and what remains is `Σ a_i cos`: it is least if each amplitude is `low`, and what
/// is then missing from the sum 1 stands at the ends, where the cosine is least. If that is negative, 0 is possible.
fn least_residual(samples: u32, low: f64, high: f64) -> f64 {
    let middle = f64::from(samples) / 2.0;
    let mut cosines: Vec<f64> = (0..=samples)
        .map(|sample| (TAU * (f64::from(sample) - middle) / f64::from(PERIOD)).cos())
        .collect();
    cosines.sort_by(f64::total_cmp);
    let mut missing = 1.0 - low * cosines.len() as f64;
    let sum = cosines.iter().map(|cosine| {
        let amplitude = low + missing.clamp(0.0, high - low);
        missing -= amplitude - low;
        amplitude * cosine
    });
    let sum = sum.sum::<f64>();
    if missing > 1e-12 { f64::INFINITY } else { sum.max(0.0) }
}

#[test]
fn golden_bounded_amplitudes_are_as_short_as_the_vector_diagram_says() {
    for (low, high, tolerance) in [
        (0.0, 0.3, 0.05),
        (0.0, 0.05, 0.05),
        (0.0, 0.02, 0.01),
        (-0.2, 0.6, 0.05),
    ] {
        let expected = (1..=PERIOD)
            .find(|samples| least_residual(*samples, low, high) <= tolerance)
            .unwrap();
        let request = bounded(low, high, tolerance);
        let found = shortest(&request).unwrap();
        assert_eq!(found.least_samples, expected, "{low} {high} {tolerance}");
        let proof = found.shorter.unwrap();
        let exact = least_residual(expected - 1, low, high) / tolerance;
        assert!((proof.ratio / exact - 1.0).abs() < 1e-4, "{} {exact}", proof.ratio);
        assert!(worst_ratio(&request, &found.taps) <= 1.0 + 1e-6);
        let within = |amplitude: f64| (low - 1e-12..=high + 1e-12).contains(&amplitude);
        assert!(found.taps.iter().all(|tap| within(tap.1)), "{:?}", found.taps);
        let sum: f64 = found.taps.iter().map(|tap| tap.1).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
}

#[test]
fn a_wide_bound_has_no_effect_and_a_narrow_one_costs_duration() {
    let samples = |command| {
        let request = Request {
            command,
            ..request(400.0, &four_modes(), 0.05, 0.05)
        };
        shortest(&request).unwrap().least_samples
    };
    let positive = samples(Command::Positive);
    assert_eq!(samples(Command::Amplitudes { low: 0.0, high: 1.0 }), positive);
    assert!(samples(Command::Amplitudes { low: 0.0, high: 0.06 }) > positive);
    assert!(samples(Command::Amplitudes { low: -0.1, high: 1.0 }) < positive);
}

#[test]
fn integers_stay_within_the_bounds_of_amplitudes() {
    for (low, high, prefer) in [
        (0.0, 0.3, Prefer::FewestTaps),
        (0.0, 0.07, Prefer::LeastResidual),
        (-0.2, 0.6, Prefer::LeastDelay),
    ] {
        let request = Request {
            prefer,
            ..bounded(low, high, 0.05)
        };
        let found = shortest(&request).unwrap();
        let unity = f64::from(1u32 << 14);
        let units = round_taps(&request, &found.taps, 14);
        assert_eq!(units.iter().map(|(_, units)| units).sum::<i64>(), 1 << 14);
        let taps: Vec<(u32, f64)> = units.iter().map(|tap| (tap.0, tap.1 as f64 / unity)).collect();
        assert!(taps.iter().all(|tap| (low..=high).contains(&tap.1)), "{taps:?}");
        assert!(worst_ratio(&request, &taps) <= 1.0 + 1e-6);
    }
}

#[test]
fn units_that_move_for_the_residual_stay_within_the_bounds() {
    // So few fraction bits that rounding breaks the tolerance, and units move.
    let mut moved = 0;
    for (high, prefer) in [
        (0.27, Prefer::FewestTaps),
        (0.3, Prefer::LeastResidual),
        (0.12, Prefer::FewestTaps),
        (0.07, Prefer::LeastDelay),
    ] {
        let request = Request {
            prefer,
            ..bounded(0.0, high, 0.01)
        };
        let taps = shortest(&request).unwrap().taps;
        for fraction in 7..=11 {
            let unity = f64::from(1u32 << fraction);
            let most = (high * unity).floor();
            if most * taps.len() as f64 <= unity {
                continue;
            }
            let units = round_taps(&request, &taps, fraction);
            let nearest = |(sample, units): &(u32, i64)| {
                let exact = taps.iter().find(|tap| tap.0 == *sample).map_or(0.0, |tap| tap.1);
                (exact * unity - *units as f64).abs() < 1.0
            };
            moved += u32::from(!units.iter().all(nearest));
            assert!(
                units.iter().all(|tap| tap.1 as f64 <= most),
                "{high} {fraction}: {units:?}"
            );
        }
    }
    assert!(moved > 0, "no unit moved");
}

#[test]
fn where_the_sum_decides_the_duration_the_proof_has_no_points() {
    // A tolerance that a sixth of a period keeps, but forty amplitudes are needed for the sum.
    let found = shortest(&bounded(0.0, 0.0253, 0.95)).unwrap();
    assert_eq!(found.least_samples, 39);
    let proof = found.shorter.unwrap();
    assert!(proof.points.is_empty() && proof.samples == 38);
}

#[test]
fn amplitudes_that_never_sum_to_one_are_refused() {
    let short = Request {
        longest_samples: 50,
        ..bounded(0.0, 0.019, 0.05)
    };
    let error = shortest(&short).unwrap_err();
    assert!(matches!(error, OptimalError::Amplitudes { samples: 51, .. }), "{error}");
}
