//! Limits of the kinds with humps: the limits that an error names separate the designs from the errors.

use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, hump_ei};
use posicast_shaper::mode::Mode;

fn mode(damping: f64) -> Mode {
    Mode {
        frequency_hz: 100.0,
        damping,
    }
}

/// Returns the largest damping for a tolerance and the largest tolerance for a damping, as an error names them.
fn limits(kind: ShaperKind, damping: f64, tolerance: f64) -> (f64, f64) {
    match hump_ei::design(kind, &mode(damping), tolerance) {
        Err(DesignError::NoSolution {
            largest_damping,
            largest_tolerance,
            ..
        }) => (largest_damping, largest_tolerance.unwrap_or(0.0)),
        other => panic!("{kind} {damping} {tolerance}: {other:?}"),
    }
}

#[test]
fn where_the_branch_folds_one_damping_divides_designs_from_errors() {
    // From about 0.283 on, the solution that starts at the undamped shaper folds at 0.133; another one continues
    // above it.
    for tolerance in [0.28, 0.2825, 0.284, 0.2856, 0.2872, 0.288] {
        let (end, _) = limits(ShaperKind::TwoHumpEi, 0.8, tolerance);
        let expected = if tolerance < 0.2828 { 0.158 } else { 0.13 };
        assert!((end - expected).abs() < 5e-3, "{tolerance}: {end}");
        for step in 0..40 {
            let damping = 0.1 + 0.002 * f64::from(step);
            let exists = hump_ei::design(ShaperKind::TwoHumpEi, &mode(damping), tolerance).is_ok();
            assert_eq!(exists, damping < end, "{tolerance}: {damping} ends at {end}");
        }
        for asked in [end + 1e-4, end + 0.02, 0.6] {
            let (other, _) = limits(ShaperKind::TwoHumpEi, asked, tolerance);
            assert!((other - end).abs() < 1e-5, "{tolerance}: {other} from {asked}, {end}");
        }
    }
}

#[test]
fn the_largest_tolerance_divides_designs_from_errors() {
    for (kind, damping, expected) in [
        (ShaperKind::Ei, 0.781, 0.0200),
        (ShaperKind::TwoHumpEi, 0.863, 2.59e-5),
        (ShaperKind::TwoHumpEi, 0.14, 0.2828),
        (ShaperKind::ThreeHumpEi, 0.5, 0.00647),
    ] {
        let (_, largest) = limits(kind, damping, 0.5);
        assert!((largest / expected - 1.0).abs() < 5e-3, "{kind} {damping}: {largest}");
        assert_eq!(limits(kind, damping, 1.1 * largest).1, largest);
        for ratio in [0.1, 0.5, 0.8, 0.9, 0.97, 0.99, 1.0] {
            assert!(
                hump_ei::design(kind, &mode(damping), ratio * largest).is_ok(),
                "{kind} {damping} {ratio}"
            );
        }
        for ratio in [1.0011, 1.01, 1.03, 1.1, 1.3, 2.0, 3.0] {
            assert!(
                hump_ei::design(kind, &mode(damping), ratio * largest).is_err(),
                "{kind} {damping} {ratio}"
            );
        }
    }
}
