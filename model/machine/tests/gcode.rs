//! G-code as slicers, CAM programs and people write it: what is read, ignored and refused.

use posicast_machine::contour::{ContourError, PlanePoint, Shape, Stroke, gcode};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn program(text: &str) -> Vec<Stroke> {
    gcode::strokes(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn near(found: PlanePoint, expected: PlanePoint) -> bool {
    (found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-12
}

/// Returns the ends of the strokes, in mm.
fn ends(strokes: &[Stroke]) -> Vec<[f64; 2]> {
    let ends = strokes.iter().map(|stroke| stroke.shape.at(stroke.shape.length()));
    ends.map(|end| end.map(|place| (1e9 * place).round() / 1e6)).collect()
}

fn refusal(text: &str) -> String {
    match gcode::strokes(text) {
        Ok(strokes) => panic!("{text}: {strokes:?}"),
        Err(error) => {
            assert!(
                !matches!(error, ContourError::Line { .. }) || error.remedy().is_some_and(|remedy| !remedy.is_empty())
            );
            error.to_string()
        }
    }
}

#[test]
fn a_program_is_read_as_its_lines_and_arcs() {
    let strokes = program(
        "%\n(a part)\nG21 G90 G17\nG0 X10 Y0\nG1 X20 F600 ; on\nY10\nG3 X10 Y20 I-10 J0\nG2 X0 Y10 R10\nG91\nG1 X-1.23456789\nG4 P1\nG20 X0.1\nM30\nX5",
    );
    let shapes: Vec<Shape> = strokes.iter().map(|stroke| stroke.shape).collect();
    assert_eq!(
        shapes[0],
        Shape::Line {
            from: [0.0, 0.0],
            to: [0.01, 0.0]
        }
    );
    assert!(strokes[0].speed.is_infinite() && strokes[0].rapid && !strokes[1].rapid);
    assert!((strokes[1].speed - 0.01).abs() < 1e-15);
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
    // G0 ends at rest, G4 stops.
    let stops: Vec<bool> = strokes.iter().map(|stroke| stroke.after_stop).collect();
    assert_eq!(stops, [true, true, false, false, false, false, true]);
    assert!((shapes[6].length() - 2.54e-3).abs() < 1e-15);
}

#[test]
fn arcs_by_centre_radius_and_turns() {
    let sweep = |text: &str| match program(text)[0].shape {
        Shape::Arc { sweep, .. } => sweep,
        line => panic!("{line:?}"),
    };
    for (text, expected) in [
        ("G2 I5 F60", -TAU),
        ("G3 X0 Y10 R-10 F60", 5.0 * PI / 3.0),
        ("G3 X10 Y10 I0 J10 P3 F60", FRAC_PI_2 + 2.0 * TAU),
        ("G90.1 G3 X10 Y10 I0 J10 F60", FRAC_PI_2),
        ("G91 G3 X10 Y10 J10 F60", FRAC_PI_2),
        ("G92 X5 Y5\nG90.1 G3 X15 Y15 I5 J15 F60", FRAC_PI_2),
        ("G20 G3 X1 Y1 J1 F60", FRAC_PI_2),
    ] {
        assert!((sweep(text) - expected).abs() < 1e-9, "{text}: {}", sweep(text));
    }
    // An arc with rounded digits ends where the next stroke begins.
    let strokes = program("G3 X7.071 Y2.929 I0 J10 F60\nG1 X8");
    let arc = strokes[0].shape;
    assert!(near(arc.at(arc.length()), strokes[1].shape.at(0.0)));
}

/// Every line that moves neither X nor Y, in the dialects of slicers, CAM programs and firmware.
const NO_MOVE: &str = "\
EXCLUDE_OBJECT_DEFINE NAME=part_1 CENTER=120,110 POLYGON=[[95.1,85.2],[145,85]]
EXCLUDE_OBJECT_START NAME=part_1
SET_PRESSURE_ADVANCE ADVANCE=0.02
SET_VELOCITY_LIMIT ACCEL=3000 SQUARE_CORNER_VELOCITY=5
TIMELAPSE_TAKE_FRAME
START_PRINT EXTRUDER_TEMP=215 BED_TEMP=60
_USE_LINE Z=2
G92 E0
G92 E0.0
M117 Layer 1 of 2: X10 Y20
M117
M118 A1 P0 action:notification X5
M486 S0
M486 Apart.stl
M486 A\"big part\" X1
G10
G10 S1
G11
G29
G29 A X10 Y10 I100 J100
G29 P1 X30 Y0 W50 H20 C
G29.1 Z-0.02
G53 G0 Z0
G43 Z15. H1
G43 H1
G49
M862.3 P \"MK3S\"
M862.1 P0.4 A0 F1
M862.6 P\"Input shaper\"
M201 X9000 Y9000 Z500 E10000
M203 X500 Y500
M204 P1250 R1250 T1250
M205 X8.00 Y8.00 Z0.40 E1.50 ; jerk
M566 X480 Y480
M572 D0 S0.03
M593 F40.5 D0.1
M92 X80 Y80 Z400 E93
M84 X Y E
M18
M17 X1.2 Y1.2 Z0.75
M906 X800 Y800
M555 X10 Y10 W50 H50
M73 P0 R10
M104 S215
M109 S215 ; wait
M190 S60
M106 S255
M107
M82
M83
M220 S100
M221 S95
M400
M1002 gcode_claim_action : 2
M622 J1
M623
M1006 A0 B10 L100 C37 D10 M60
M991 S0 P0 ;notify layer change
M98 P\"0:/macros/prime.g\"
M23 part.gco
M600
M0 Click to continue X5
M1
M3 S1000
M5
M6 T1
M9
T0
T1 M6
N60 G28 G91 Z0.
G90
G28 Z
G28 Z0
G30 Z0
G80
G80 N3
G21
G20
G21
G94
G17
G40
G54
G64
G64 P0.01 Q0.01
G90.1
G91.1
G69
G4 P500
G4 X1.5
G04 S2
G1 F3000
G0 F9000
G1 E-1.5 F2400
G1 Z0.3 F600
G1 Z0.3 E1
g1 z.2
F1200
S12000
G0
G1
; thumbnail begin 32x32 500
; iVBORw0KGgoAAAANSUhEUgAAACAAAAAgCAYAAABzenr0 X1 Y2
;TYPE:WALL-OUTER
;LAYER:0
( G1 X5 Y5 )
(unclosed G1 X5
%
O1001
O0002 (PART)
:1001
#1=5
#<_depth> = [2 * 3]
@OBJECT part
$110=1000
N10
N20 ; X5
N5 M105*36
N6*1
A90
G0 A90 B5
G1 U5 V7 W2 F100
G18
G19
G17
G94
G61
G64
G81 Z-5 R2 F100
G80
G999
G425
M206 Z0.1
G5
G33
";

/// A program with each of these lines is that without it: the place, the unit and the feed of the next move are the
/// same.
#[test]
fn lines_that_move_neither_x_nor_y_are_ignored_in_all_dialects() {
    for line in NO_MOVE.lines() {
        for end in ["\n", "\r\n"] {
            // G1 and G21 again: some lines are other motions.
            let text = ["G21 G90", "G1 X10 Y10 F600", line, "G21 G90 G1 X20 F600", "Y30"].join(end);
            let strokes = program(&text);
            assert_eq!(ends(&strokes), [[10.0, 10.0], [20.0, 10.0], [20.0, 30.0]], "{line}");
            assert!(
                strokes.iter().all(|stroke| (stroke.speed - 0.01).abs() < 1e-12),
                "{line}"
            );
        }
    }
    // All of them at once, in front of the first move.
    let text = format!("{NO_MOVE}\nG21 G90 G94\nG1 X10 Y10 F600\n");
    assert_eq!(ends(&program(&text)), [[10.0, 10.0]]);
}

#[test]
fn what_moves_x_or_y_and_is_not_understood_is_refused_at_its_line() {
    for (text, found) in [
        ("X5", "a place before the first"),
        ("G1 X5", "G1 without a feed"),
        ("G1 X5 F0", "F0"),
        ("G28 X0", "G28 is not read"),
        ("G28 X Y", "G28 is not read"),
        ("G1 X5 F60\nG28", "G28 is not read"),
        ("G28 Y0 Z0", "G28 is not read"),
        ("G91 G28 X0", "G28 is not read"),
        ("G30", "G30 is not read"),
        ("G30 X5 Y5", "G30 is not read"),
        ("G1 F60\nG5 X10 Y5 I1 J2 P1 Q2", "G5 is not read"),
        ("G5.1 X10 Y5 I1 J2", "G5.1 is not read"),
        ("G2 X10 Y0 F60", "an arc without I, J or R"),
        (
            "G2 X10 Y0 R4 F60",
            "an arc of radius 4.0000 mm to a place 10.0000 mm away",
        ),
        (
            "G2 X10 Y0 I4 F60",
            "an arc whose beginning is 4.0000 mm from its centre, and its end 6.0000 mm",
        ),
        ("G2 X10 Y0 I0 J0 F60", "an arc whose beginning is 0.0000 mm"),
        ("G2 X10 Y0 I5 P1.5 F60", "an arc of P1.5 turns"),
        ("G38.2 X1", "G38.2 is not read"),
        ("G18 F60\nG2 X10 Z0 I5 K0", "an arc in the plane of G18"),
        ("G19 F60\nG3 Y10 Z0 J5 K0", "an arc in the plane of G19"),
        ("O100 sub", "`O100 sub` is not read"),
        ("o<hole> call [5]", "`o<hole> call [5]` is not read"),
        ("o101 while [#1 LT 5]", "`o101 while"),
        ("IF [#1 GT 5] GOTO 10", "`IF [#1 GT 5] GOTO 10` is not read"),
        ("while iterations < 5", "`while iterations < 5` is not read"),
        ("M98 P1000 L2", "M98 is not read"),
        ("M97 P10", "M97 is not read"),
        ("G1 X#1 F60", "`X#1 F60` has no number"),
        ("G1 X[1+2] F60", "`X[1+2] F60` has no number"),
        ("G1 F60\nG1 @10 ^45", "`@10 ^45` has no number"),
        ("G1 F60\n@10 ^45", "`@10 ^45` is not read"),
        ("G1 F60\nG1 X", "`X` has no number"),
        ("G19 G1 F60\nG3 Z0 K5", "an arc in the plane of G19"),
        ("G1 X10,5 F60", "`,5 F60` has no number"),
        ("G1 X{x} F60", "`X{x} F60` has no number"),
        ("G1 X1 X2 F60", "X stands there twice"),
        ("G41 D1", "G41 is not read"),
        ("G42", "G42 is not read"),
        ("G51 X2", "G51 is not read"),
        ("G68 R45", "G68 is not read"),
        ("G16", "G16 is not read"),
        ("G27", "G27 is not read"),
        ("G26", "G26 is not read"),
        ("G7", "G7 is not read"),
        ("G12 I5", "G12 is not read"),
        ("G10 L20 P1 X0 Y0", "G10 is not read"),
        ("M206 X5", "M206 is not read"),
        ("M218 T1 X25", "M218 is not read"),
        ("G81 X10 Y10 Z-5 R2 F100", "G81 is not read"),
        ("G81 Z-5 R2 F100\nX10 Y10", "G81 is not read"),
        ("G33 X10 K1", "G33 is not read"),
        ("G999 X1", "G999 is not read"),
        ("G61 S0 X Y", "G61 is not read"),
        ("$H", "`$H` is not read"),
        ("$J=G91 X10 F100", "`$J=G91 X10 F100` is not read"),
        ("_PARK X=10", "`_PARK` has X or Y"),
        ("SET_KINEMATIC_POSITION X=0 Y=0", "`SET_KINEMATIC_POSITION` has X or Y"),
        ("GX10 Y10", "`GX10` has X or Y"),
        ("G95 G1 X5 F0.1", "G95"),
        ("G0 X5 G1 Y5 F60", "two of G0, G1, G2 and G3"),
        ("/G1 X5 F60", "`/`"),
        ("G54 G1 X5 F60\nG55 X6", "G55 is not read"),
        ("GCDE\x01\x00\x00", "it is not a text"),
        ("G1 X1e5 Y.e F60", "`Y.e F60` has no number"),
    ] {
        let line = text.lines().count();
        for (before, end) in [("", "\n"), (";\n\n", "\n"), ("", "\r\n")] {
            if text.starts_with("GCDE") && !before.is_empty() {
                continue;
            }
            let program = format!("{before}{}", text.replace('\n', end));
            let line = line + before.lines().count();
            let error = refusal(&program);
            assert!(error.starts_with(&format!("line {line}: {found}")), "{text}: {error}");
        }
    }
    for text in ["", "M3 S1000\nM30", "G1 F60\nZ5", "G28\nG29\nM104 S200"] {
        assert_eq!(refusal(text), "no path: the program moves neither X nor Y", "{text}");
    }
}

#[test]
fn origins_units_and_relative_moves() {
    for (text, expected) in [
        ("G92 X10 Y5\nG1 X20 Y5 F60", vec![[10.0, 0.0]]),
        (
            "G1 X10 F60\nG92 X0\nG1 X5\nG92.1\nG1 X20",
            vec![[10.0, 0.0], [15.0, 0.0], [20.0, 0.0]],
        ),
        ("G1 X10 F60\nG92\nG1 X5 Y1", vec![[10.0, 0.0], [15.0, 1.0]]),
        (
            "G1 X10 F60\nG92 X0\nG53 G0 X0 Y2\nG1 X1",
            vec![[10.0, 0.0], [0.0, 2.0], [11.0, 2.0]],
        ),
        (
            "G1 X10 F60\nG91\nX1Y1\nX1\nG90 X0",
            vec![[10.0, 0.0], [11.0, 1.0], [12.0, 1.0], [0.0, 1.0]],
        ),
        ("G20\nG1 X1 F60\nG21\nX50.8", vec![[25.4, 0.0], [50.8, 0.0]]),
        ("G52 X5\nG1 X0 Y1 F60\nG52 X0\nX0", vec![[5.0, 1.0], [0.0, 1.0]]),
        ("G1X10Y10F60\ng1x20y20", vec![[10.0, 10.0], [20.0, 20.0]]),
        ("N1 G1 X10 F60*12\nN2 X20*99\n", vec![[10.0, 0.0], [20.0, 0.0]]),
        ("M3 S1000 G1 X5 F60\nM8 X6", vec![[5.0, 0.0], [6.0, 0.0]]),
        ("G1 X5 A90 F60", vec![[5.0, 0.0]]),
    ] {
        assert_eq!(ends(&program(text)), expected, "{text}");
    }
}

#[test]
fn the_feed_counts_in_three_axes() {
    let speed = |text: &str| program(text).last().unwrap().speed;
    // A ramp of 3 by 4 at 5 mm/s goes 3 mm/s in the plane.
    assert!((speed("G1 X3 Z4 F300") - 3e-3).abs() < 1e-12);
    assert!((speed("G1 X3 Z4 F300\nX6 Z4") - 5e-3).abs() < 1e-12);
    assert!((speed("G20 G1 X1 F60") - 25.4e-3).abs() < 1e-12);
    assert!((speed("G93 G1 X10 F6") - 1e-3).abs() < 1e-12);
    // A move of Z or E alone is a stop of X and Y.
    let stops = |text: &str| program(text).last().unwrap().after_stop;
    assert!(!stops("G1 X3 F300\nX6"));
    for between in ["Z5", "G1 E-1 F1800", "G4 P0", "M400", "G10", "M0", "M6 T1", "G61"] {
        assert!(
            stops(&format!("G1 X3 F300\n{between}\nG1 X6 F300\nX7")) == (between == "G61"),
            "{between}"
        );
        assert!(
            stops(&format!("G1 X3 F300\n{between}\nG1 X6 F300")) == (between != "G61"),
            "{between}"
        );
    }
}

/// In a print, moves without E are travels, and G0 has the speed F.
#[test]
fn travels_of_a_print_count_as_rapids() {
    let strokes = program("G0 X10 Y10 F6000\nG1 X40 E1 F3000\nG1 X50 Y50 F9000\nG1 Y60 E1 F3000");
    let rapids: Vec<bool> = strokes.iter().map(|stroke| stroke.rapid).collect();
    assert_eq!(rapids, [true, false, true, false]);
    let speeds: Vec<f64> = strokes.iter().map(|stroke| (1e6 * stroke.speed).round()).collect();
    assert_eq!(speeds, [100e3, 50e3, 150e3, 50e3]);
    assert!(strokes.iter().skip(1).all(|stroke| !stroke.after_stop));
    assert!(!program("G1 X10 F60\nG1 X20")[0].rapid);
}

#[test]
fn a_line_of_any_length_is_read() {
    let long = format!(
        "EXCLUDE_OBJECT_DEFINE POLYGON={}\nG1 X5 F60\n",
        "[1,2],".repeat(100_000)
    );
    assert_eq!(ends(&program(&long)), [[5.0, 0.0]]);
    let comment = format!("G1 X5 F60\n;{}\nX6", "x".repeat(200_000));
    assert_eq!(ends(&program(&comment)), [[5.0, 0.0], [6.0, 0.0]]);
    let error = refusal(&format!("G1 X5 F60{}\n", " ".repeat(70_000)));
    assert!(error.starts_with("line 1: a line of more than"), "{error}");
}

/// Parts of which lines are made at random.
fn parts() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "G0",
        "G1",
        "G2",
        "G3",
        "g1",
        "G28",
        "G92",
        "G53",
        "G91",
        "G90",
        "G20",
        "G21",
        "G17",
        "G18",
        "M117",
        "M30x",
        "T1",
        "N10",
        "*71",
        "X",
        "Y",
        "Z",
        "E",
        "I",
        "J",
        "R",
        "P",
        "F",
        "O",
        "o1",
        "%",
        "(",
        ")",
        ";",
        "/",
        "#",
        "[",
        "]",
        "\"",
        "=",
        "@",
        "^",
        "$",
        "-",
        "+",
        ".",
        " ",
        "\t",
        "\r",
        "\u{0}",
        "é",
        "E1",
        "F600",
        "IF",
        "EXCLUDE_OBJECT",
        "G10",
        "G80",
        "G93",
    ]);
    let number = prop_oneof![
        (-1e3..1e3f64).prop_map(|number| format!("{number:.3}")),
        any::<f64>().prop_map(|number| number.to_string()),
        "[0-9]{1,40}\\.?[0-9]{0,40}",
    ];
    prop_oneof![word.prop_map(str::to_owned), number, "\\PC{0,6}"]
}

fn never_panics(text: &str) {
    match gcode::strokes(text) {
        Ok(strokes) => {
            for pair in strokes.windows(2) {
                let end = pair[0].shape.at(pair[0].shape.length());
                let [x, y] = pair[1].shape.at(0.0);
                let radius = |stroke: &Stroke| match stroke.shape {
                    Shape::Arc { radius, .. } => radius,
                    Shape::Line { .. } => 0.0,
                };
                let of = |stroke: &Stroke| stroke.shape.length() + radius(stroke);
                let size = 1e-9 * (1.0 + x.abs().max(y.abs()) + of(&pair[0]) + of(&pair[1]));
                assert!(
                    (end[0] - x).abs() <= size && (end[1] - y).abs() <= size,
                    "a gap in {text:?}"
                );
            }
            for stroke in strokes {
                assert!(stroke.speed > 0.0 && stroke.shape.length() > 0.0, "{text:?}");
            }
        }
        Err(ContourError::Line { line, .. }) => {
            assert!(line >= 1 && line <= text.split('\n').count() as u64, "{text:?}");
        }
        Err(_) => (),
    }
}

fn lines() -> impl Strategy<Value = String> {
    let line = prop::collection::vec(parts(), 0..8).prop_map(|parts| parts.concat());
    prop::collection::vec(line, 0..12).prop_map(|lines| lines.join("\n"))
}

/// A valid program with some characters replaced, removed or doubled.
fn damaged() -> impl Strategy<Value = String> {
    let places = prop::collection::vec((any::<prop::sample::Index>(), any::<char>(), 0..3u8), 1..6);
    places.prop_map(|places| {
        let mut text: Vec<char> = format!("G21\nG1 X10 Y10 F600\nG3 X20 Y20 I0 J10\n{NO_MOVE}G1 X1 E2\n")
            .chars()
            .collect();
        for (place, with, how) in places {
            let at = place.index(text.len());
            match how {
                0 => text[at] = with,
                1 => drop(text.remove(at)),
                _ => text.insert(at, text[at]),
            }
        }
        text.into_iter().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn prop_any_program_is_read_or_refused(text in lines()) {
        never_panics(&text);
    }

    #[test]
    fn prop_a_damaged_program_is_read_or_refused(text in damaged()) {
        never_panics(&text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(50_000))]

    #[test]
    fn long_any_program_is_read_or_refused(text in prop_oneof![lines(), damaged(), "(?s).{0,200}"]) {
        never_panics(&text);
    }
}
