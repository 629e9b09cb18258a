//! What holds for every shaper of several modes at once, whatever the modes; and that absurd numbers give errors.

use crate::support;

use posicast_machine::plan::design_machine;
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::design::antisymmetric::{self, AntisymmetricMethod, Participant};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::periodic::{self, Base};
use posicast_shaper::design::simultaneous::{self, Amplitudes, Constraint};
use posicast_shaper::design::vibrationless::{EPSILON_MAX, ORDER_MAX, gain, optimum, robustness_index};
use posicast_shaper::design::{DesignError, JointError, bias_point, ratios};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use proptest::prelude::*;
use support::{machine, shaper};

fn mode(frequency_hz: f64, damping: f64) -> Mode {
    Mode { frequency_hz, damping }
}

fn sum(impulses: &ImpulseSequence) -> f64 {
    impulses.impulses().iter().map(|i| i.amplitude).sum()
}

/// Returns modes from 10 Hz on, each 1.15 to 3 times the previous one.
fn separate_modes(most: usize, damping: f64) -> impl Strategy<Value = Vec<Mode>> {
    prop::collection::vec((1.15..3.0, 0.0..damping), 1..=most).prop_map(|rows| {
        let mut frequency_hz = 10.0;
        let modes = rows.into_iter().map(|(ratio, damping): (f64, f64)| {
            frequency_hz *= ratio;
            mode(frequency_hz, damping)
        });
        modes.collect()
    })
}

