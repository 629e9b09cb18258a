//! What holds for every shaper, whatever the mode: sums, zeros, tolerances, tables; and that absurd numbers give
//! errors.

use crate::support;

use posicast_machine::machine_file::Machine;
use posicast_machine::motion::{Profile, command_words};
use posicast_machine::plan::{MachineDesign, design_machine};
use posicast_machine::plant::response::{step_figures, step_response};
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_shaper::analysis::{insensitivity, residual_vibration, sensitivity_curve, tap_impulses};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{design_axis, hump_ei, zv};
use posicast_shaper::digitise::Digitise;
use posicast_shaper::digitise::{DigitiseError, digitise};
use posicast_shaper::impulse::{Impulse, ImpulseSequence};
use posicast_shaper::mode::Mode;
use posicast_taps::{COEFFICIENT_FRACTION_MAX, COEFFICIENT_MAX, COEFFICIENT_MIN};
use proptest::prelude::*;
use support::{machine, shaper};

/// Kinds that leave no vibration at the mode.
const ZERO_KINDS: [(ShaperKind, u32); 4] = [
    (ShaperKind::Zv, 1),
    (ShaperKind::Zvd, 2),
    (ShaperKind::Zvdd, 3),
    (ShaperKind::Zvddd, 4),
];

/// Returns a mode from a centihertz to 100 kHz.
fn mode(damping: impl Strategy<Value = f64>) -> impl Strategy<Value = Mode> {
    (-2.0..5.0, damping).prop_map(|(decade, damping)| Mode {
        frequency_hz: 10f64.powf(decade),
        damping,
    })
}

fn sum(impulses: &[Impulse]) -> f64 {
    impulses.iter().map(|i| i.amplitude).sum()
}

/// Returns a machine with one or two modes of these kinds, at 10 kHz.
fn some_machine() -> impl Strategy<Value = Machine> {
    let kinds = prop::sample::select(vec!["zv", "zvd", "zvdd", "zvddd", "mzv", "ei", "zv-ei"]);
    let methods = prop::sample::select(vec!["modal", "linear", "nearest"]);
    // The damping goes up to the value at which `zv-ei` still exists for every one of these tolerances.
    let modes = prop::collection::vec((10.0..2000.0, 0.0..0.3), 1..3);
    (kinds, methods, modes, 0.01..0.2).prop_map(|(kind, method, modes, tolerance)| {
        let modes: Vec<_> = modes.into_iter().map(|(f, z): (f64, f64)| (f, z, "")).collect();
        machine(10_000, method, &shaper(kind, tolerance), &modes)
    })
}

