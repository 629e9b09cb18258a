//! What the EI, negative and bias-point kinds guarantee, at random modes and tolerances, from a millihertz to a
//! megahertz.

use std::f64::consts::PI;

use posicast_shaper::analysis::{residual_vibration, sensitivity_curve};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, bias_point, hump_ei, negative, zv};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use proptest::prelude::*;

const HUMPS: [ShaperKind; 3] = [ShaperKind::Ei, ShaperKind::TwoHumpEi, ShaperKind::ThreeHumpEi];
const NEGATIVE: [ShaperKind; 6] = [
    ShaperKind::UmZv,
    ShaperKind::UmZvd,
    ShaperKind::UmEi,
    ShaperKind::PsZv,
    ShaperKind::PsZvd,
    ShaperKind::PsEi,
];
const BIAS_POINT: [(ShaperKind, u32); 9] = [
    (ShaperKind::ZvEi, 1),
    (ShaperKind::ZvEi2, 1),
    (ShaperKind::ZvdEi, 1),
    (ShaperKind::MultiEi, 1),
    (ShaperKind::ChebyshevEi, 1),
    (ShaperKind::ChebyshevEi, 2),
    (ShaperKind::ChebyshevEi, 3),
    (ShaperKind::ChebyshevEi, 4),
    (ShaperKind::ChebyshevEi, 5),
];

fn mode(damping: impl Strategy<Value = f64>) -> impl Strategy<Value = Mode> {
    (-3.0..6.0, damping).prop_map(|(decade, damping)| Mode {
        frequency_hz: 10f64.powf(decade),
        damping,
    })
}

/// Returns a tolerance, small ones as often as large ones.
fn tolerance(most: f64) -> impl Strategy<Value = f64> {
    (1e-5f64.ln()..most.ln()).prop_map(f64::exp)
}

fn sum(shaper: &ImpulseSequence) -> f64 {
    shaper.impulses().iter().map(|i| i.amplitude).sum()
}

