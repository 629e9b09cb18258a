//! Families of tap tables for modes that move: every value is covered, and a handover adds no more than its bound.

use proptest::prelude::*;
use std::f64::consts::PI;

use posicast_blocks::shaper::{MotionShaper, ShaperConfig, ShaperMotion, swap_how};
use posicast_machine::machine_file::{Machine, parse};
use posicast_machine::plan::{TableFamily, design_machine};
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::mode::Mode;

const SAMPLE_HZ: f64 = 10_000.0;
/// Speed of the command at which tables are handed over, at which rounding to words is negligible.
const WORDS_PER_SAMPLE: i64 = 100_000;

fn text(shaper: &str, family: &str, modes: &[String]) -> String {
    let modes: String = modes
        .iter()
        .map(|points| format!("[[axis.mode]]\nmoves_with = \"load\"\npoints = {points}\n"))
        .collect();
    format!(
        "name = \"m\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\ncounts_per_unit = 1000\n\
         [axis.shaper]\n{shaper}\n{family}\n{modes}"
    )
}

fn machine(shaper: &str, family: &str, modes: &[String]) -> Machine {
    parse("m.toml", &text(shaper, family, modes)).unwrap()
}

fn family(machine: &Machine) -> TableFamily {
    design_machine(machine).unwrap().families.remove(0)
}

/// Returns the largest residual of the integer table of index `chosen`, relative to the tolerance plus the allowance
/// for rounding.
fn excess(machine: &Machine, family: &TableFamily, chosen: usize, value: f64) -> f64 {
    let axis = &machine.axes[0];
    let tables = &family.members[chosen].tables;
    let taps = tap_impulses(&tables.table, SAMPLE_HZ);
    let designed = family.members[chosen].value;
    let modes = axis.modes.iter().map(|mode| {
        let tolerance = axis.shaped().tolerance_of(mode) * (1.0 + 1e-6) + tables.quantising_error();
        // An EI kind reaches its tolerance at its own value already.
        let allowed = tolerance.max(1.1 * residual_vibration(&taps, &mode.at(designed)));
        assert!(allowed <= 1.1 * tolerance);
        residual_vibration(&taps, &mode.at(value)) / allowed
    });
    modes.fold(0.0, f64::max)
}