/// Returns the sum `Σ A_i (t_i − t_n) e^{p (t_i − t_n)}` at a mode, in units of its radians.
fn moment(impulses: &ImpulseSequence, mode: &Mode) -> f64 {
    let end_s = impulses.duration_s();
    let (mut re, mut im) = (0.0, 0.0);
    for i in impulses.impulses() {
        let before_s = i.time_s - end_s;
        let size = i.amplitude * before_s * mode.omega() * (mode.decay() * before_s).exp();
        re += size * (mode.omega_damped() * before_s).cos();
        im += size * (mode.omega_damped() * before_s).sin();
    }
    f64::hypot(re, im)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prop_simultaneous_meets_its_constraints_within_its_bounds(
        modes in separate_modes(3, 0.2),
        double in prop::collection::vec(any::<bool>(), 3),
        unit in any::<bool>(),
    ) {
        let constraints: Vec<_> = modes.iter().zip(&double)
            .map(|(mode, double)| (*mode, if *double { Constraint::Zvd } else { Constraint::Zv }))
            .collect();
        let amplitudes = if unit { Amplitudes::UnitMagnitude } else { Amplitudes::PartialSum };
        match simultaneous::design(&constraints, amplitudes) {
            Ok(found) => {
                let sums = found.impulses.partial_sums();
                prop_assert_eq!((sums.min, sums.max), (if unit { 0.0 } else { -1.0 }, 1.0));
                let equations: usize = constraints.iter().map(|(_, c)| if *c == Constraint::Zvd { 4 } else { 2 }).sum();
                prop_assert_eq!(found.impulses.impulses().len(), equations + 1);
                for (mode, constraint) in &constraints {
                    prop_assert!(residual_vibration(found.impulses.impulses(), mode) < 1e-10);
                    if *constraint == Constraint::Zvd {
                        prop_assert!(moment(&found.impulses, mode) < 1e-9);
                    }
                }
            }
            Err(error) => prop_assert!(
                matches!(error, DesignError::Joint(JointError::NoSimultaneous { .. })), "{}", error
            ),
        }
    }

    #[test]
    fn prop_antisymmetric_leaves_nothing_at_odd_multiples(
        multiples in prop::collection::btree_set(0u32..12, 1..5),
        base_hz in 0.1..50.0,
        dampings in prop::collection::vec(prop::sample::select(vec![0.0, 0.01, 0.07]), 5),
    ) {
        let participants: Vec<_> = multiples.iter().zip(&dampings).map(|(m, damping)| {
            let damped_hz = base_hz * f64::from(2 * m + 1);
            let mode = mode(damped_hz / (1.0f64 - damping * damping).sqrt(), *damping);
            Participant { mode, participation: 1.0 }
        }).collect();
        let found = antisymmetric::design(&participants, AntisymmetricMethod::Exact, 0.0).unwrap();
        prop_assert_eq!(found.classes.len(), 1);
        prop_assert!(found.classes[0].multiples.error < 1e-14);
        let impulses = found.impulses.impulses();
        prop_assert!((sum(&found.impulses) - 1.0).abs() < 1e-13);
        prop_assert!(impulses.iter().all(|i| i.amplitude > 0.0));
        prop_assert!(impulses.len() <= participants.len() + 1);
        for p in &participants {
            prop_assert!(residual_vibration(impulses, &p.mode) < 1e-10);
        }
    }

    #[test]
    fn prop_partition_is_into_odd_multiples_and_of_different_powers(multiples in prop::collection::vec(1u32..200, 1..6)) {
        let frequencies: Vec<f64> = multiples.iter().map(|m| 0.7 * f64::from(*m)).collect();
        let classes = ratios::partition(&frequencies).unwrap();
        let members: usize = classes.iter().map(|c| c.members.len()).sum();
        prop_assert_eq!(members, multiples.len());
        let power = |index: usize| multiples[index].trailing_zeros();
        for class in &classes {
            prop_assert!(class.multiples.is_antisymmetric());
            prop_assert!(class.members.iter().all(|&i| power(i) == power(class.members[0])));
        }
        let mut powers: Vec<u32> = classes.iter().map(|c| power(c.members[0])).collect();
        powers.sort_unstable();
        powers.dedup();
        prop_assert_eq!(powers.len(), classes.len());
    }

    #[test]
    fn prop_periodic_solutions_keep_the_tolerance_and_nothing_between_them_does(
        modes in separate_modes(4, 1e-9),
        tolerance in 0.02..0.2,
        probe in 0.0..1.0,
    ) {
        let base = Base { kind: ShaperKind::MultiEi, order: 2, tolerance };
        let rows: Vec<_> = modes.iter().map(|m| (*m, tolerance)).collect();
        let lowest_hz = modes[0].frequency_hz / 10.0;
        let shaper = bias_point::undamped(base.kind, base.order, tolerance).unwrap();
        let worst = |system_hz: f64| modes.iter().map(|mode| {
            let impulses: Vec<_> = shaper.amplitudes.iter().enumerate().map(|(k, amplitude)| {
                posicast_shaper::impulse::Impulse { time_s: k as f64 / (2.0 * system_hz), amplitude: *amplitude }
            }).collect();
            residual_vibration(&impulses, mode)
        }).fold(0.0, f64::max);
        let frequencies: Vec<f64> = modes.iter().map(Mode::damped_frequency_hz).collect();
        let solutions = periodic::search(&frequencies, shaper.lambda, lowest_hz).unwrap();
        let inside = |hz: f64| solutions.iter().any(|s| (s.low_hz..=s.high_hz).contains(&hz));
        for solution in &solutions {
            let at = solution.low_hz + probe * (solution.high_hz - solution.low_hz);
            prop_assert!(worst(at) <= tolerance * (1.0 + 1e-6));
        }
        // The residual itself shows whether a frequency is suitable, as long as it is not higher than every mode
        // allows.
        for k in 0..200 {
            let at = lowest_hz * (1.0 + f64::from(k) / 20.0 + probe / 20.0);
            if at < modes[0].frequency_hz && worst(at) < tolerance * (1.0 - 1e-6) {
                prop_assert!(inside(at), "{at} Hz");
            }
        }
        match periodic::design(&rows, base, lowest_hz) {
            Ok(found) => {
                prop_assert_eq!(found.system_hz, solutions[0].high_hz);
                prop_assert!(solutions.iter().all(|s| s.high_hz <= found.system_hz));
                prop_assert!(modes.iter().all(|m| residual_vibration(found.impulses.impulses(), m) <= tolerance * (1.0 + 1e-6)));
            }
            Err(error) => {
                prop_assert!(solutions.is_empty());
                let named = matches!(error, DesignError::Joint(JointError::NoPeriodicSolution { .. }));
                prop_assert!(named, "{}", error);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn prop_vibrationless_keeps_its_bound_on_its_band(order in 1..=4u32, share in 0.0..1.0) {
        let epsilon = 0.002 * (EPSILON_MAX[order as usize - 1] / 0.002f64).powf(share);
        let found = optimum(order, epsilon).unwrap();
        prop_assert!((robustness_index(&found.ratios, epsilon * (1.0 + 1e-9)) - found.index).abs() < 1e-6);
        for k in 0..=1000 {
            let at = 1.0 + found.index * (f64::from(k) / 500.0 - 1.0);
            prop_assert!(2.0 * gain(&found.ratios, at) <= epsilon * (1.0 + 1e-8));
        }
        // More frequencies give a wider band; changing a single one does not make it wider.
        if order > 1 && epsilon <= EPSILON_MAX[order as usize - 2] {
            prop_assert!(optimum(order - 1, epsilon).unwrap().index < found.index);
        }
        for index in 0..found.ratios.len() {
            for factor in [1.0 - 1e-4, 1.0 + 1e-4] {
                let mut moved = found.ratios.clone();
                moved[index] *= factor;
                prop_assert!(robustness_index(&moved, epsilon) < found.index);
            }
        }
    }

    #[test]
    fn prop_absurd_modes_end_in_errors(
        frequencies in prop::collection::vec(prop::sample::select(vec![
            f64::MIN_POSITIVE, 1e-300, 1e-9, 1.0, 1.0 + 1e-12, 3.0, 1e9, 1e300, f64::MAX, f64::INFINITY, f64::NAN, -1.0, 0.0,
        ]), 0..6),
        damping in prop::sample::select(vec![0.0, 0.5, 0.999_999, 1.0, f64::NAN]),
        number in prop::sample::select(vec![0.0, 1e-300, 0.05, 0.999, 1.0, 1e300, f64::NAN, f64::INFINITY]),
    ) {
        let modes: Vec<Mode> = frequencies.iter().map(|f| mode(*f, damping)).collect();
        let constraints: Vec<_> = modes.iter().map(|m| (*m, Constraint::Zv)).collect();
        let participants: Vec<_> = modes.iter().map(|m| Participant { mode: *m, participation: number }).collect();
        let rows: Vec<_> = modes.iter().map(|m| (*m, number)).collect();
        let _ = simultaneous::design(&constraints, Amplitudes::PartialSum);
        for method in [AntisymmetricMethod::Exact, AntisymmetricMethod::TwoImpulse, AntisymmetricMethod::ThreeImpulse] {
            let _ = antisymmetric::design(&participants, method, number);
        }
        let _ = periodic::design(&rows, Base { kind: ShaperKind::ChebyshevEi, order: 5, tolerance: number }, number);
        let _ = robustness_index(&frequencies, number);
    }
}

#[test]
fn three_impulses_for_a_far_multiple_are_refused_at_once() {
    let participants = [1e-9, 1e9].map(|hz| Participant {
        mode: mode(hz, 0.5),
        participation: 1.0,
    });
    let found = antisymmetric::design(&participants, AntisymmetricMethod::ThreeImpulse, 0.05);
    assert!(
        matches!(
            found,
            Err(DesignError::Joint(JointError::ThreeImpulseMultiple {
                most: 16_384,
                ..
            }))
        ),
        "{found:?}"
    );
}

#[test]
fn a_single_mode_gets_the_shaper_of_its_own_kind() {
    let quarter = 0.25f64.acos() / std::f64::consts::TAU;
    let found = simultaneous::design(&[(mode(1.0, 0.0), Constraint::Zv)], Amplitudes::PartialSum).unwrap();
    let times: Vec<f64> = found.impulses.impulses().iter().map(|i| i.time_s).collect();
    for (found, expected) in times.iter().zip([0.0, quarter, 0.5 - quarter]) {
        assert!((found - expected).abs() < 1e-14);
    }
    assert!(found.is_time_optimal);
}

/// The cascade of a smaller bound keeps a larger one too, so its band is never the wider: a family of optima that is missing can show
/// as a band that shrinks.
fn band_of_vibrationless_grows(order: u32, steps: u32) {
    let largest = EPSILON_MAX[order as usize - 1];
    let bounds = (0..=steps).map(|k| largest * (0.002 / largest).powf(1.0 - f64::from(k) / f64::from(steps)));
    let bands: Vec<(f64, f64)> = bounds
        .map(|epsilon| (epsilon, optimum(order, epsilon).unwrap().index))
        .collect();
    for pair in bands.windows(2) {
        assert!(pair[0].1 < pair[1].1, "order {order}: (bound, band) {pair:?}");
    }
}

#[test]
fn long_the_band_of_vibrationless_grows_with_the_bound() {
    for order in 2..=ORDER_MAX {
        band_of_vibrationless_grows(order, 400);
    }
}

#[test]
fn the_band_of_vibrationless_grows_with_the_bound() {
    for order in 2..=ORDER_MAX {
        let largest = EPSILON_MAX[order as usize - 1];
        band_of_vibrationless_grows(order, 32);
        assert!(optimum(order, largest * 1.01).is_err());
    }
    for (order, epsilon) in [
        (0, 0.05),
        (6, 0.05),
        (u32::MAX, 0.05),
        (2, 0.0),
        (2, f64::NAN),
        (2, 1e300),
    ] {
        assert!(matches!(optimum(order, epsilon), Err(JointError::Vibrationless { .. })));
    }
}

#[test]
fn each_refusal_names_the_axis_the_kind_and_the_way_out() {
    let refused = |shaper: &str, modes: &[(f64, f64, &str)]| {
        design_machine(&machine(10_000, "modal", shaper, modes))
            .unwrap_err()
            .to_string()
    };
    let message = refused("kind = \"antisymmetric\"", &[(1.0, 0.0, ""), (2.0, 0.0, "")]);
    assert!(
        message.starts_with(
            "axis x: shaper \"antisymmetric\": no antisymmetry: the damped frequencies 1, 2 Hz are 1, 2 times"
        ),
        "{message}"
    );
    assert!(
        message.contains("\"zv\"") && message.contains("ratio_tolerance"),
        "{message}"
    );
    let message = refused(
        "kind = \"antisymmetric\"",
        &[(76.123457, 0.01, ""), (231.234571, 0.02, "")],
    );
    assert!(
        message.contains("no common divisor") && message.contains("ratio_tolerance"),
        "{message}"
    );
    let periodic = "kind = \"periodic\"\nbase = \"zv-ei\"\nlowest_frequency_hz = 5";
    let message = refused(periodic, &[(10.0, 0.0, ""), (20.0, 0.0, "")]);
    assert!(
        message.contains("no periodic solution above lowest_frequency_hz 5"),
        "{message}"
    );
    let message = refused("kind = \"periodic\"\nlowest_frequency_hz = 1e-9", &[(10.0, 0.0, "")]);
    assert!(message.contains("raise lowest_frequency_hz to"), "{message}");
    for kind in ["periodic", "simultaneous", "antisymmetric"] {
        let message = refused(
            &shaper(kind, 0.05),
            &[(10.0, 0.1, ""), (35.0, 0.1, ""), (10.0, 0.1, "")],
        );
        assert!(message.contains("modes 1 and 3 coincide at 10 Hz"), "{message}");
    }
    let five: Vec<_> = (0..5).map(|k| (10.0 + 7.0 * f64::from(k), 0.0, "")).collect();
    assert!(refused("kind = \"simultaneous\"", &five).contains("5 modes: this kind takes 1 to 4 modes"));
    let message = refused("kind = \"vibrationless\"\norder = 5\nepsilon = 0.5", &[(10.0, 0.0, "")]);
    assert!(message.contains("needs an epsilon from 1e-6 to 0.06"), "{message}");
    // Damping raises a mode above the tolerance of the undamped amplitudes: it is named, not hidden.
    let message = refused(
        "kind = \"periodic\"",
        &[(10.0, 0.0, ""), (30.0, 0.2, ""), (90.0, 0.3, "")],
    );
    assert!(message.contains("above its tolerance 0.05"), "{message}");
}

#[test]
fn a_tolerance_of_the_ratios_takes_measured_frequencies() {
    let modes = [(10.02, 0.01, ""), (29.9, 0.02, "")];
    let design = |tolerance: f64| {
        let shaper = format!("kind = \"antisymmetric\"\nratio_tolerance = {tolerance:?}");
        design_machine(&machine(1000, "modal", &shaper, &modes)).map(|d| d.axes[0].design.clone())
    };
    let found = design(0.01).unwrap();
    assert_eq!(found.impulses.impulses().len(), 3);
    for (frequency_hz, damping, _) in modes {
        // An error e of the ratio acts as m·e·π/2 on the mode.
        assert!(residual_vibration(found.impulses.impulses(), &mode(frequency_hz, damping)) < 3.0 * 0.01 * 1.6);
    }
}
