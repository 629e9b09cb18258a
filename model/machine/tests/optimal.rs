//! Compares `optimal`, from the machine file to the integer table and its certificates, with the definition of the
//! residual.

use crate::support::machine;
use posicast_machine::machine_file::{Machine, parse};
use posicast_machine::plan::{AxisTables, MachineDesign, blame, design_machine};
use posicast_machine::plan::{certify_axis, measure_corners};
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::certify::{
    CheckedShorter, ShorterError, check_delay, check_shorter, check_together, residual_bound,
};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, Findings, design_axis};
use posicast_shaper::mode::{Mode, ModeBand};
use proptest::prelude::*;
use std::f64::consts::PI;

const OPTIMAL: &str = "kind = \"optimal\"";
const ONE_BAND: &[(f64, f64, &str)] = &[(25.0, 0.02, "frequency_band = 0.1\ndamping_band = [0.01, 0.06]")];
const TWO_BANDS: &[(f64, f64, &str)] = &[
    (24.0, 0.02, "frequency_band = 0.08\ndamping_band = [0.01, 0.04]"),
    (71.0, 0.015, "frequency_band = 0.05"),
];

fn designed(machine: &Machine) -> (MachineDesign, AxisTables) {
    let design = design_machine(machine).unwrap();
    let tables = design.axes[0].clone();
    (design, tables)
}

/// Returns the largest residual of a table by the definition, on a grid over a band.
fn largest_on_grid(tables: &AxisTables, sample_hz: f64, band: &ModeBand) -> f64 {
    let taps = tap_impulses(&tables.table, sample_hz);
    let mut largest = 0.0f64;
    for column in 0..=300 {
        for row in 0..=6 {
            let between = |[low, high]: [f64; 2], part: f64| low + (high - low) * part;
            let mode = Mode {
                frequency_hz: between(band.frequency_hz, f64::from(column) / 300.0),
                damping: between(band.damping, f64::from(row) / 6.0),
            };
            largest = largest.max(residual_vibration(&taps, &mode));
        }
    }
    largest
}

#[test]
fn the_integer_table_is_certified_over_the_bands() {
    for (shaper, modes) in [
        (OPTIMAL, ONE_BAND),
        (OPTIMAL, TWO_BANDS),
        ("kind = \"optimal\"\ncommand = [-1, 1]", TWO_BANDS),
        ("kind = \"optimal\"\namplitude_bounds = [0, 0.2]", TWO_BANDS),
        ("kind = \"optimal\"\nprefer = \"least-residual\"", ONE_BAND),
        (
            "kind = \"optimal\"\nprefer = \"least-delay\"\ntolerance = 0.02",
            ONE_BAND,
        ),
    ] {
        let machine = machine(1000, "modal", shaper, modes);
        let (design, tables) = designed(&machine);
        let certificate = certify_axis(&machine.axes[0], &tables, design.sample_hz);
        for mode in &certificate.modes {
            assert!(mode.holds(), "{shaper} {mode:?}");
            let largest = largest_on_grid(&tables, design.sample_hz, &mode.band);
            assert!(mode.residual.bound >= largest, "{shaper} {mode:?} {largest}");
            // Bound and finding are one value to a millionth, so the bound says something.
            assert!(
                mode.residual.bound <= mode.residual.found * (1.0 + 2e-6) + 2e-9,
                "{mode:?}"
            );
        }
        let shorter = certificate.shorter.unwrap().unwrap();
        assert_eq!(shorter.samples + 1, tables.table.longest_delay_samples(), "{shaper}");
        assert!(shorter.ratio > 1.0);
    }
}

#[test]
fn the_plant_at_the_corners_keeps_the_certified_residual() {
    let machine = machine(1000, "modal", OPTIMAL, TWO_BANDS);
    let (design, tables) = designed(&machine);
    let certificate = certify_axis(&machine.axes[0], &tables, design.sample_hz);
    let corners = measure_corners(&machine.axes[0], &tables, &certificate, design.sample_hz).unwrap();
    // Four of the mode with two bands, two of that with one.
    assert_eq!(corners.len(), 6);
    for corner in &corners {
        assert!(corner.measured <= corner.certified + 1e-9, "{corner:?}");
    }
    assert!(
        corners.iter().any(|corner| corner.measured > 0.9 * corner.certified),
        "{corners:?}"
    );
}

