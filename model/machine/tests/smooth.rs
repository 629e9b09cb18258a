//! The smooth kinds, from the machine file to the integer table.

use crate::support::machine;
use posicast_machine::plan::design_machine;
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::digitise::TAPS_MAX;

#[test]
fn the_integer_table_of_a_smooth_kind_suppresses_its_mode() {
    for (kind, promised) in [
        ("smooth_zv", 0.0),
        ("smooth_mzv", 0.0),
        ("smooth_ei", 0.05),
        ("smooth_zvd", 0.0),
        ("smooth_si", 0.0),
        ("smooth_zvd_ei", 0.0),
        ("smooth_2hump_ei", 0.0),
    ] {
        let modes = [(48.0, 0.05, "")];
        let machine = machine(5000, "modal", &format!("kind = \"{kind}\""), &modes);
        let design = design_machine(&machine).unwrap();
        let table = &design.axes[0].table;
        let coefficients = table.taps().iter().map(|tap| tap.coefficient);
        assert_eq!(coefficients.clone().sum::<i32>(), 1 << table.coefficient_fraction());
        assert!(coefficients.clone().all(|coefficient| coefficient > 0), "{kind}");
        let residual = residual_vibration(&tap_impulses(table, design.sample_hz), &machine.axes[0].modes[0].mode);
        assert!((residual - promised).abs() < 2e-3, "{kind}: {residual}");
        // No jump of the command is larger than a few times the mean, and it begins and ends with small ones.
        let largest = coefficients.max().unwrap();
        let ends = [table.taps().first(), table.taps().last()].map(|tap| tap.unwrap().coefficient);
        assert!(ends.iter().all(|end| 5 * end < largest), "{kind} {ends:?} {largest}");
    }
}

#[test]
fn kernels_of_several_modes_are_convolved_on_one_grid() {
    let modes = [(22.0, 0.02, ""), (57.0, 0.03, "")];
    let machine = machine(10_000, "modal", "kind = \"smooth_zvd\"", &modes);
    let design = design_machine(&machine).unwrap();
    let table = &design.axes[0].table;
    assert!(table.taps().len() <= TAPS_MAX && table.taps().len() > TAPS_MAX / 2);
    // A cell of several samples: the delays are its multiples.
    let step = table.taps()[1].delay_samples - table.taps()[0].delay_samples;
    assert!(
        step > 1 && table.taps().iter().all(|tap| tap.delay_samples % step == 0),
        "{step}"
    );
    let taps = tap_impulses(table, design.sample_hz);
    for mode in &machine.axes[0].modes {
        let residual = residual_vibration(&taps, &mode.mode);
        assert!(residual < 2e-3, "{residual}");
    }
}

#[test]
fn a_mode_may_have_a_smooth_kind_beside_an_impulse_shaper() {
    let modes = [(60.0, 0.02, "shaper = \"smooth_zv\""), (170.0, 0.03, "shaper = \"zv\"")];
    let machine = machine(5000, "modal", "kind = \"zv\"", &modes);
    let design = design_machine(&machine).unwrap();
    assert_eq!(design.axes[0].design.kind, "smooth_zv+zv");
    let taps = tap_impulses(&design.axes[0].table, design.sample_hz);
    for mode in &machine.axes[0].modes {
        let residual = residual_vibration(&taps, &mode.mode);
        assert!(residual < 3e-3, "{residual}");
    }
}

#[test]
fn every_smooth_kind_has_its_word() {
    let smooth: Vec<&str> = ShaperKind::ALL
        .iter()
        .filter(|kind| kind.is_smooth())
        .map(|kind| kind.name())
        .collect();
    let expected = [
        "smooth_zv",
        "smooth_mzv",
        "smooth_ei",
        "smooth_zvd",
        "smooth_si",
        "smooth_zvd_ei",
        "smooth_2hump_ei",
    ];
    assert_eq!(smooth, expected);
}
