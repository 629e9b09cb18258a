//! Several axes with one delay, against a search over all shapers of three taps.

use crate::support::{request, worst_ratio};
use posicast_optimal::{OptimalError, Partner, Prefer, Request, Shorter, shortest, together};
use std::f64::consts::TAU;

const TOLERANCE: f64 = 0.05;

/// An axis with one undamped mode of `period` samples.
fn partner(period: f64, lag_samples: f64) -> Partner {
    let request = request(period, &[(1.0, 0.0)], TOLERANCE, 0.0);
    Partner {
        alone: shortest(&request).unwrap(),
        request,
        lag_samples,
    }
}

fn delay(taps: &[(u32, f64)]) -> f64 {
    taps.iter()
        .map(|(sample, amplitude)| f64::from(*sample) * amplitude)
        .sum()
}

/// The least delay of at most `samples` samples for one undamped mode. The two parts of the residual and the sum are three linear
/// equations, so three taps are enough; all of them are tried, for residuals all around the rim of what is tolerated.
fn least_delay(period: f64, samples: u32) -> f64 {
    let at = |sample: u32| {
        let (sin, cos) = (TAU * f64::from(sample) / period).sin_cos();
        (cos, sin)
    };
    let mut least = f64::INFINITY;
    for i in 0..=samples {
        for j in i + 1..=samples {
            for k in j + 1..=samples {
                let [(xi, yi), (xj, yj), (xk, yk)] = [i, j, k].map(at);
                let area = (xj - xi) * (yk - yi) - (xk - xi) * (yj - yi);
                for step in 0..1440 {
                    let (sin, cos) = (TAU * f64::from(step) / 1440.0).sin_cos();
                    let (x, y) = (TOLERANCE * cos, TOLERANCE * sin);
                    let second = ((x - xi) * (yk - yi) - (xk - xi) * (y - yi)) / area;
                    let third = ((xj - xi) * (y - yi) - (x - xi) * (yj - yi)) / area;
                    let first = 1.0 - second - third;
                    if first >= 0.0 && second >= 0.0 && third >= 0.0 {
                        let found = f64::from(i) * first + f64::from(j) * second + f64::from(k) * third;
                        least = least.min(found);
                    }
                }
            }
        }
    }
    least
}

#[test]
fn golden_the_common_delay_is_the_least_of_the_axis_that_decides_it() {
    let partners = [partner(12.0, 0.3), partner(20.0, 0.0)];
    let found = together(&partners).unwrap();
    assert_eq!(found.samples, partners[1].alone.least_samples);
    assert_eq!(found.latest_axis, 1);
    let expected = least_delay(20.0, found.samples);
    // The search has the rim in quarters of a degree.
    assert!(
        (found.delay_samples - expected).abs() < 2e-3,
        "{} {expected}",
        found.delay_samples
    );
    for (partner, taps) in partners.iter().zip(&found.taps) {
        assert!((delay(taps) + partner.lag_samples - found.delay_samples).abs() < 1e-9);
        assert!((taps.iter().map(|tap| tap.1).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(worst_ratio(&partner.request, taps) <= 1.0 + 2e-6);
        assert!(taps.last().unwrap().0 <= found.samples);
    }
    let bound = found.earlier.unwrap();
    assert!((bound.delay_samples - found.delay_samples).abs() < 1e-3, "{bound:?}");
    assert!(
        matches!(found.shorter, Some(Shorter::Alone { axis: 1, .. })),
        "{:?}",
        found.shorter
    );
}

#[test]
fn golden_a_lag_that_no_shaper_makes_up_for_costs_duration() {
    // Without damping a shaper backwards is one as well: the latest delay of N samples is N less the earliest.
    let (early, late, lag) = (20.0, 12.0, 15.0);
    let partners = [partner(early, 0.0), partner(late, lag)];
    let alone = partners[0].alone.least_samples;
    let expected = (alone..60)
        .find(|samples| f64::from(*samples) - least_delay(early, *samples) >= least_delay(late, *samples) + lag)
        .unwrap();
    assert!(expected > alone, "the lag must matter");
    let found = together(&partners).unwrap();
    assert_eq!(found.samples, expected);
    match found.shorter {
        Some(Shorter::Apart {
            late_axis: 1,
            early_axis: 0,
            earliest,
            latest,
        }) => {
            assert!(earliest.samples == expected - 1 && latest.samples == expected - 1 && latest.is_upper);
            assert!(earliest.delay_samples + lag > latest.delay_samples);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn axes_that_never_meet_are_refused() {
    let mut partners = [partner(20.0, 0.0), partner(12.0, 500.0)];
    for partner in &mut partners {
        partner.request.longest_samples = 40;
    }
    let error = together(&partners).unwrap_err();
    assert_eq!(error.axis, 1);
    assert!(
        matches!(
            error.cause,
            OptimalError::Apart {
                longest_samples: 40,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn the_other_axes_keep_their_preference_and_their_budget() {
    let mut partners = [partner(12.0, 0.0), partner(20.0, 0.0)];
    let taps = |partners: &[Partner]| together(partners).unwrap().taps[0].len();
    let few = taps(&partners);
    partners[0].request = Request {
        prefer: Prefer::LeastResidual,
        ..partners[0].request.clone()
    };
    assert!(taps(&partners) >= few);
    partners[0].request.most_taps = 1;
    let error = together(&partners).unwrap_err();
    assert_eq!(error.axis, 0);
    assert!(
        matches!(error.cause, OptimalError::TapBudget { budget: 1, .. }),
        "{error}"
    );
}

#[test]
fn the_delay_is_above_its_bound_by_the_room_for_rounding_alone() {
    // Of a tolerance of 5 %, 8e-5 are left for rounding.
    let room = 8e-5;
    let at = |tolerance: f64| {
        let axes = [(62.0, 0.02), (36.0, 0.05)].map(|mode| {
            let request = request(5000.0, &[mode], tolerance, 0.1);
            Partner {
                alone: shortest(&request).unwrap(),
                request,
                lag_samples: 0.0,
            }
        });
        let found = together(&axes).unwrap();
        (
            found.samples,
            found.delay_samples,
            found.earlier.unwrap().delay_samples,
            worst_ratio(&axes[found.latest_axis].request, &found.taps[found.latest_axis]),
        )
    };
    let (samples, delay, bound, ratio) = at(TOLERANCE);
    assert!(delay - bound > 0.05, "{delay} {bound}");
    assert!(ratio < 1.0 - 0.9 * room / TOLERANCE, "{ratio}");
    let (within_room, _, bound, _) = at(TOLERANCE - room);
    assert_eq!(samples, within_room);
    assert!((delay - bound).abs() < 1e-2, "{delay} {bound}");
}
