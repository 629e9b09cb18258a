//! No text makes the parser panic, and every error names a place inside the file.

use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use posicast_machine::machine_file;
use proptest::prelude::*;

use crate::machine_file::files::{CONTOURING_STAGE, CUSTOM_SHAPER, EVERYTHING, GANTRY, ROBOT_JOINT, XY_STAGE};

const FILES: [&str; 6] = [
    XY_STAGE,
    CONTOURING_STAGE,
    GANTRY,
    ROBOT_JOINT,
    CUSTOM_SHAPER,
    EVERYTHING,
];

/// Values that often break parsers: the ends of every number type, an empty value, and every other type.
const VALUES: [&str; 24] = [
    "",
    "0",
    "-0.0",
    "-1",
    "1",
    "nan",
    "-inf",
    "inf",
    "1e308",
    "5e-324",
    "1e400",
    "18446744073709551615",
    "-9223372036854775809",
    "0xffffffffffffffffffffffff",
    "0.9999999999999999",
    "\"\"",
    "\"zvd\"",
    "\"periodic\"",
    "true",
    "1979-05-27",
    "[]",
    "[[0, 1]]",
    "{}",
    "[[[[[[]]]]]]",
];

/// Parses, and checks what holds for every text.
fn check(text: &str) -> Result<(), TestCaseError> {
    match machine_file::parse("m.toml", text) {
        Ok(machine) => {
            prop_assert!((1..=4).contains(&machine.axes.len()));
            for axis in &machine.axes {
                for mode in &axis.modes {
                    prop_assert!((0.0..1.0).contains(&mode.mode.damping));
                    let turn = mode.mode.omega_damped() * machine.clock.sample_period_s();
                    prop_assert!(turn > 0.0 && turn < std::f64::consts::PI);
                    let tolerance = axis.shaped().tolerance_of(mode);
                    prop_assert!(tolerance > 0.0 && tolerance < 1.0);
                }
            }
        }
        Err(error) => {
            prop_assert!(!error.problems().is_empty());
            for problem in error.problems() {
                prop_assert!(problem.span.start <= problem.span.end && problem.span.end <= text.len());
                prop_assert!(problem.line >= 1 && problem.line <= text.lines().count() + 1);
                prop_assert!(!problem.remedy.is_empty());
            }
            // A front marks the places in the text, whatever the text is.
            let places = error
                .problems()
                .iter()
                .map(|problem| LabeledSpan::new_with_span(None, problem.span.clone()));
            let drawn = MietteDiagnostic::new(error.to_string()).with_labels(places);
            let source = NamedSource::new(error.file_name(), error.text().to_owned());
            let picture = format!("{:?}", Report::new(drawn).with_source_code(source));
            prop_assert!(picture.contains("m.toml"));
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn prop_arbitrary_text_is_parsed_or_refused(text in any::<String>()) {
        check(&text)?;
    }

    #[test]
    fn prop_text_of_toml_marks_is_parsed_or_refused(text in "[\\[\\]{}=,.\"'#\n a-c0-9_-]{0,200}") {
        check(&text)?;
    }

    #[test]
    fn prop_a_value_replaced_is_parsed_or_refused(
        file in prop::sample::select(&FILES[..]),
        line in any::<prop::sample::Index>(),
        value in prop::sample::select(&VALUES[..]),
    ) {
        let settings: Vec<usize> = (0..file.lines().count()).filter(|n| file.lines().nth(*n).is_some_and(|l| l.contains(" = "))).collect();
        let chosen = settings[line.index(settings.len())];
        let changed = |(n, line): (usize, &str)| match line.split_once(" = ") {
            Some((key, _)) if n == chosen => format!("{key} = {value}\n"),
            _ => format!("{line}\n"),
        };
        let text: String = file.lines().enumerate().map(changed).collect();
        check(&text)?;
    }

    #[test]
    fn prop_lines_removed_swapped_and_doubled_are_parsed_or_refused(
        file in prop::sample::select(&FILES[..]),
        edits in prop::collection::vec((0..3u8, any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..6),
    ) {
        let mut lines: Vec<&str> = file.lines().collect();
        for (edit, a, b) in edits {
            let (a, b) = (a.index(lines.len()), b.index(lines.len()));
            match edit {
                0 => drop(lines.remove(a)),
                1 => lines.swap(a, b),
                _ => lines.insert(a, lines[b]),
            }
        }
        check(&lines.join("\n"))?;
    }

    #[test]
    fn prop_bytes_cut_and_inserted_are_parsed_or_refused(
        file in prop::sample::select(&FILES[..]),
        at in any::<prop::sample::Index>(),
        cut in 0..20usize,
        insert in "\\PC{0,5}",
    ) {
        let characters: Vec<char> = file.chars().collect();
        let at = at.index(characters.len());
        let kept = characters.iter().skip(at + cut);
        let text: String = characters.iter().take(at).chain(insert.chars().collect::<Vec<_>>().iter()).chain(kept).collect();
        check(&text)?;
    }
}

#[test]
fn deep_nesting_is_refused_and_overflows_no_stack() {
    for deep in [
        "a = ".to_owned() + &"[".repeat(100_000),
        "[".to_owned() + &"a.".repeat(20_000) + "a]",
        "a.".repeat(20_000) + "a = 1",
    ] {
        check(&deep).unwrap();
    }
}
