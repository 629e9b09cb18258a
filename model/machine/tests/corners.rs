//! Bends of a path: facets of a circle take the time of the circle, and what is not a bend costs nothing.

use posicast_machine::contour::{
    Contour, ContourLimits, CornerRules, PlanePoint, Shape, Stroke, Survey, gcode, shapes,
};
use std::f64::consts::TAU;

/// The limits of the mill of the cases: 150 mm/s, 1500 mm/s², 50 m/s³.
const LIMITS: ContourLimits = ContourLimits {
    velocity: 0.15,
    acceleration: 1.5,
    jerk: 50.0,
};

fn survey(strokes: &[Stroke], rules: &CornerRules) -> Survey {
    Survey::new(&mut strokes.iter().copied().map(Ok), &LIMITS, rules).unwrap()
}

fn polyline(points: &[PlanePoint], speed: f64) -> Survey {
    survey(&shapes::polyline(points, speed).unwrap(), &CornerRules::default())
}

/// Points of a circle with `chords` chords, rounded to `digits` m.
fn ring(radius: f64, chords: u32, digits: f64) -> Vec<PlanePoint> {
    let round = |place: f64| (place / digits).round() * digits;
    (0..=chords)
        .map(|k| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(chords)).sin_cos();
            [round(0.15 + radius * cos), round(0.15 + radius * sin)]
        })
        .collect()
}

/// The case: 90 chords of a circle of 40 mm at 60 mm/s take 251.3 mm / 60 mm/s = 4.19 s, and the ramps.
#[test]
fn golden_ninety_chords_take_the_time_of_the_circle() {
    let found = polyline(&ring(0.04, 90, 1e-7), 0.06);
    assert!((found.duration_s - 4.3).abs() < 0.1, "{found:?}");
    assert_eq!(found.stops, 0);
}

#[test]
fn facets_take_the_time_of_their_circle_whatever_their_number() {
    for (radius, speed) in [(0.04, 0.06), (0.01, 0.1), (0.1, 0.15), (0.004, 0.15)] {
        let circle = survey(&shapes::circle(radius, speed).unwrap(), &CornerRules::default());
        for chords in [30, 36, 60, 90, 180, 360, 720, 3600, 36000] {
            // A bend is a corner, too, which junction deviation passes at a lower speed if it is sharp.
            let c = (TAU / f64::from(chords) / 2.0).cos();
            let corner = (LIMITS.acceleration * 1e-5 * c / (1.0 - c)).sqrt();
            let most = 1.06 * (speed / corner).max(1.0);
            for digits in [1e-6, 1e-7, 1e-9] {
                // Where chords are as short as the digits, the path is a staircase, and longer.
                if TAU * radius / f64::from(chords) < 10.0 * digits {
                    continue;
                }
                let found = polyline(&ring(radius, chords, digits), speed);
                let share = found.duration_s / circle.duration_s;
                assert!(
                    (0.93..most).contains(&share),
                    "{radius} {speed} {chords} {digits}: {share}"
                );
                assert_eq!(found.stops, 0);
            }
        }
    }
    // Of the case, 30 chords are hardly slower.
    let circle = survey(&shapes::circle(0.04, 0.06).unwrap(), &CornerRules::default());
    let coarse = polyline(&ring(0.04, 30, 1e-7), 0.06);
    assert!(coarse.duration_s < 1.1 * circle.duration_s, "{coarse:?}");
}

/// Points on a line, points that repeat, and points so close that rounding makes their direction, do not slow it down.
#[test]
fn points_on_a_line_cost_nothing() {
    let whole = polyline(&[[0.0, 0.0], [0.1, 0.05]], 0.06);
    for (step, noise) in [(1e-2, 0.0), (1e-4, 0.0), (3e-6, 1e-6), (1e-3, 1e-6), (1e-5, 1e-6)] {
        let count = (0.1 / step) as u32;
        let mut points: Vec<PlanePoint> = (0..=count)
            .map(|k| {
                let share = f64::from(k) / f64::from(count);
                let round = |place: f64| {
                    if noise > 0.0 {
                        (place / noise).round() * noise
                    } else {
                        place
                    }
                };
                [round(0.1 * share), round(0.05 * share)]
            })
            .collect();
        points.extend(points.last().copied());
        points.insert(1, points[0]);
        let found = polyline(&points, 0.06);
        // Steps of a micrometre make the path longer by up to a tenth.
        let share = found.duration_s / whole.duration_s * whole.length / found.length;
        assert!((share - 1.0).abs() < 0.03, "{step} {noise}: {share}");
        assert_eq!(found.stops, 0, "{step} {noise}");
    }
}

#[test]
fn a_reversal_and_a_sharp_corner_are_stops() {
    let there_and_back = polyline(&[[0.0, 0.0], [0.05, 0.0], [0.0, 0.0]], 0.06);
    let there = polyline(&[[0.0, 0.0], [0.05, 0.0]], 0.06);
    assert_eq!(there_and_back.stops, 1);
    assert!((there_and_back.duration_s - 2.0 * there.duration_s).abs() < 1e-9);
    let corner = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        [[0.0, 0.0], [0.05, 0.0], [0.05 + 0.05 * cos, 0.05 * sin]]
    };
    assert_eq!(polyline(&corner(46.0), 0.06).stops, 1);
    assert_eq!(polyline(&corner(44.0), 0.06).stops, 0);
    let octagon = polyline(&ring(0.04, 8, 1e-12), 0.06);
    assert_eq!(octagon.stops, 0, "45 degrees with a rounding error");
}

