//! Contours: geometry, limits along the path, G-code, and the errors of the notes on the XY stage.

use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use posicast_model::contour::{
    Contour, ContourLimits, FREQUENCY_FACTORS, PlanePoint, Shape, Stroke, compare, follow, gcode, shapes,
};
use posicast_model::design::design_machine;
use posicast_model::machine_file::{Machine, StageSection, parse};
use posicast_model::unit::AxisUnit;

const XY: &str = include_str!("../../examples/xy-stage.toml");
const SAMPLE_S: f64 = 1e-4;
const LIMITS: ContourLimits = ContourLimits {
    velocity: 0.25,
    acceleration: 8.0,
    jerk: 400.0,
};

fn contour(strokes: &[Stroke]) -> Contour {
    Contour::new(strokes, &LIMITS, SAMPLE_S).unwrap()
}

fn program(text: &str) -> Vec<Stroke> {
    gcode::strokes(text).unwrap()
}

fn near(found: PlanePoint, expected: PlanePoint) -> bool {
    (found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12
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
    let circle = contour(&shapes::circle(0.01, 0.1).unwrap());
    for (kind, matched, expected_um) in [
        ("none", false, 9.17),
        ("zv", false, 37.97),
        ("zvd", false, 71.06),
        ("zv", true, 0.69),
        ("zvd", true, 4.2),
    ] {
        let machine = stage(kind, matched);
        let design = design_machine(&machine).unwrap();
        let followed = follow(&machine, &design, &circle, 1.0).unwrap();
        let steady = followed.steady.unwrap();
        let found_um = 1e6 * steady.peak;
        assert!(
            (found_um - expected_um).abs() < 0.005 * expected_um + 0.05,
            "{kind} {matched}: {found_um} um, {expected_um} expected"
        );
        assert!(followed.error.peak >= steady.peak);
    }
}

/// The formula of the notes: the error is about v |d_x - d_y| / 2.
#[test]
fn golden_the_error_of_a_circle_is_half_of_what_the_delays_differ_by() {
    let circle = contour(&shapes::circle(0.01, 0.1).unwrap());
    let machine = stage("zvd", false);
    let design = design_machine(&machine).unwrap();
    let [x, y] = [0, 1].map(|axis: usize| design.axes[axis].delay.total_s());
    let steady = follow(&machine, &design, &circle, 1.0).unwrap().steady.unwrap();
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
fn unit_kinds_are_compared_with_own_and_with_equal_delays() {
    let circle = contour(&shapes::circle(0.01, 0.1).unwrap());
    let rows = compare(&stage("zvd", false), &circle).unwrap();
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
    let peak = |row: usize, factor: usize| rows[row].errors.as_ref().unwrap()[factor].peak;
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
fn unit_lengths_places_and_directions_of_a_square_and_a_circle() {
    let square = contour(&shapes::square(0.02, 0.1).unwrap());
    assert!((square.length() - 0.08).abs() < 1e-15);
    assert_eq!((square.stops(), square.extent()), (3, [[0.0, 0.02], [0.0, 0.02]]));
    let circle = contour(&shapes::circle(0.01, 0.1).unwrap());
    assert!((circle.length() - TAU * 0.01).abs() < 1e-15);
    assert_eq!(circle.stops(), 0);
    let [[left, right], [below, above]] = circle.extent();
    assert!((left + 0.02).abs() + right.abs() + (below + 0.01).abs() + (above - 0.01).abs() < 1e-15);
    // A point 1 mm outside the circle is to the right of a counter-clockwise path.
    assert!((circle.distance([0.001, 0.0], 0.0, 0.01) + 0.001).abs() < 1e-15);
    assert!((circle.distance([-0.01, 0.009], 0.0, 0.07) - 0.001).abs() < 1e-15);
}

#[test]
fn unit_a_program_is_read_as_its_lines_and_arcs() {
    let strokes = program(
        "%\n(a part)\nG21 G90 G17\nG0 X10 Y0\nG1 X20 F600 ; on\nY10\nG3 X10 Y20 I-10 J0\nG2 X0 Y10 R10\nG91\nG1 X-1.23456789\nG4 P1\nG20 X0.1\nM30\n",
    );
    let shapes: Vec<Shape> = strokes.iter().map(|stroke| stroke.shape).collect();
    assert_eq!(
        shapes[0],
        Shape::Line {
            from: [0.0, 0.0],
            to: [0.01, 0.0]
        }
    );
    assert!(strokes[0].speed.is_infinite() && (strokes[1].speed - 0.01).abs() < 1e-15);
    assert_eq!(
        shapes[2],
        Shape::Line {
            from: [0.02, 0.0],
            to: [0.02, 0.01]
        }
    );
    let Shape::Arc {
        centre, radius, sweep, ..
    } = shapes[3]
    else {
        panic!("{shapes:?}")
    };
    assert!(near(centre, [0.01, 0.01]) && (radius - 0.01).abs() < 1e-15 && (sweep - FRAC_PI_2).abs() < 1e-12);
    let Shape::Arc { centre, sweep, .. } = shapes[4] else {
        panic!("{shapes:?}")
    };
    assert!(near(centre, [0.01, 0.01]) || near(centre, [0.0, 0.02]), "{centre:?}");
    assert!((sweep + FRAC_PI_2).abs() < 1e-9, "{sweep}");
    let Shape::Line { to, .. } = shapes[5] else {
        panic!("{shapes:?}")
    };
    // All digits of the text are read.
    assert!(near(to, [-1.23456789e-3, 0.01]), "{to:?}");
    assert!(strokes[6].after_stop && !strokes[5].after_stop);
    assert!((shapes[6].length() - 2.54e-3).abs() < 1e-15);
    // A whole turn, and the longer of two arcs.
    let Shape::Arc { sweep, .. } = program("G2 I5 F60")[0].shape else {
        panic!()
    };
    assert!((sweep + TAU).abs() < 1e-12);
    let Shape::Arc { sweep, .. } = program("G3 X0 Y10 R-10 F60")[0].shape else {
        panic!()
    };
    assert!((sweep - 5.0 * PI / 3.0).abs() < 1e-9, "{sweep}");
}

#[test]
fn unit_programs_that_cannot_be_driven_are_refused_at_their_line() {
    for (text, line, found) in [
        ("G21\nX5", 2, "a place before the first"),
        ("G1 X5", 1, "G1 without a feed"),
        ("G1 X5 F0", 1, "F0"),
        ("G21\n\nG28 X0", 3, "G28 is not read"),
        ("G18", 1, "G18 is not read"),
        ("G1 X5 A90 F60", 1, "`A` is not read"),
        ("G2 X10 Y0 F60", 1, "an arc without I, J or R"),
        (
            "G2 X10 Y0 R4 F60",
            1,
            "an arc of radius 4.0000 mm to a place 10.0000 mm away",
        ),
        (
            "G2 X10 Y0 I4 F60",
            1,
            "an arc whose beginning is 4.0000 mm from its centre, and its end 6.0000 mm",
        ),
        ("G2 X10 Y0 I0 J0 F60", 1, "an arc whose beginning is 0.0000 mm"),
        ("G38.2 X1", 1, "G38.2 is not read"),
    ] {
        let error = gcode::strokes(text).unwrap_err().to_string();
        assert!(error.starts_with(&format!("line {line}: {found}")), "{text}: {error}");
    }
    for text in ["", "M3 S1000\nM30", "G1 F60\nZ5"] {
        let error = gcode::strokes(text).unwrap_err().to_string();
        assert_eq!(error, "no path: the program moves neither X nor Y", "{text}");
    }
}

#[test]
fn unit_points_are_read_in_the_units_of_the_axes() {
    let units = [AxisUnit::default(); 2];
    let points = shapes::points("x,y\n# none\n0, 0\n1;2\n3\t4 # on\n", units).unwrap();
    assert_eq!(points, [[0.0, 0.0], [1.0, 2.0], [3.0, 4.0]]);
    for (text, line) in [("0,0\n1,nan\n", 2), ("x,y\nx,y\n", 2), ("0,0,0\n", 1), ("0,0\n1\n", 2)] {
        let error = shapes::points(text, units).unwrap_err().to_string();
        assert!(error.starts_with(&format!("line {line}: `")), "{text}: {error}");
    }
    assert!(shapes::points("# nothing\n", units).is_err());
    assert!(shapes::polyline(&[[0.0, 0.0], [0.0, 0.0]], 0.1).is_err());
    assert!(shapes::circle(f64::NAN, 0.1).is_err() && shapes::square(1.0, 0.0).is_err());
}

#[test]
fn unit_a_path_beyond_the_travel_is_refused() {
    let machine = stage("zv", false);
    let error = contour(&shapes::circle(0.06, 0.1).unwrap())
        .check_travel(&machine)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "axis x would go to -120 mm; its travel is -100 mm to 100 mm"
    );
    assert_eq!(
        contour(&shapes::circle(0.04, 0.1).unwrap()).check_travel(&machine),
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
            let mut add = |shape| {
                strokes.push(Stroke {
                    shape,
                    speed: 0.15,
                    after_stop: false,
                })
            };
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn prop_the_command_is_on_the_path_and_within_the_limits(strokes in paths()) {
        let contour = contour(&strokes);
        let samples = contour.samples(SAMPLE_S, 0.01).unwrap();
        let last = samples.last().unwrap();
        let end = strokes.last().unwrap().shape;
        prop_assert!((last.along - contour.length()).abs() < 1e-9);
        prop_assert!(near(last.at, end.at(end.length())));
        for sample in &samples {
            let distance = contour.distance(sample.at, sample.along - 1e-4, sample.along + 1e-4);
            prop_assert!(distance.abs() < 1e-9, "{distance}");
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