/// An undamped ZV leaves `|cos(π/2 · f/f₀)|`, so that 5 % are reached at 1 ± (2/π)·asin 0.05 of its frequency.
#[test]
fn golden_tables_of_zv_cover_what_its_closed_form_says() {
    let points = ["[[0.0, 50.0, 0.0], [1.0, 40.0, 0.0]]".to_owned()];
    let family = family(&machine("kind = \"zv\"", "", &points));
    let half_width = 2.0 / PI * 0.05f64.asin();
    for member in &family.members {
        let designed_hz = 50.0 - 10.0 * member.value;
        let hz = member.covers.map(|value| 50.0 - 10.0 * value);
        let ends = [(1.0 + half_width) * designed_hz, (1.0 - half_width) * designed_hz];
        // Two taps for an impulse between samples, and rounding, widen the band slightly.
        assert!((hz[0] - ends[0].min(50.0)).abs() < 0.02, "{hz:?} instead of {ends:?}");
        assert!((hz[1] - ends[1].max(40.0)).abs() < 0.02, "{hz:?} instead of {ends:?}");
    }
    // Downwards from 50 Hz, each next table begins 0.15 of half a band before the end of the previous one.
    let reached = |tables: f64| 50.0 * ((1.0 - half_width) / (1.0 + half_width)).powf(tables);
    let count = family.members.len() as f64;
    assert!(reached(count) < 40.0 && reached(count - 2.0) > 40.0, "{count} tables");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prop_at_every_value_the_chosen_table_is_within_tolerance(
        kind in prop::sample::select(vec!["zv", "zvd", "ei", "two-hump-ei", "mzv", "ps-zvd", "um-zv"]),
        ends_hz in (15.0..60.0f64, 15.0..60.0f64),
        bend in 0.2..0.8f64,
        dampings in (0.0..0.1f64, 0.0..0.1f64),
        second in prop::option::of(70.0..120.0f64),
        nominal in 0.0..1.0f64,
    ) {
        let (low, high) = ends_hz;
        let mut modes = vec![format!(
            "[[-1.0, {low}, {}], [{bend}, {}, {}], [3.0, {high}, {}]]",
            dampings.0, f64::midpoint(low, high), dampings.1, dampings.1
        )];
        modes.extend(second.map(|hz| format!("[[-1.0, {hz}, {}], [3.0, {}, 0.01]]", dampings.1, hz * 1.1)));
        let nominal = -1.0 + 4.0 * nominal;
        let machine = machine(&format!("kind = \"{kind}\""), &format!("[axis.family]\nnominal = {nominal}"), &modes);
        let family = family(&machine);
        prop_assert_eq!(family.members[family.nominal].value, nominal);
        let design = design_machine(&machine).unwrap();
        prop_assert_eq!(&design.axes[0].table, &family.members[family.nominal].tables.table);
        let steps = 2000;
        let values: Vec<f64> = (0..=steps).map(|step| -1.0 + 4.0 * f64::from(step) / f64::from(steps)).collect();
        let mut now = family.choose(family.nominal, -1.0);
        for value in values.iter().chain(values.iter().rev()) {
            let next = family.choose(now, *value);
            prop_assert!(next.abs_diff(now) <= 1, "from table {now} to {next} at {value}");
            now = next;
            let excess = excess(&machine, &family, now, *value);
            prop_assert!(excess <= 1.0, "table {now} at {value}: {excess} of the tolerance");
        }
    }

    /// The mode does not move here, so that the bound is exact; both ends of the ramp and the handover contribute to
    /// the ringing.
    #[test]
    fn prop_a_handover_adds_no_more_than_its_bound(
        kind in prop::sample::select(vec!["zv", "zvd", "ei"]),
        part in 0.0..1.0f64,
        pair in 0usize..64,
        change in 600usize..1400,
        rest in 600usize..1000,
    ) {
        let end = change + rest;
        let points = ["[[0.0, 60.0, 0.0], [1.0, 30.0, 0.0]]".to_owned()];
        let machine = machine(&format!("kind = \"{kind}\""), "", &points);
        let family = family(&machine);
        let from = pair % (family.members.len() - 1);
        let [low, high] = [family.members[from + 1].covers[0], family.members[from].covers[1]];
        let mode = machine.axes[0].modes[0].at(low + part * (high - low));
        let rung = ringing(&family, from, change, end, &mode);
        let bound = bound(&family, from, &mode);
        prop_assert!(rung <= bound * (1.0 + 1e-3) + 50.0, "{rung} words, bound {bound}");
    }
}

/// Returns the ringing at rest, in words, after a ramp that begins with one table, is handed over, and ends with the
/// next.
fn bound(family: &TableFamily, from: usize, mode: &Mode) -> f64 {
    let of_ends = [from, from + 1].map(|index| {
        let taps = tap_impulses(&family.members[index].tables.table, SAMPLE_HZ);
        residual_vibration(&taps, mode) / mode.omega_damped()
    });
    let added = family.handover_bound_s(from, from + 1, mode, SAMPLE_HZ);
    WORDS_PER_SAMPLE as f64 * SAMPLE_HZ * (of_ends[0] + added + of_ends[1])
}

