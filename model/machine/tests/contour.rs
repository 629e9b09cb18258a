//! Contours: geometry, limits along the path, and the errors of the notes on the XY stage.

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

use posicast_machine::contour::{
    Contour, ContourLimits, ContourRow, CornerRules, FREQUENCY_FACTORS, PlanePoint, Shape, Stroke, compare, follow,
    shapes,
};
use posicast_machine::machine_file::{Machine, StageSection, parse};
use posicast_machine::plan::design_machine;
use posicast_machine::unit::AxisUnit;

const XY: &str = include_str!("../../../examples/xy-stage.toml");
const SAMPLE_S: f64 = 1e-4;
const LIMITS: ContourLimits = ContourLimits {
    velocity: 0.25,
    acceleration: 8.0,
    jerk: 400.0,
};

fn contour(strokes: &[Stroke]) -> Contour {
    Contour::new(strokes, &LIMITS, &CornerRules::default()).unwrap()
}

fn near(found: PlanePoint, expected: PlanePoint) -> bool {
    (found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12
}

fn compared(machine: &Machine, strokes: &[Stroke]) -> Vec<ContourRow> {
    let mut strokes = strokes.iter().copied().map(Ok);
    compare(machine, &mut strokes, &CornerRules::default(), &mut |_| ()).unwrap()
}

/// Returns a machine of the XY stage with this kind of shaper, with equal delays or with each axis's own.
fn stage(kind: &str, matched: bool) -> Machine {
    let machine = parse(
        "xy-stage.toml",
        &XY.replace("kind = \"zvd\"", &format!("kind = \"{kind}\"")),
    )
    .unwrap();
    let stage = StageSection {
        extra_delay_s: 0.0,
        contour_speed: None,
        arrive_together: false,
    };
    Machine {
        stage: matched.then_some(stage),
        ..machine
    }
}

/// Section 6 of the notes on the XY stage has a circle of 10 mm at 100 mm/s. The unshaped stage leaves 9.17 um, ZV
/// 37.97, ZVD 71.06; with equal delays of the axes ZV leaves 0.69 and ZVD 4.2. The notes' shapers are exact, and their
/// command is not sampled.
#[test]
fn golden_a_circle_of_the_xy_stage_has_the_errors_of_the_notes() {
    let circle = shapes::circle(0.01, 0.1).unwrap();
    for (kind, matched, expected_um) in [
        ("none", false, 9.17),
        ("zv", false, 37.97),
        ("zvd", false, 71.06),
        ("zv", true, 0.69),
        ("zvd", true, 4.2),
    ] {
        let machine = stage(kind, matched);
        let design = design_machine(&machine).unwrap();
        let followed = follow(&machine, &design, &circle, &CornerRules::default(), 1.0).unwrap();
        let steady = followed.steady.unwrap();
        let found_um = 1e6 * steady.peak;
        assert!(
            (found_um - expected_um).abs() < 0.005 * expected_um + 0.05,
            "{kind} {matched}: {found_um} um, {expected_um} expected"
        );
        assert!(followed.error.unwrap().peak >= steady.peak && followed.rapid.is_none());
    }
}

/// The formula of the notes: the error is about v |d_x - d_y| / 2.
#[test]
fn golden_the_error_of_a_circle_is_half_of_what_the_delays_differ_by() {
    let circle = shapes::circle(0.01, 0.1).unwrap();
    let machine = stage("zvd", false);
    let design = design_machine(&machine).unwrap();
    let [x, y] = [0, 1].map(|axis: usize| design.axes[axis].delay.total_s());
    let steady = follow(&machine, &design, &circle, &CornerRules::default(), 1.0)
        .unwrap()
        .steady
        .unwrap();
    let expected = 0.1 * (x - y).abs() / 2.0;
    assert!(
        (steady.peak - expected).abs() < 0.08 * expected,
        "{} {expected}",
        steady.peak
    );
}

/// Equal delays gain more than any kind; a machine that deviates by 20 % in the worse direction leaves more error
/// than the nominal one.
#[test]
fn kinds_are_compared_with_own_and_with_equal_delays() {
    let circle = shapes::circle(0.01, 0.1).unwrap();
    let rows = compared(&stage("zvd", false), &circle);
    let kinds: Vec<(&str, bool, bool)> = rows
        .iter()
        .map(|row| (row.kind.as_str(), row.in_file, row.matched))
        .collect();
    let expected = [("zvd", true), ("none", false), ("zv", false), ("ei", false)];
    let expected: Vec<_> = expected
        .iter()
        .flat_map(|(kind, own)| [false, true].map(|matched| (*kind, *own, matched)))
        .collect();
    assert_eq!(kinds, expected);
    let peak = |row: usize, factor: usize| rows[row].followed.as_ref().unwrap()[factor].error.unwrap().peak;
    assert_eq!(FREQUENCY_FACTORS[2], 1.0);
    for kind in 0..4 {
        assert!(3.0 * peak(2 * kind + 1, 2) < peak(2 * kind, 2), "{kind}");
        assert!(
            peak(2 * kind + 1, 2) < peak(2 * kind + 1, 0).max(peak(2 * kind + 1, 4)),
            "{kind}"
        );
    }
}

#[test]
fn lengths_places_and_directions_of_a_square_and_a_circle() {
    let square = *contour(&shapes::square(0.02, 0.1).unwrap()).survey();
    assert!((square.length - 0.08).abs() < 1e-15);
    assert_eq!((square.stops, square.extent), (3, [[0.0, 0.02], [0.0, 0.02]]));
    let circle = *contour(&shapes::circle(0.01, 0.1).unwrap()).survey();
    assert!((circle.length - TAU * 0.01).abs() < 1e-15);
    assert_eq!(circle.stops, 0);
    let [[left, right], [below, above]] = circle.extent;
    assert!((left + 0.02).abs() + right.abs() + (below + 0.01).abs() + (above - 0.01).abs() < 1e-15);
}

#[test]
fn points_are_read_in_the_units_of_the_axes() {
    let millimetres = AxisUnit::Millimetre;
    let read = |text: &str, units: [AxisUnit; 2]| {
        let lines = shapes::Points::new(Box::new(text.as_bytes()), units, 0.1).unwrap();
        lines.collect::<Result<Vec<Stroke>, _>>()
    };
    let metres = [AxisUnit::default(); 2];
    let text = "\u{feff}x,y\r\n# none\r\n0, 0\r\n1;2\n1,2\n3\t4 # on\n0,0";
    for (units, factors) in [
        (metres, [1.0, 1.0]),
        ([millimetres; 2], [1e-3, 1e-3]),
        ([millimetres, metres[0]], [1e-3, 1.0]),
    ] {
        let ends: Vec<PlanePoint> = read(text, units)
            .unwrap()
            .iter()
            .map(|line| line.shape.at(line.shape.length()))
            .collect();
        let expected = [[1.0, 2.0], [3.0, 4.0], [0.0, 0.0]].map(|[x, y]| [x * factors[0], y * factors[1]]);
        assert!(
            ends.len() == 3
                && ends
                    .iter()
                    .zip(expected)
                    .all(|(found, expected)| near(*found, expected)),
            "{ends:?}"
        );
    }
    for (text, line) in [
        ("0,0\n1,nan\n", 2),
        ("x,y\nx,y\n", 2),
        ("0,0,0\n", 1),
        ("0,0\n1\n", 2),
        ("0,0\n1,2,\n", 2),
        ("x\n", 1),
    ] {
        let error = read(text, metres).unwrap_err().to_string();
        assert!(error.starts_with(&format!("line {line}: `")), "{text}: {error}");
    }
    for nothing in ["# nothing\n", "1,1\n1,1\n", ""] {
        assert_eq!(read(nothing, metres).unwrap(), []);
    }
    assert!(shapes::polyline(&[[0.0, 0.0], [0.0, 0.0]], 0.1).is_err());
    assert!(shapes::circle(f64::NAN, 0.1).is_err() && shapes::square(1.0, 0.0).is_err());
}

#[test]
fn a_path_beyond_the_travel_is_refused() {
    let machine = stage("zv", false);
    let error = contour(&shapes::circle(0.06, 0.1).unwrap())
        .survey()
        .check_travel(&machine)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "axis x would go to -120 mm; its travel is -100 mm to 100 mm"
    );
    assert_eq!(
        contour(&shapes::circle(0.04, 0.1).unwrap())
            .survey()
            .check_travel(&machine),
        Ok(())
    );
}