fn all_positive(shaper: &ImpulseSequence) -> bool {
    shaper.impulses().iter().all(|i| i.amplitude > 0.0)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn prop_humps_are_as_high_as_the_tolerance_and_zeros_are_zero(
        kind in prop::sample::select(HUMPS.to_vec()),
        mode in mode(0.0..0.6),
        tolerance in tolerance(0.6),
    ) {
        let found = match hump_ei::design(kind, &mode, tolerance) {
            Ok(found) => found,
            Err(DesignError::NoSolution { largest_damping, largest_tolerance, .. }) => {
                prop_assert!(largest_damping < mode.damping);
                prop_assert!(largest_tolerance.is_none_or(|largest| largest < tolerance));
                return Ok(());
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        };
        let at = |ratio: f64| residual_vibration(found.impulses.impulses(), &mode.scaled(ratio));
        prop_assert!((sum(&found.impulses) - 1.0).abs() < 1e-12);
        prop_assert!(all_positive(&found.impulses));
        prop_assert_eq!(found.impulses.impulses().len(), found.zeros.len() + 1);
        for zero in &found.zeros {
            prop_assert!(at(*zero) < 1e-10, "{}", at(*zero));
        }
        for (hump, zeros) in found.humps.iter().zip(found.zeros.windows(2)) {
            prop_assert!((at(*hump) - tolerance).abs() < 1e-9 * tolerance.max(1e-3));
            prop_assert!(zeros[0] < *hump && *hump < zeros[1]);
            for (ratio, residual) in sensitivity_curve(found.impulses.impulses(), &mode, zeros[0], zeros[1].min(3.0), 100) {
                prop_assert!(residual <= tolerance * (1.0 + 1e-9) + 1e-13, "{} at {}", residual, ratio);
            }
        }
        let middle = if kind == ShaperKind::TwoHumpEi { found.zeros[1] } else { found.humps[found.humps.len() / 2] };
        prop_assert_eq!(middle, 1.0);
    }

    #[test]
    fn prop_negative_shapers_keep_amplitudes_bounds_and_conditions(
        kind in prop::sample::select(NEGATIVE.to_vec()),
        mode in mode(0.0..=0.4),
        tolerance in tolerance(0.4999),
    ) {
        let shaper = negative::design(kind, &mode, tolerance).unwrap();
        let at = |ratio: f64| residual_vibration(shaper.impulses(), &mode.scaled(ratio));
        let unity = matches!(kind, ShaperKind::UmZv | ShaperKind::UmZvd | ShaperKind::UmEi);
        for (index, impulse) in shaper.impulses().iter().enumerate() {
            let size = if unity || index == 0 { 1.0 } else { 2.0 };
            prop_assert_eq!(impulse.amplitude, if index % 2 == 0 { size } else { -size });
        }
        let sums = shaper.partial_sums();
        prop_assert_eq!((sums.min, sums.max), (if unity { 0.0 } else { -1.0 }, 1.0));
        prop_assert_eq!(sum(&shaper), 1.0);
        let positive = match kind {
            ShaperKind::UmZv | ShaperKind::PsZv => 0.5,
            _ => 1.0,
        };
        prop_assert!(shaper.duration_s() < positive * mode.damped_period_s());
        match kind {
            ShaperKind::UmEi | ShaperKind::PsEi => {
                prop_assert!((at(1.0) - tolerance).abs() < 1e-10);
                let off = 1e-3 * tolerance.sqrt();
                prop_assert!(at(1.0 - off) <= tolerance * (1.0 + 1e-9) && at(1.0 + off) <= tolerance * (1.0 + 1e-9));
            }
            ShaperKind::UmZvd | ShaperKind::PsZvd => {
                // It is of second order around the mode: a hundredth of the distance gives a ten-thousandth of the
                // residual.
                prop_assert!(at(1.0) < 1e-12);
                prop_assert!(at(1.0 + 1e-5) < 1.1e-4 * at(1.0 + 1e-3) + 1e-12);
            }
            _ => prop_assert!(at(1.0) < 1e-12),
        }
    }

    #[test]
    fn prop_bias_point_shapers_leave_the_tolerance_at_the_mode(
        family in prop::sample::select(BIAS_POINT.to_vec()),
        mode in mode(0.0..0.6),
        tolerance in tolerance(0.99),
    ) {
        let (kind, order) = family;
        match bias_point::design(kind, order, &mode, tolerance) {
            Ok(shaper) => {
                prop_assert!((residual_vibration(shaper.impulses(), &mode) - tolerance).abs() < 1e-12);
                prop_assert!((sum(&shaper) - 1.0).abs() < 1e-13);
                prop_assert!(all_positive(&shaper));
                for (index, impulse) in shaper.impulses().iter().enumerate() {
                    let expected = index as f64 * mode.damped_period_s() / 2.0;
                    prop_assert!((impulse.time_s - expected).abs() <= 1e-15 * expected);
                }
            }
            Err(DesignError::NoSolution { largest_damping, largest_tolerance, .. }) => {
                prop_assert!(largest_damping <= mode.damping * (1.0 + 1e-12));
                prop_assert!(largest_tolerance.unwrap() <= tolerance * (1.0 + 1e-12));
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    #[test]
    fn prop_bias_point_bases_ripple_within_the_tolerance_up_to_lambda(
        family in prop::sample::select(BIAS_POINT.to_vec()),
        tolerance in tolerance(0.99),
    ) {
        let (kind, order) = family;
        let base = bias_point::undamped(kind, order, tolerance).unwrap();
        prop_assert!((base.amplitudes.iter().sum::<f64>() - 1.0).abs() < 1e-13);
        prop_assert_eq!(base.zeros_theta.len() * 2 + 1, base.amplitudes.len());
        let at = |phase: f64| {
            let [re, im] = [f64::cos, f64::sin].map(|wave| {
                base.amplitudes.iter().enumerate().map(|(k, a)| a * wave(k as f64 * phase)).sum::<f64>()
            });
            re.hypot(im)
        };
        for theta in &base.zeros_theta {
            prop_assert!((0.0..PI).contains(theta) && at(*theta) < 1e-13);
        }
        prop_assert!((at(PI * (1.0 - base.lambda)) - tolerance).abs() < 1e-12);
        for step in 0..200 {
            let ratio = 1.0 - base.lambda * f64::from(step) / 200.0;
            prop_assert!(at(PI * ratio) <= tolerance + 1e-13);
        }
    }

    #[test]
    fn prop_mzv_is_shorter_than_zvd_and_leaves_nothing(mode in mode(0.0..0.95)) {
        let shaper = zv::design_mzv(&mode).unwrap();
        prop_assert!(residual_vibration(shaper.impulses(), &mode) < 1e-13);
        prop_assert!((sum(&shaper) - 1.0).abs() < 1e-15 * 4.0 && all_positive(&shaper));
        prop_assert!((shaper.duration_s() / mode.damped_period_s() - 0.75).abs() < 1e-15);
    }
}

#[test]
fn prop_designs_scale_with_the_frequency() {
    // The two frequencies differ by a power of two: every digit of every time must scale.
    for damping in [0.0, 0.1, 0.25] {
        for kind in HUMPS.into_iter().chain(NEGATIVE) {
            let [slow, fast] = [0.001, 0.001 * 2f64.powi(30)].map(|frequency_hz| {
                let mode = Mode { frequency_hz, damping };
                match kind {
                    _ if HUMPS.contains(&kind) => hump_ei::design(kind, &mode, 0.05).unwrap().impulses,
                    _ => negative::design(kind, &mode, 0.05).unwrap(),
                }
            });
            for (a, b) in slow.impulses().iter().zip(fast.impulses()) {
                assert_eq!(
                    (a.time_s, a.amplitude),
                    (b.time_s * 2f64.powi(30), b.amplitude),
                    "{kind}"
                );
            }
        }
    }
}