#[test]
fn a_proof_that_was_tampered_with_is_refused() {
    let machine = machine(1000, "modal", OPTIMAL, ONE_BAND);
    let (_, tables) = designed(&machine);
    let Findings::Optimal(found) = &tables.design.findings else {
        panic!("{:?}", tables.design.findings);
    };
    let proof = found.shorter.clone().unwrap();
    assert!(check_shorter(&found.request, &proof).is_ok());
    // The duration that has a shaper cannot be excluded, whatever the weights.
    let mut longer = proof.clone();
    longer.samples += 1;
    assert!(matches!(
        check_shorter(&found.request, &longer),
        Err(ShorterError::Loose { .. })
    ));
    let mut turned = proof.clone();
    turned.points[0].weight[0] *= -1.0;
    assert!(check_shorter(&found.request, &turned).is_err());
    let mut outside = proof.clone();
    outside.points[0].frequency_hz *= 1.5;
    assert_eq!(
        check_shorter(&found.request, &outside),
        Err(ShorterError::Point { index: 0 })
    );
    // Weights only count relative to each other.
    let mut scaled = proof.clone();
    scaled
        .points
        .iter_mut()
        .for_each(|point| point.weight = point.weight.map(|part| 7.0 * part));
    let [plain, scaled] = [&proof, &scaled].map(|proof| check_shorter(&found.request, proof).unwrap().ratio);
    assert!((plain - scaled).abs() < 1e-12);
}

/// Returns the amplitudes `a_0, a_1, a_2, a_1, a_0` of the undamped multi-EI at half periods, from its response
/// `V·T₂(z)`, which has equal ripple around the mode at `θ = π`, and is 1 at `θ = 0`, at standstill.
fn multi_ei(tolerance: f64) -> [f64; 5] {
    let x = ((1.0 / tolerance).acosh() / 2.0).cosh();
    let edge = (3.0 - x) / (1.0 + x);
    let response = |phase: f64| {
        let z = (2.0 * phase.cos() + 1.0 - edge) / (1.0 + edge);
        tolerance * (2.0 * z * z - 1.0)
    };
    let points = 64;
    let amplitude = |harmonic: f64| {
        let sum: f64 = (0..points)
            .map(|point| 2.0 * PI * f64::from(point) / f64::from(points))
            .map(|phase| response(phase) * (harmonic * phase).cos())
            .sum();
        sum / f64::from(points)
    };
    [2.0, 1.0, 0.0, 1.0, 2.0].map(amplitude)
}

