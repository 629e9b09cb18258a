//! Equal total delay of the axes of a stage: numbers computed elsewhere, and what holds for every stage.

use posicast_machine::machine_file::{self, Machine, Scale, ScaleUse};
use posicast_machine::plan::matching::mode_lag_s;
use posicast_machine::plan::{MachineDesign, design_machine};
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::design::DesignError;
use posicast_shaper::digitise::{DELAY_MAX_SAMPLES, DigitiseError};
use proptest::prelude::*;

/// Returns a machine with the axes `a`, `b`, …, each with a kind, frequency and damping, and further lines at the
/// end.
fn machine(digitise: &str, axes: &[(&str, f64, f64)], more: &str) -> Machine {
    let mut text = format!(
        "name = \"stage_of_axes\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[fixed_point]\n\
         digitise = \"{digitise}\"\n"
    );
    for ((kind, frequency_hz, damping), name) in axes.iter().zip(["a", "b", "c", "d"]) {
        text += &format!(
            "[[axis]]\nname = \"{name}\"\ncounts_per_unit = 1_000_000\n[axis.shaper]\nkind = \"{kind}\"\n[[axis.mode]]\n\
             frequency_hz = {frequency_hz:?}\ndamping = {damping:?}\n"
        );
    }
    machine_file::parse("m.toml", &(text.clone() + more)).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

const XY: [(&str, f64, f64); 2] = [("zvd", 131.117, 0.1578), ("zvd", 93.29, 0.1535)];

fn taps(design: &MachineDesign, axis: usize) -> Vec<(u32, i32)> {
    let taps = design.axes[axis].table.taps().iter();
    taps.map(|tap| (tap.delay_samples, tap.coefficient)).collect()
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// The XY stage, from another program: impulses in closed form, two taps each by solving for the pole sum, the
/// fraction convolved in, largest remainders.
#[test]
fn golden_the_xy_stage() {
    let design = design_machine(&machine("modal", &XY, "[stage]\ncontour_speed = 0.1\n")).unwrap();
    let [x, y] = [0, 1].map(|axis: usize| design.axes[axis].delay);
    near(x.shaper_s, 0.0029128580965274353);
    near(x.mode_lag_s, 0.0003830876243340083);
    assert!((x.added_samples - 13.543887249334416).abs() < 1e-8);
    near(y.shaper_s, 0.004126585195830132);
    near(y.mode_lag_s, 0.0005237492499647537);
    assert_eq!(y.added_samples, 0.0);
    let x_taps = [
        (13, 11594),
        (14, 13825),
        (51, 5414),
        (52, 15089),
        (53, 10295),
        (90, 3259),
        (91, 4878),
        (92, 1182),
    ];
    assert_eq!(taps(&design, 0), x_taps);
    assert_eq!(
        taps(&design, 1),
        [(0, 25158), (54, 23556), (55, 7339), (108, 4969), (109, 4514)]
    );
    near(x.total_s(), 0.004650362099431664);
    near(y.total_s(), 0.004650255292445222);
    let stage = design.stage.unwrap();
    near(stage.total_s, 0.004650334445794885);
    near(stage.mismatch_s, 1.0680698644179726e-7);
    assert!((stage.mismatch_um().unwrap() - 0.010680698644).abs() < 1e-9);
}

#[test]
fn golden_extra_delay_is_for_every_axis() {
    let design = design_machine(&machine("modal", &XY, "[stage]\nextra_delay_s = 250e-6\n")).unwrap();
    let y_taps = [
        (2, 12579),
        (3, 12579),
        (56, 11778),
        (57, 15447),
        (58, 3669),
        (110, 2485),
        (111, 4742),
        (112, 2257),
    ];
    assert_eq!(taps(&design, 1), y_taps);
    assert_eq!(taps(&design, 0)[0], (16, 24304));
    let stage = design.stage.unwrap();
    near(stage.total_s, 0.0049003344457948855);
    assert_eq!((stage.contour_speed, stage.mismatch_um()), (None, None));
}

#[test]
fn without_stage_nothing_is_added() {
    let design = design_machine(&machine("modal", &XY, "")).unwrap();
    assert!(design.stage.is_none());
    assert!(design.axes.iter().all(|axis| axis.delay.added_samples == 0.0));
    assert_eq!(
        taps(&design, 0).iter().map(|tap| tap.0).collect::<Vec<_>>(),
        [0, 38, 39, 77, 78]
    );
}

#[test]
fn the_contour_speed_is_the_smallest_velocity_limit_where_the_file_does_not_say() {
    let mut machine = machine("modal", &XY, "[axis.limits]\nvelocity = 0.5\n[stage]\n");
    machine.axes[0].limits = machine.axes[1].limits;
    machine.axes[0].limits.as_mut().unwrap().velocity = Some(0.2);
    assert_eq!(
        design_machine(&machine).unwrap().stage.unwrap().contour_speed,
        Some(0.2)
    );
}

#[test]
fn an_axis_without_modes_gets_the_lag_of_the_others() {
    let text = "name = \"laser\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\n\
                counts_per_unit = 1000\n[axis.shaper]\nkind = \"zv\"\n[[axis.mode]]\nfrequency_hz = 40.0\ndamping = 0.1\n\
                [[axis]]\nname = \"laser\"\ncounts_per_unit = 1\n[axis.shaper]\nkind = \"none\"\n[stage]\n";
    let design = design_machine(&machine_file::parse("m.toml", text).unwrap()).unwrap();
    let delay = design.axes[1].delay;
    assert_eq!((delay.shaper_s, delay.mode_lag_s), (0.0, 0.0));
    near(delay.added_s, design.stage.unwrap().total_s);
    // This is a two-tap table: a delay of a fraction of a sample.
    assert_eq!(design.axes[1].table.taps().len(), 2);
}

#[test]
fn a_loop_that_holds_the_load_has_no_lag_of_modes() {
    let text = include_str!("../../../examples/xy-stage-torque.toml");
    let torque = machine_file::parse("m.toml", text).unwrap();
    assert_eq!(mode_lag_s(&torque.axes[0]), 0.0);
    let mut open = torque.axes[0].clone();
    open.controller = None;
    near(mode_lag_s(&open), 0.0003691310407755789);
    let text = include_str!("../../../examples/xy-stage.toml");
    let velocity = machine_file::parse("m.toml", text).unwrap();
    near(mode_lag_s(&velocity.axes[0]), 0.0003830853101510995);
    let mut scaled = velocity.axes[0].clone();
    scaled.scale = Some(Scale {
        counts_per_unit: 1e6,
        usage: ScaleUse::Monitor,
        invert: false,
    });
    assert!(mode_lag_s(&scaled) > 0.0);
    scaled.scale = Some(Scale {
        counts_per_unit: 1e6,
        usage: ScaleUse::Position,
        invert: false,
    });
    assert_eq!(mode_lag_s(&scaled), 0.0);
}

#[test]
fn a_delay_beyond_the_ring_is_an_error_that_names_the_slowest_axis() {
    // The largest delay that the file may ask for fits at 10 kHz.
    design_machine(&machine("modal", &XY, "[stage]\nextra_delay_s = 1.0\n")).unwrap();
    let mut late = machine("modal", &XY, "[stage]\n");
    for extra_delay_s in [1.63, 1e300, f64::INFINITY] {
        late.stage.as_mut().unwrap().extra_delay_s = extra_delay_s;
        let error = design_machine(&late).unwrap_err();
        let DesignError::Table(DigitiseError::MatchedDelay { slowest, found, .. }) = &error else {
            panic!("{error}");
        };
        assert!(slowest == "b" && *found > f64::from(DELAY_MAX_SAMPLES), "{error}");
    }
}

/// Returns a stage of two to four axes.
fn some_stage() -> impl Strategy<Value = (Machine, f64)> {
    let kinds = prop::sample::select(vec!["zv", "zvd", "ei", "ps-zv", "um-zvd", "two-hump-ei", "none"]);
    let methods = prop::sample::select(vec!["modal", "linear", "nearest"]);
    let axes = prop::collection::vec((kinds, 15.0..1000.0f64, 0.0..0.2f64), 2..5);
    (methods, axes, 0.0..0.01f64).prop_map(|(method, axes, extra_delay_s)| {
        let stage = format!("[stage]\nextra_delay_s = {extra_delay_s:?}\n");
        (machine(method, &axes, &stage), extra_delay_s)
    })
}

proptest! {
    #[test]
    fn prop_totals_are_equal_and_rounding_leaves_what_it_may((machine, extra_delay_s) in some_stage()) {
        let design = design_machine(&machine).unwrap();
        let alone = design_machine(&Machine { stage: None, ..machine.clone() }).unwrap();
        let stage = design.stage.unwrap();
        let mut largest_rounding_s = 0.0f64;
        let mut slowest_s = 0.0f64;
        for (axis, alone) in design.axes.iter().zip(&alone.axes) {
            // Before rounding, the taps count, not the printed figures.
            let own_s = alone.digitised.mean_delay_samples() / 1e4 + axis.delay.mode_lag_s;
            let real_s = axis.digitised.mean_delay_samples() / 1e4 + axis.delay.mode_lag_s;
            slowest_s = slowest_s.max(own_s);
            prop_assert!((real_s - stage.total_s).abs() < 1e-9, "{} {}", real_s, stage.total_s);
            prop_assert!(axis.delay.added_samples >= 0.0);
            // After rounding.
            let taps = axis.digitised.taps.as_slice();
            let span = f64::from(taps[taps.len() - 1].delay_samples - taps[0].delay_samples);
            let bound_s = 0.5 * span * axis.quantising_error() / 1e4 + 1e-15;
            let table_s = axis.table.mean_delay_samples() / 1e4 + axis.delay.mode_lag_s;
            prop_assert!((table_s - stage.total_s).abs() <= bound_s + 1e-12, "{} {}", table_s - stage.total_s, bound_s);
            prop_assert!((axis.delay.total_s() - table_s).abs() < 1e-12);
            largest_rounding_s = largest_rounding_s.max(axis.delay.rounding_s.abs());
            let sum: i64 = axis.table.taps().iter().map(|tap| i64::from(tap.coefficient)).sum();
            prop_assert_eq!(sum, 1i64 << design.coefficient_fraction);
        }
        prop_assert!((stage.total_s - slowest_s - extra_delay_s).abs() < 1e-12);
        prop_assert!(stage.mismatch_s >= 0.0 && stage.mismatch_s <= 2.0 * largest_rounding_s + 1e-12);
    }

    #[test]
    fn prop_the_delay_makes_no_residual_worse_than_rounding_does((machine, _) in some_stage(), ratio in 0.5..2.0f64) {
        let design = design_machine(&machine).unwrap();
        let alone = design_machine(&Machine { stage: None, ..machine.clone() }).unwrap();
        for ((axis, tables), alone) in machine.axes.iter().zip(&design.axes).zip(&alone.axes) {
            // This holds at the mode and beside it: (1 − f, f) has a gain of at most 1 for every mode.
            for mode in [axis.modes[0].mode, axis.modes[0].mode.scaled(ratio)] {
                let [later, before] = [tables, alone].map(|t| residual_vibration(&t.digitised.impulses(1e4), &mode));
                prop_assert!(later <= before + 1e-12, "{} {}", later, before);
            }
            let same_end = tables.digitised.taps.last().map(|t| t.delay_samples) == Some(tables.table.longest_delay_samples());
            let figures = tables.mode_figures(axis, 1e4).remove(0);
            if same_end {
                let before = residual_vibration(&alone.digitised.impulses(1e4), &figures.mode);
                prop_assert!(figures.residual_quantised <= before + tables.quantising_error() + 1e-12);
            }
        }
    }
}