/// Returns paths of lines and arcs with gentle and sharp bends.
fn paths() -> impl Strategy<Value = Vec<Stroke>> {
    let turn = prop_oneof![-0.1..0.1f64, -3.0..3.0f64];
    let leg = (1e-3..0.05f64, turn, prop::option::of((2e-3..0.05f64, -5.0..5.0f64)));
    prop::collection::vec(leg, 1..8).prop_map(|legs| {
        let (mut at, mut direction) = ([0.0, 0.0], 0.0f64);
        let mut strokes = Vec::new();
        for (length, turn, arc) in legs {
            direction += turn;
            let (sin, cos) = direction.sin_cos();
            let to = [at[0] + length * cos, at[1] + length * sin];
            let mut add = |shape| strokes.push(Stroke::feed(shape, 0.15));
            add(Shape::Line { from: at, to });
            at = to;
            if let Some((radius, sweep)) = arc.filter(|(_, sweep)| sweep.abs() > 0.01) {
                let side = sweep.signum();
                let begin = direction - side * FRAC_PI_2;
                let centre = [at[0] - radius * begin.cos(), at[1] - radius * begin.sin()];
                let shape = Shape::Arc {
                    centre,
                    radius,
                    begin,
                    sweep,
                };
                add(shape);
                at = shape.at(shape.length());
                direction += sweep;
            }
        }
        strokes
    })
}