#[test]
fn golden_an_insensitivity_of_two_periods_has_the_multi_ei_amplitudes() {
    let modes: &[(f64, f64, &str)] = &[(1.0, 0.0, "frequency_band = 0.4815")];
    let machine = machine(200, "modal", "kind = \"optimal\"\nprefer = \"least-residual\"", modes);
    let (_, tables) = designed(&machine);
    assert!(tables.table.longest_delay_samples().abs_diff(400) <= 1);
    let expected = multi_ei(0.05);
    assert!((expected.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    for (half_period, expected) in expected.into_iter().enumerate() {
        let near = tables.design.impulses.impulses().iter();
        let near = near.filter(|i| (i.time_s - half_period as f64 / 2.0).abs() < 0.25);
        let found: f64 = near.map(|impulse| impulse.amplitude).sum();
        assert!((found - expected).abs() < 0.01, "{half_period}: {found} {expected}");
    }
}

#[test]
fn a_bound_with_a_stage_holds_with_the_folded_delay() {
    let text = "name = \"two\"\n[clock]\nfrequency_hz = 1_000_000\nsample_hz = 1_000\n[stage]\nextra_delay_s = 0.0\n\
                [[axis]]\nname = \"x\"\ncounts_per_unit = 1e5\n[axis.shaper]\nkind = \"optimal\"\n[[axis.mode]]\nfrequency_hz = 25\n\
                damping = 0.02\nfrequency_band = 0.1\n\
                [[axis]]\nname = \"y\"\ncounts_per_unit = 1e5\n[axis.shaper]\nkind = \"zvd\"\n[[axis.mode]]\nfrequency_hz = 11\ndamping = 0.01\n";
    let machine = parse("two.toml", text).unwrap();
    let design = design_machine(&machine).unwrap();
    let certificate = certify_axis(&machine.axes[0], &design.axes[0], design.sample_hz);
    assert!(certificate.modes[0].holds(), "{certificate:?}");
    assert!(design.axes[0].delay.added_samples > 0.0);
}

/// Two axes that arrive together, or with delays that are only made equal.
fn two_axes(arrive_together: bool) -> Machine {
    let axis = |name: &str, mode: &str| {
        format!(
            "[[axis]]\nname = \"{name}\"\ncounts_per_unit = 1e5\n[axis.shaper]\nkind = \"optimal\"\n[[axis.mode]]\n{mode}\n"
        )
    };
    let text = format!(
        "name = \"two\"\n[clock]\nfrequency_hz = 1_000_000\nsample_hz = 1_000\n[stage]\narrive_together = {arrive_together}\n{}{}",
        axis("x", "frequency_hz = 31\ndamping = 0.02\nfrequency_band = 0.1"),
        axis("y", "frequency_hz = 18\ndamping = 0.05\nfrequency_band = 0.1"),
    );
    parse("two.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn axes_that_arrive_together_have_one_delay_without_padding() {
    let machine = two_axes(true);
    let design = design_machine(&machine).unwrap();
    let together = design.together.as_ref().unwrap();
    let checked = check_together(&together.partners, &together.found);
    let Some(Ok(CheckedShorter::Alone { axis: 1, bound })) = checked.shorter else {
        panic!("{:?}", checked.shorter);
    };
    assert_eq!(bound.samples + 1, together.found.samples);
    let least = checked.least_delay_samples.unwrap().unwrap();
    assert!(
        least <= together.found.delay_samples + 1e-6 && least > together.found.delay_samples - 0.5,
        "{least} {}",
        together.found.delay_samples
    );
    for (axis, tables) in machine.axes.iter().zip(&design.axes) {
        assert!(tables.delay.added_samples.abs() < 1e-9, "{:?}", tables.delay);
        let total = tables.delay.designed_s() * design.sample_hz;
        assert!((total - together.found.delay_samples).abs() < 1e-6, "{total}");
        assert!(tables.table.longest_delay_samples() <= together.found.samples);
        let certificate = certify_axis(axis, tables, design.sample_hz);
        let mode = certificate.modes[0];
        assert!(
            mode.residual.bound <= mode.tolerance + 2.0 / 65_536.0,
            "{certificate:?}"
        );
    }
    // Delayed instead, the axes are no earlier, and the fraction of a sample costs taps.
    let apart = design_machine(&two_axes(false)).unwrap();
    assert!(apart.together.is_none());
    let total = |design: &MachineDesign| design.axes[0].delay.designed_s();
    assert!(total(&design) <= total(&apart) + 1e-9);
    assert!(design.axes[0].table.taps().len() < apart.axes[0].table.taps().len());
}

#[test]
fn a_delay_bound_holds_for_any_weights_and_for_the_shaper_itself() {
    let machine = two_axes(true);
    let design = design_machine(&machine).unwrap();
    let together = design.together.unwrap();
    let (bound, axis) = (together.found.earlier.unwrap(), together.found.latest_axis);
    let partner = &together.partners[axis];
    let best = check_delay(&partner.request, &bound).unwrap();
    let own = together.found.delay_samples - partner.lag_samples;
    assert!(best <= own + 1e-6);
    for factor in [0.0, 0.5, 1.5, -1.0] {
        let mut other = bound.clone();
        for point in &mut other.points {
            point.weight = point.weight.map(|part| factor * part);
        }
        let found = check_delay(&partner.request, &other).unwrap();
        assert!(found < best, "{factor}: {found} {best}");
    }
    let mut outside = bound;
    outside.points[0].frequency_hz *= 2.0;
    assert_eq!(
        check_delay(&partner.request, &outside),
        Err(ShorterError::Point { index: 0 })
    );
}

#[test]
fn what_cannot_be_is_blamed_on_its_key_with_a_remedy() {
    let blamed = |shaper: &str, modes: &[(f64, f64, &str)]| {
        let machine = machine(1000, "modal", shaper, modes);
        let error = design_machine(&machine).unwrap_err();
        assert!(matches!(error, DesignError::JointOfAxis { .. }), "{error}");
        let blame = blame(&machine, &error).unwrap();
        (blame.key, blame.mode, blame.remedy.unwrap(), error.to_string())
    };
    let (key, _, remedy, text) = blamed("kind = \"optimal\"\ntaps = 2", ONE_BAND);
    assert_eq!(key, "axis.shaper.taps");
    assert!(
        remedy.contains("allow `taps = ") && text.contains("with 2 taps"),
        "{remedy} {text}"
    );
    let (key, _, remedy, text) = blamed("kind = \"optimal\"\namplitude_bounds = [0, 0.00005]", ONE_BAND);
    assert_eq!(key, "axis.shaper.amplitude_bounds");
    assert!(
        remedy.contains("0.000061") && text.contains("at 16383 samples"),
        "{remedy} {text}"
    );
    // Half a period of 25 s does not fit the longest ring at 1 kHz.
    let (key, _, remedy, text) = blamed(OPTIMAL, &[(0.02, 0.0, "")]);
    assert_eq!(key, "axis.shaper");
    assert!(
        remedy.contains("sample_hz") && text.contains("16382 samples"),
        "{remedy} {text}"
    );
}

#[test]
fn a_mode_without_bands_is_a_point() {
    let machine = machine(
        1000,
        "modal",
        "kind = \"optimal\"\ntolerance = 0.01",
        &[(20.0, 0.03, "")],
    );
    let design = design_axis(machine.axes[0].shaped(), 1000.0).unwrap();
    let residual = residual_vibration(design.impulses.impulses(), &machine.axes[0].modes[0].mode);
    assert!(residual <= 0.01 * (1.0 + 1e-6));
    // Shorter than zv by what the tolerance allows, and no more.
    let half_period_s = machine.axes[0].modes[0].mode.damped_period_s() / 2.0;
    let shorter_s = half_period_s - design.impulses.duration_s();
    assert!((0.0..0.002).contains(&shorter_s), "{shorter_s}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn prop_the_bound_of_any_kind_is_above_and_near_what_is_found(
        kind in prop::sample::select(vec![ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei, ShaperKind::PsZv, ShaperKind::UmEi]),
        frequency_hz in 8.0..120.0f64,
        damping in 0.0..0.2f64,
        frequency in 0.0..0.4f64,
        below in 0.0..1.0f64,
        above in 0.0..0.2f64,
    ) {
        let machine = machine(1000, "modal", &format!("kind = \"{kind}\""), &[(frequency_hz, damping, "")]);
        let (design, tables) = designed(&machine);
        let band = ModeBand {
            frequency_hz: [frequency_hz * (1.0 - frequency), frequency_hz * (1.0 + frequency)],
            damping: [damping * below, damping + above],
        };
        let found = residual_bound(&tables.table, design.sample_hz, &band);
        let largest = largest_on_grid(&tables, design.sample_hz, &band);
        prop_assert!(found.bound >= largest, "{:?} {}", found, largest);
        prop_assert!(found.bound <= found.found * (1.0 + 2e-6) + 2e-9, "{:?}", found);
        let at = residual_vibration(&tap_impulses(&tables.table, design.sample_hz), &found.at);
        prop_assert!((at - found.found).abs() < 1e-9);
    }
}
