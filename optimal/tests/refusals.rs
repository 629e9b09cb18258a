//! What has no shaper, and what is said.

use crate::support::{SIGNED, request};
use posicast_optimal::{Band, OptimalError, Request, shortest};

fn refused(request: &Request) -> OptimalError {
    shortest(request).unwrap_err()
}

#[test]
fn bands_beyond_the_samples_are_refused() {
    let base = request(100.0, &[(10.0, 0.0)], 0.05, 0.1);
    for (frequency_hz, damping) in [
        ([0.0, 10.0], [0.0; 2]),
        ([-1.0, 10.0], [0.0; 2]),
        ([10.0, 50.0], [0.0; 2]),
        ([f64::NAN, 10.0], [0.0; 2]),
        ([10.0, f64::INFINITY], [0.0; 2]),
        ([12.0, 10.0], [0.0; 2]),
        ([10.0, 10.0], [0.0, 1.0]),
        ([10.0, 10.0], [f64::NAN, 0.5]),
    ] {
        let bands = vec![Band {
            frequency_hz,
            damping,
            tolerance: 0.05,
        }];
        let error = refused(&Request { bands, ..base.clone() });
        assert!(matches!(error, OptimalError::Band { band: 0, .. }), "{error}");
    }
}

#[test]
fn a_tolerance_must_lie_between_0_and_1() {
    for tolerance in [0.0, 1.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = refused(&request(100.0, &[(10.0, 0.0)], tolerance, 0.1));
        assert!(matches!(error, OptimalError::Tolerance { band: 0, .. }), "{error}");
    }
}

#[test]
fn exceeding_the_longest_duration_reports_the_smallest_ratio() {
    for command in [posicast_optimal::Command::Positive, SIGNED] {
        let short = Request {
            longest_samples: 20,
            command,
            ..request(100.0, &[(1.0, 0.0)], 0.05, 0.1)
        };
        match refused(&short) {
            OptimalError::TooLong {
                longest_samples: 20,
                ratio,
                ..
            } => assert!(ratio > 1.0, "{ratio}"),
            other => panic!("{other}"),
        }
    }
}