proptest! {
    #[test]
    fn prop_zv_family_sums_to_one_and_leaves_nothing(mode in mode(0.0..0.95), family in prop::sample::select(ZERO_KINDS.to_vec())) {
        let shaper = zv::design(family.0, &mode, family.1).unwrap();
        prop_assert!((sum(shaper.impulses()) - 1.0).abs() < 1e-14);
        prop_assert!(shaper.impulses().iter().all(|i| i.amplitude > 0.0));
        prop_assert!(residual_vibration(shaper.impulses(), &mode) < 1e-12);
        // Each further factor adds a derivative: near the mode the residual is a higher power of the error.
        let off = residual_vibration(shaper.impulses(), &mode.scaled(1.0 + 1e-3));
        prop_assert!(off < 1.1 * (1.6e-3 / (1.0 - mode.damping * mode.damping).sqrt()).powi(family.1 as i32) + 1e-15);
    }

    #[test]
    fn prop_ei_meets_its_tolerance_at_the_hump_and_nothing_at_the_zeros(
        mode in mode(0.0..0.4),
        tolerance in 0.01..0.2,
    ) {
        let hump_ei::HumpEi { impulses, zeros, .. } = hump_ei::design(ShaperKind::Ei, &mode, tolerance).unwrap();
        let at = |ratio: f64| residual_vibration(impulses.impulses(), &mode.scaled(ratio));
        prop_assert!((sum(impulses.impulses()) - 1.0).abs() < 1e-14);
        prop_assert!(impulses.impulses().iter().all(|i| i.amplitude > 0.0));
        prop_assert!((at(1.0) - tolerance).abs() < 1e-10);
        prop_assert!(at(zeros[0]) < 1e-10 && at(zeros[1]) < 1e-10);
        for (ratio, residual) in sensitivity_curve(impulses.impulses(), &mode, zeros[0], zeros[1], 200) {
            prop_assert!(residual <= tolerance * (1.0 + 1e-9), "{} at {}", residual, ratio);
        }
    }

    #[test]
    fn prop_the_pole_sums_of_a_convolution_multiply(
        first in mode(0.0..0.5),
        second in mode(0.0..0.5),
        family in prop::sample::select(ZERO_KINDS.to_vec()),
        ratio in 0.2..3.0,
    ) {
        // The frequencies are within about a decade: beyond it, V is the rest of 1 after 2^50, or underflows.
        let second = Mode { frequency_hz: first.frequency_hz * (second.frequency_hz.log10() - 1.5).exp2(), ..second };
        let a = zv::design(family.0, &first, family.1).unwrap();
        let b = zv::design(ShaperKind::Zvd, &second, 2).unwrap();
        let both = a.convolve(&b).unwrap();
        prop_assert!((sum(both.impulses()) - 1.0).abs() < 1e-13);
        prop_assert!((both.delay_s() - a.delay_s() - b.delay_s()).abs() < 1e-12 * both.duration_s());
        let at = |sequence: &ImpulseSequence, mode: &Mode| residual_vibration(sequence.impulses(), mode);
        for mode in [first, second, first.scaled(ratio)] {
            prop_assert!((at(&both, &mode) - at(&a, &mode) * at(&b, &mode)).abs() < 1e-11);
        }
    }

    #[test]
    fn prop_insensitivity_ends_on_the_tolerance_and_holds_inside(
        mode in mode(0.0..0.4),
        tolerance in 0.01..0.3,
        family in prop::sample::select(ZERO_KINDS.to_vec()),
        inside in prop::collection::vec(0.0..1.0, 20),
    ) {
        let shaper = zv::design(family.0, &mode, family.1).unwrap();
        let at = |ratio: f64| residual_vibration(shaper.impulses(), &mode.scaled(ratio));
        let found = insensitivity(shaper.impulses(), &mode, tolerance).unwrap();
        let limit = tolerance * (1.0 + 1e-6);
        prop_assert!((at(found.low) - limit).abs() < 1e-10);
        if let Some(high) = found.high {
            prop_assert!((at(high) - limit).abs() < 1e-10);
        }
        let high = found.high.unwrap_or(10.0);
        for share in inside {
            prop_assert!(at(found.low + share * (high - found.low)) <= limit + 1e-10);
        }
    }

    #[test]
    fn prop_tables_sum_to_a_power_of_two_and_stay_next_to_the_real_taps(machine in some_machine()) {
        let design = design_machine(&machine).unwrap();
        let axis = &design.axes[0];
        let scale = f64::from(1u32 << design.coefficient_fraction);
        let total: i64 = axis.table.taps().iter().map(|t| i64::from(t.coefficient)).sum();
        prop_assert_eq!(total, 1 << design.coefficient_fraction);
        let reals: f64 = axis.digitised.taps.iter().map(|t| t.weight).sum();
        prop_assert!((reals - 1.0).abs() < 1e-12);
        for tap in axis.table.taps() {
            prop_assert!((COEFFICIENT_MIN..=COEFFICIENT_MAX).contains(&tap.coefficient));
            let real = axis.digitised.taps.iter().find(|r| r.delay_samples == tap.delay_samples).unwrap();
            prop_assert!((f64::from(tap.coefficient) - real.weight * scale).abs() < 1.0);
        }
        // This is the largest F: with one more bit, some coefficient would not fit.
        let largest = axis.digitised.taps.iter().map(|t| t.weight.abs()).fold(0.0, f64::max);
        prop_assert!(
            design.coefficient_fraction == COEFFICIENT_FRACTION_MAX || largest * scale * 2.0 > f64::from(COEFFICIENT_MAX) - 1.0
        );
    }

    #[test]
    fn prop_rounding_costs_no_more_residual_than_its_bound(machine in some_machine()) {
        let design = design_machine(&machine).unwrap();
        let axis = &design.axes[0];
        let same_end = axis.table.longest_delay_samples() == axis.digitised.taps.last().unwrap().delay_samples;
        for figures in axis.mode_figures(&machine.axes[0], design.sample_hz) {
            // If the last tap rounds to zero, the two residuals count from different ends.
            if same_end {
                let excess = figures.residual_quantised - figures.residual_digitised;
                prop_assert!(excess.abs() <= axis.quantising_error() + 1e-14);
            }
        }
    }

    #[test]
    fn prop_integer_output_stays_within_its_bound(machine in some_machine(), command in prop::collection::vec(any::<i32>(), 1..60)) {
        // The words are small, because the bound does not cover saturation.
        let command: Vec<i64> = command.into_iter().map(|word| i64::from(word >> 8)).collect();
        let axis = &design_machine(&machine).unwrap().axes[0];
        let fraction = axis.table.coefficient_fraction();
        for (sample, float) in axis.digitised.shape(&command).into_iter().enumerate() {
            let word = |delay: u32| command[sample.saturating_sub(delay as usize)];
            let sum: i64 = axis.table.taps().iter().map(|t| i64::from(t.coefficient) * word(t.delay_samples)).sum();
            let integer = (sum + (1 << (fraction - 1))) >> fraction;
            prop_assert!((integer as f64 - float).abs() <= axis.output_bound_lsb(&command) * (1.0 + 1e-12));
        }
    }

    #[test]
    fn prop_modal_taps_keep_every_zero(
        modes in prop::collection::vec((10.0..2000.0, 0.0..0.35), 1..4),
        kind in prop::sample::select(vec!["zv", "zvd"]),
    ) {
        let modes: Vec<_> = modes.into_iter().map(|(f, z): (f64, f64)| (f, z, "")).collect();
        let machine = machine(10_000, "modal", &shaper(kind, 0.05), &modes);
        let design = design_axis(machine.axes[0].shaped(), machine.clock.sample_hz).unwrap();
        let taps = digitise(&design, Digitise::Modal, 10_000.0).unwrap().impulses(10_000.0);
        for axis_mode in &machine.axes[0].modes {
            prop_assert!(residual_vibration(&taps, &axis_mode.mode) < 1e-10);
        }
    }

    #[test]
    fn prop_the_plant_measures_what_the_pole_sum_says(machine in some_machine()) {
        let MachineDesign { sample_hz, axes, .. } = design_machine(&machine).unwrap();
        let plant = Plant::of_axis(&machine.axes[0]).unwrap();
        let figures = step_figures(&plant, &tap_impulses(&axes[0].table, sample_hz));
        for (measured, of_mode) in figures.residual.iter().zip(axes[0].mode_figures(&machine.axes[0], sample_hz)) {
            prop_assert!((measured - of_mode.residual_quantised).abs() < 1e-11);
        }
        prop_assert!(figures.overshoot >= 0.0 && figures.overshoot < 1.0);
    }

    #[test]
    fn prop_coincident_modes_are_as_good_as_one(f in 5.0..2000.0, z in 0.0..0.3, apart in prop::sample::select(vec![0.0, 1e-16, 1e-13, 1e-9, 1e-3])) {
        let machine = machine(10_000, "modal", &shaper("zv", 0.05), &[(f, z, ""), (f * (1.0 + apart), z, ""), (2.0 * f, 0.0, "")]);
        let design = design_machine(&machine).unwrap();
        for figures in design.axes[0].mode_figures(&machine.axes[0], 10_000.0) {
            prop_assert!(figures.residual < 1e-10 && figures.residual_digitised < 1e-10);
        }
    }

    #[test]
    fn prop_command_words_are_the_nearest(positions in prop::collection::vec(-0.1..0.1, 1..50)) {
        let words = command_words(&positions, 1e6, 32, 8).unwrap();
        for (word, position) in words.into_iter().zip(positions) {
            prop_assert!((word as f64 - position * 256e6).abs() <= 0.5);
        }
    }
}