/// The speed at which a corner is passed is that of junction deviation: v² = a·δ·c/(1 − c), c = cos(θ/2).
#[test]
fn golden_corners_have_the_speed_of_junction_deviation() {
    for (degrees, tolerance) in [(30.0f64, 1e-5), (90.0, 1e-5), (90.0, 5e-5), (135.0, 2e-5)] {
        let c = (degrees / 2.0).to_radians().cos();
        let expected = (LIMITS.acceleration * tolerance * c / (1.0 - c)).sqrt();
        let (sin, cos) = degrees.to_radians().sin_cos();
        let points = [[0.0, 0.0], [0.05, 0.0], [0.05 + 0.05 * cos, 0.05 * sin]];
        let rules = CornerRules {
            tolerance,
            stop_angle: std::f64::consts::PI,
        };
        let strokes = shapes::polyline(&points, 0.06).unwrap();
        let contour = Contour::new(&strokes, &LIMITS, &rules).unwrap();
        assert_eq!(contour.survey().stops, 0);
        let samples = contour.samples(1e-5, 0.0).unwrap();
        let at_corner = samples
            .iter()
            .min_by(|a, b| (a.along - 0.05).abs().total_cmp(&(b.along - 0.05).abs()))
            .unwrap();
        assert!(
            (at_corner.speed - expected).abs() < 0.02 * expected,
            "{degrees}: {} {expected}",
            at_corner.speed
        );
    }
    let stopped = CornerRules {
        tolerance: 0.0,
        stop_angle: std::f64::consts::PI,
    };
    let strokes = shapes::polyline(&ring(0.04, 90, 1e-12), 0.06).unwrap();
    assert_eq!(survey(&strokes, &stopped).stops, 89);
}

/// A feed that changes on the way is a ramp and no stop; a rapid ends at rest.
#[test]
fn a_feed_changes_without_a_stop() {
    let rules = CornerRules::default();
    let of = |text: &str| survey(&gcode::strokes(text).unwrap(), &rules);
    let slower = of("G1 X50 F3000\nX100 F600\n");
    assert_eq!(slower.stops, 0);
    // 50 mm at 50 mm/s and 50 mm at 10 mm/s, and the ramps.
    assert!((slower.duration_s - 6.0).abs() < 0.15, "{slower:?}");
    assert_eq!(of("G0 X50\nG1 X100 F600\n").stops, 1);
    assert_eq!(of("G0 X50\nG0 X100\n").stops, 0);
}

/// A path that does not stop is planned piece by piece, and takes the same time as in one piece.
#[test]
fn a_path_without_a_stop_may_have_any_length() {
    let turns = 20;
    let circle = survey(&shapes::circle(0.04, 0.06).unwrap(), &CornerRules::default());
    let one = ring(0.04, 1000, 1e-9);
    let points: Vec<PlanePoint> = one[..1000].iter().copied().cycle().take(1000 * turns + 1).collect();
    let found = polyline(&points, 0.06);
    assert_eq!(found.stops, 0);
    let expected = circle.duration_s + (turns - 1) as f64 * TAU * 0.04 / 0.06;
    assert!(
        (found.duration_s - expected).abs() < 0.01 * expected,
        "{found:?} {expected}"
    );
}

/// Wherever it is, the command stays below the feed and keeps acceleration and jerk along the path.
#[test]
fn the_command_keeps_its_limits_on_paths_with_bends_of_all_sizes() {
    let mut state = 12345u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..20 {
        let (mut at, mut direction) = ([0.0, 0.0], 0.0f64);
        let mut strokes = Vec::new();
        for _ in 0..400 {
            direction += (random() - 0.5) * if random() < 0.1 { 1.4 } else { 0.2 };
            let length = 10f64.powf(-5.0 + 3.0 * random());
            let (sin, cos) = direction.sin_cos();
            let to = [at[0] + length * cos, at[1] + length * sin];
            let speed = if random() < 0.05 { 0.02 } else { 0.1 };
            strokes.push(Stroke::feed(Shape::Line { from: at, to }, speed));
            at = to;
        }
        let contour = Contour::new(&strokes, &LIMITS, &CornerRules::default()).unwrap();
        let step_s = 1e-4;
        let samples = contour.samples(step_s, 0.0).unwrap();
        assert!((samples.last().unwrap().along - contour.survey().length).abs() < 1e-9);
        for window in samples.windows(4) {
            let d = |w: [f64; 4]| (0..4).map(|k| w[k] * window[k].along).sum::<f64>();
            assert!(window[0].speed <= 0.1 * (1.0 + 1e-9) && window[1].along >= window[0].along - 1e-12);
            let (acceleration, jerk) = (
                d([1.0, -2.0, 1.0, 0.0]) / step_s.powi(2),
                d([-1.0, 3.0, -3.0, 1.0]) / step_s.powi(3),
            );
            assert!(
                acceleration.abs() <= LIMITS.acceleration / 2f64.sqrt() * 1.001,
                "{acceleration}"
            );
            assert!(jerk.abs() <= LIMITS.jerk / 8f64.sqrt() * 1.001, "{jerk}");
        }
    }
}
