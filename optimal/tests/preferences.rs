//! Which of the shortest is taken, and what a budget of taps costs.

use crate::support::{SIGNED, TWO_MODES, four_modes, request, residual, worst_ratio};
use posicast_optimal::{Band, OptimalError, Prefer, Request, Shortest, front, shortest};

fn one_mode() -> Request {
    request(200.0, &[(1.0, 0.0)], 0.05, 0.2)
}

fn delay(taps: &[(u32, f64)]) -> f64 {
    taps.iter()
        .map(|(sample, amplitude)| f64::from(*sample) * amplitude)
        .sum()
}

fn mean_square(request: &Request, taps: &[(u32, f64)]) -> f64 {
    let [low, high] = request.bands[0].frequency_hz;
    let squares = (0..=200).map(|step| {
        let hz = low + (high - low) * f64::from(step) / 200.0;
        residual(taps, hz, 0.0, request.sample_hz).powi(2)
    });
    squares.sum::<f64>() / 201.0
}

#[test]
fn each_preference_optimises_its_own_measure() {
    // Longer than the shortest: then there is a choice.
    let with = |prefer| {
        let request = Request {
            prefer,
            delay_samples: None,
            ..request(50.0, &[(1.0, 0.0)], 0.05, 0.27)
        };
        shortest(&request).unwrap()
    };
    let all = [Prefer::FewestTaps, Prefer::LeastResidual, Prefer::LeastDelay].map(with);
    let request = request(50.0, &[(1.0, 0.0)], 0.05, 0.27);
    for Shortest {
        taps, least_samples, ..
    } in &all
    {
        assert_eq!(*least_samples, all[0].least_samples);
        assert!(worst_ratio(&request, taps) <= 1.0 + 1e-6);
        assert!((taps.iter().map(|tap| tap.1).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(taps.iter().all(|tap| tap.1 >= 0.0));
        assert!(all[0].taps.len() <= taps.len());
        assert!(mean_square(&request, &all[1].taps) <= mean_square(&request, taps) * (1.0 + 1e-3));
        assert!(delay(&all[2].taps) <= delay(taps) + 1e-3);
    }
    assert!(
        delay(&all[2].taps) < delay(&all[1].taps) - 1e-3,
        "the preferences differ"
    );
}

#[test]
fn a_tap_budget_is_met_by_a_longer_duration() {
    let four = request(400.0, &four_modes(), 0.05, 0.0);
    let free = shortest(&four).unwrap();
    let budget = Request {
        most_taps: free.taps.len() - 1,
        ..four
    };
    let found = shortest(&budget).unwrap();
    assert!(found.taps.len() <= budget.most_taps);
    assert_eq!(found.least_samples, free.least_samples);
    let samples = found.taps.last().unwrap().0;
    assert!(samples > free.least_samples);
    assert!(worst_ratio(&budget, &found.taps) <= 1.0 + 1e-6);
}

#[test]
fn a_budget_that_cannot_be_met_reports_the_fewest_taps() {
    // Two taps have one zero: they hold no band of ±20 %.
    let budget = Request {
        most_taps: 2,
        ..one_mode()
    };
    match shortest(&budget) {
        Err(OptimalError::TapBudget { budget: 2, fewest, .. }) => assert!(fewest > 2),
        other => panic!("{other:?}"),
    }
}

#[test]
fn signed_commands_stay_within_their_bounds() {
    let request = Request {
        command: SIGNED,
        ..request(20_000.0, &TWO_MODES, 0.001, 0.0)
    };
    let found = shortest(&request).unwrap();
    let mut sum = 0.0;
    for (_, amplitude) in &found.taps {
        sum += amplitude;
        assert!((-1.0 - 1e-12..=1.0 + 1e-12).contains(&sum), "{sum}");
    }
    assert!((sum - 1.0).abs() < 1e-12);
}

#[test]
fn a_band_of_damping_is_held_inside_too() {
    let request = Request {
        bands: vec![Band {
            frequency_hz: [9.0, 11.0],
            damping: [0.02, 0.15],
            tolerance: 0.03,
        }],
        ..request(400.0, &[(10.0, 0.05)], 0.03, 0.1)
    };
    let found = shortest(&request).unwrap();
    assert!(worst_ratio(&request, &found.taps) <= 1.0 + 1e-6);
    // A mode whose damping is known needs less.
    let known = shortest(&crate::support::request(400.0, &[(10.0, 0.05)], 0.03, 0.1)).unwrap();
    assert!(known.least_samples < found.least_samples);
}

#[test]
fn a_finer_grid_is_never_longer() {
    let duration_s = |sample_hz: f64| {
        let found = shortest(&request(sample_hz, &four_modes(), 0.05, 0.0)).unwrap();
        f64::from(found.least_samples) / sample_hz
    };
    let (coarse, fine) = (duration_s(200.0), duration_s(400.0));
    assert!(fine <= coarse && fine > coarse - 1.0 / 200.0 - 1e-12, "{fine} {coarse}");
}

#[test]
fn long_more_duration_buys_fewer_taps_or_less_residual() {
    let request = request(400.0, &four_modes(), 0.05, 0.0);
    let least = shortest(&request).unwrap().least_samples;
    let points = front(&request, &[least, least + 16, least + 40]).unwrap();
    assert!(points.windows(2).all(|pair| pair[1].least_ratio <= pair[0].least_ratio));
    // At the least duration most of the tolerance is needed: a sample less has no solution. A quarter more needs much less of it.
    assert!(
        (0.8..=1.0 + 1e-6).contains(&points[0].least_ratio),
        "{}",
        points[0].least_ratio
    );
    assert!(points[2].least_ratio < 0.5 * points[0].least_ratio);
    // A longer duration never needs more taps: the shorter shaper is one of it.
    assert!(points.windows(2).all(|pair| pair[1].taps.len() <= pair[0].taps.len()));
    assert_eq!(points[0].taps.last().unwrap().0, least);
    for point in &points {
        assert!(point.taps.last().unwrap().0 <= point.samples);
        assert!(worst_ratio(&request, &point.taps) <= 1.0 + 1e-6);
    }
    assert!(front(&request, &[least - 1]).is_err());
}