/// Returns any number, often one that is almost sensible.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -2.0..2.0,
        0.0..1e4,
        (-320i32..309).prop_map(|e| 10f64.powi(e)),
        prop::sample::select(vec![
            0.0,
            -0.0,
            1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            1.0 - f64::EPSILON / 2.0
        ]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn prop_absurd_machines_end_in_tables_or_errors(
        modes in prop::collection::vec((any_number(), any_number(), any_number()), 0..5),
        kind in prop::sample::select(ShaperKind::ALL.to_vec()),
        own_kind in prop::option::of(prop::sample::select(ShaperKind::ALL.to_vec())),
        tolerance in any_number(),
        sample_hz in any_number(),
        fraction in prop::option::of(any::<u32>()),
        impulses in prop::collection::vec((any_number(), any_number()), 0..5),
    ) {
        let mut machine = machine(10_000, "modal", "kind = \"zv\"", &[(100.0, 0.1, "")]);
        machine.clock.sample_hz = sample_hz;
        machine.fixed_point.coefficient_fraction = fraction;
        let axis = &mut machine.axes[0];
        let template = axis.modes.remove(0);
        for (frequency_hz, damping, participation) in modes {
            let mut axis_mode = template.clone();
            axis_mode.mode = Mode { frequency_hz, damping };
            axis_mode.participation = participation;
            axis_mode.shaper = own_kind;
            axis.modes.push(axis_mode);
        }
        let choice = axis.shaper.as_mut().unwrap();
        choice.kind = kind;
        choice.tolerance = Some(tolerance);
        choice.impulses = impulses;
        if let Ok(design) = design_machine(&machine) {
            let figures = design.axes[0].mode_figures(&machine.axes[0], sample_hz);
            prop_assert_eq!(figures.len(), machine.axes[0].modes.len());
        }
    }

    #[test]
    fn prop_absurd_plants_and_moves_end(
        modes in prop::collection::vec((any_number(), any_number(), any_number()), 0..4),
        impulses in prop::collection::vec((any_number(), any_number()), 0..4),
        limits in [any_number(), any_number(), any_number(), any_number(), any_number()],
        sample_hz in any_number(),
        bits in any::<u32>(),
        fraction in any::<u32>(),
    ) {
        let impulses: Vec<_> = impulses.into_iter().map(|(time_s, amplitude)| Impulse { time_s, amplitude }).collect();
        let modes: Vec<_> = modes
            .into_iter()
            .map(|(frequency_hz, damping, participation)| (Mode { frequency_hz, damping }, participation))
            .collect();
        if let Ok(plant) = Plant::new(&modes) {
            step_figures(&plant, &impulses);
            step_response(&plant, &impulses, limits[0], 10);
            SampledPlant::new(&plant, sample_hz, limits[1]).step(limits[2]);
        }
        let [start, end, velocity, acceleration, jerk] = limits;
        if let Ok(profile) = Profile::new(start, end, velocity, acceleration, jerk) {
            // Millions of samples are valid and slow: a thousand of them show as much.
            let sample_hz = sample_hz.min(1000.0 / profile.duration_s());
            if let Ok(positions) = profile.samples(sample_hz, 0.0) {
                let _ = command_words(&positions, end, bits, fraction);
            }
        }
    }
}

#[test]
fn prop_a_slow_mode_at_a_fast_rate_is_refused_at_once() {
    let machine = machine(1_000_000, "modal", &shaper("zvd", 0.05), &[(0.001, 0.0, "")]);
    let error = design_machine(&machine).unwrap_err();
    assert!(
        matches!(
            error,
            posicast_shaper::design::DesignError::Table(DigitiseError::Delay { .. })
        ),
        "{error}"
    );
}