/// Returns the place at a distance along a path.
fn place(strokes: &[Stroke], mut along: f64) -> PlanePoint {
    for stroke in strokes {
        let length = stroke.shape.length();
        if along <= length {
            return stroke.shape.at(along);
        }
        along -= length;
    }
    let last = strokes.last().unwrap().shape;
    last.at(last.length())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn prop_the_command_is_on_the_path_and_within_the_limits(strokes in paths()) {
        let contour = contour(&strokes);
        let samples = contour.samples(SAMPLE_S, 0.01).unwrap();
        let last = samples.last().unwrap();
        let end = strokes.last().unwrap().shape;
        prop_assert!((last.along - contour.survey().length).abs() < 1e-9);
        prop_assert!(near(last.at, end.at(end.length())));
        for sample in &samples {
            prop_assert!(near(sample.at, place(&strokes, sample.along)), "{sample:?}");
            prop_assert!(sample.speed <= 0.15 * (1.0 + 1e-6) + 1e-9, "{}", sample.speed);
        }
        // Samples beside joints are left out, where a line meets an arc or a bend; the tolerance covers rounding in
        // the differences.
        let joints: Vec<f64> = strokes.iter().scan(0.0, |along, stroke| { *along += stroke.shape.length(); Some(*along) }).collect();
        for window in samples.windows(4) {
            let reach = [window[0].along - 1e-9, window[3].along + 1e-9];
            if joints.iter().any(|joint| (reach[0]..=reach[1]).contains(joint)) {
                continue;
            }
            let difference = |weights: [f64; 4]| {
                let of = |axis: usize| (0..4).map(|k| weights[k] * window[k].at[axis]).sum::<f64>();
                of(0).hypot(of(1))
            };
            let acceleration = difference([1.0, -2.0, 1.0, 0.0]) / SAMPLE_S.powi(2);
            let jerk = difference([-1.0, 3.0, -3.0, 1.0]) / SAMPLE_S.powi(3);
            prop_assert!(acceleration <= LIMITS.acceleration * 1.001, "{acceleration}");
            prop_assert!(jerk <= LIMITS.jerk * 1.01, "{jerk}");
        }
    }

    #[test]
    fn prop_the_nearest_place_of_a_stroke_is_nearer_than_all_others(strokes in paths(), x in -0.05..0.1f64, y in -0.05..0.1f64) {
        for Stroke { shape, .. } in strokes {
            let away = |along: f64| {
                let at = shape.at(along);
                (at[0] - x).hypot(at[1] - y)
            };
            let nearest = away(shape.nearest([x, y]));
            for step in 0..=200 {
                let other = away(shape.length() * f64::from(step) / 200.0);
                prop_assert!(nearest <= other + 1e-12, "{shape:?} {nearest} {other}");
            }
        }
    }
}