/// Returns the amplitude in words, at rest, after a ramp that began with one table, was handed over to the next at
/// `change`, and ended at `end`.
fn ringing(family: &TableFamily, from: usize, change: usize, end: usize, mode: &Mode) -> f64 {
    let plant = Plant::new(&[(*mode, 1.0)]).unwrap();
    let tables = |index: usize| family.members[index].tables.table.clone();
    let config = ShaperConfig::new(32, tables(from)).unwrap();
    let config = config
        .with_room_for(family.longest_delay_samples(), family.most_taps())
        .unwrap();
    let motion = ShaperMotion {
        channels: 1,
        modulo: false,
    };
    let mut shaper = MotionShaper::new(&config.for_motion(motion).unwrap());
    let mut machine = SampledPlant::new(&plant, 1.0 / SAMPLE_HZ, 0.0);
    for n in 0..end + 1000 {
        if n == change {
            shaper.swap(&tables(from + 1), swap_how::HANDOVER).unwrap();
        }
        let [y, ..] = shaper.push([n.min(end) as i64 * WORDS_PER_SAMPLE, 0, 0]);
        machine.step(y as f64);
    }
    machine.vibration()
}

/// A bound that is never approached says little: over the phases of the change, the largest ringing is close to it.
#[test]
fn the_bound_of_a_handover_is_nearly_reached() {
    let points = ["[[0.0, 60.0, 0.0], [1.0, 30.0, 0.0]]".to_owned()];
    let machine = machine("kind = \"zv\"", "", &points);
    let family = family(&machine);
    let mode = machine.axes[0].modes[0].at(family.members[0].up);
    let phases = (1000..1200)
        .step_by(9)
        .flat_map(|change| (2000..2200).step_by(9).map(move |end| (change, end)));
    let largest = phases.map(|(change, end)| ringing(&family, 0, change, end, &mode));
    let largest = largest.fold(0.0, f64::max);
    let bound = bound(&family, 0, &mode);
    assert!((0.9..=1.0).contains(&(largest / bound)), "{largest} of {bound}");
}

#[test]
fn values_that_leave_a_gap_are_refused_with_those_that_do_not() {
    let points = ["[[0.0, 60.0, 0.05], [5.0, 40.0, 0.04]]".to_owned()];
    let refused = machine("kind = \"zv\"", "[axis.family]\nvalues = [0.0, 5.0]", &points);
    let error = design_machine(&refused).unwrap_err().to_string();
    let start = "axis x: no table keeps the residual within the tolerance from ";
    assert!(
        error.starts_with(start) && error.contains("7 tables cover all points: values = ["),
        "{error}"
    );
    let values = error.split("values = ").nth(1).unwrap();
    let accepted = machine("kind = \"zv\"", &format!("[axis.family]\nvalues = {values}"), &points);
    assert_eq!(family(&accepted).members.len(), 7);
}

#[test]
fn a_family_beyond_the_tables_of_a_driver_is_refused() {
    let points = ["[[0.0, 60.0, 0.0], [5.0, 20.0, 0.0]]".to_owned()];
    let machine = machine("kind = \"zv\"\ntolerance = 0.001", "", &points);
    let error = design_machine(&machine).unwrap_err().to_string();
    assert_eq!(error, "axis x: more than 64 tables would be needed to cover all points");
}

#[test]
fn files_that_contradict_themselves_are_refused() {
    let mode = |keys: &str| format!("[[axis.mode]]\n{keys}\n");
    let refused = |shaper: &str, rest: &str| {
        let text = text(&format!("kind = \"{shaper}\""), rest, &[]);
        parse("m.toml", &text).unwrap_err().to_string()
    };
    let moving = mode("moves_with = \"load\"\npoints = [[0, 60, 0.1], [5, 40, 0.1]]");
    let cases = [
        (
            "zv",
            mode("moves_with = \"load\"\npoints = [[0, 60, 0.1]]"),
            "found one row",
        ),
        ("zv", mode("points = [[0, 60, 0.1], [5, 40, 0.1]]"), "moves_with"),
        (
            "zv",
            mode("moves_with = \"load\"\nfrequency_hz = 5\ndamping = 0"),
            "a variable without `points`",
        ),
        (
            "zv",
            mode("moves_with = \"load\"\npoints = [[0, 60, 0.1], [0, 40, 0.1]]"),
            "the value 0 after 0",
        ),
        (
            "zv",
            mode("moves_with = \"load\"\npoints = [[0, 60, 0.1], [5, 40, 1.1]]"),
            "damping 1.1 in row 2",
        ),
        (
            "zv",
            mode("moves_with = \"load\"\npoints = [[0, 60, 0.1], [5, 6000, 0.1]]"),
            "6000 Hz in row 2",
        ),
        (
            "zv",
            mode("moves_with = \"load\"\npoints = [[0, 60], [5, 40]]"),
            "a list of 1 to 64 rows [value, frequency_hz, damping]",
        ),
        (
            "zv",
            mode("moves_with = \"load\"\ndamping = 0.1\npoints = [[0, 60, 0.1], [5, 40, 0.1]]"),
            "both `points` and `damping`",
        ),
        ("none", moving.clone(), "shaper \"none\" with a mode that moves"),
        (
            "zv",
            format!("[axis.family]\nnominal = 1\n{}", mode("frequency_hz = 5\ndamping = 0")),
            "a family without a mode that moves",
        ),
        ("zv", format!("[axis.family]\nnominal = 6\n{moving}"), "found 6"),
        (
            "zv",
            format!("[axis.family]\nvalues = [0, 3]\nnominal = 1\n{moving}"),
            "nominal = 1, which is not in `values`",
        ),
        (
            "zv",
            format!("[axis.family]\nvalues = [3, 0]\n{moving}"),
            "found 0 after 3",
        ),
        (
            "zv",
            format!(
                "{moving}{}",
                mode("moves_with = \"height\"\npoints = [[0, 90, 0.1], [5, 80, 0.1]]")
            ),
            "allowed: \"load\", with which another mode of the axis moves",
        ),
        (
            "zv",
            format!(
                "{moving}{}",
                mode("moves_with = \"load\"\npoints = [[0, 90, 0.1], [4, 80, 0.1]]")
            ),
            "found values 0 to 4; allowed: values 0 to 5, as of another mode of the axis",
        ),
        (
            "zv",
            format!(
                "modulo = true\n[axis.limits]\ntravel = [0, 1]\n{}",
                mode("moves_with = \"position\"\npoints = [[0, 60, 0.1], [1, 40, 0.1]]")
            ),
            "modulo",
        ),
        (
            "zv",
            format!(
                "[axis.limits]\ntravel = [0, 2]\n{}",
                mode("moves_with = \"position\"\npoints = [[0, 60, 0.1], [1, 40, 0.1]]")
            ),
            "beyond the points of a mode",
        ),
    ];
    for (shaper, rest, expected) in cases {
        let error = refused(shaper, &rest);
        assert!(
            error.contains(expected),
            "expected {expected:?} of\n{rest}\nfound: {error}"
        );
    }
}

/// For slight damping the humps of a two-hump EI exceed the tolerance by a few thousandths, and a table covers less than its neighbour
/// without damping.
#[test]
fn tables_of_very_different_reach_still_overlap() {
    for damping in [0.01, 0.02, 0.03, 0.0404] {
        let points = [format!(
            "[[-1.0, 20.6, {damping}], [0.2, 35.45, 0.0], [3.0, 50.3, 0.0]]"
        )];
        let machine = machine("kind = \"two-hump-ei\"", "[axis.family]\nnominal = 2.5036", &points);
        let family = family(&machine);
        let covers: Vec<[f64; 2]> = family.members.iter().map(|member| member.covers).collect();
        assert_eq!((covers[0][0], covers[covers.len() - 1][1]), (-1.0, 3.0), "{covers:?}");
        assert!(
            covers.is_sorted_by(|one, next| next[0] < one[1] && one[1] < next[1]),
            "{covers:?}"
        );
    }
}
