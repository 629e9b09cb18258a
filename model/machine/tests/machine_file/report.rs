//! The error as a whole: several problems, the marks in the source, and what must not reach a terminal.

use crate::machine_file::files::{SMALL, wrong};
use posicast_machine::machine_file::MAX_PROBLEMS;

#[test]
fn all_problems_of_a_file_are_shown_and_a_flood_is_cut() {
    let text = SMALL.replace("damping = 0.1", "damping = 7").replace("10_000", "-1");
    let keys: Vec<String> = wrong(&text).problems().iter().map(|p| p.key.clone()).collect();
    assert_eq!(keys, ["clock.sample_hz", "axis.mode.damping"]);
    let flood: String = (0..1000).map(|n| format!("unknown{n} = 1\n")).collect();
    let error = wrong(&format!("{flood}{SMALL}"));
    assert_eq!(error.problems().len(), MAX_PROBLEMS);
    assert!(error.to_string().ends_with("\nm.toml: and 980 more"));
}

#[test]
fn the_diagnostic_marks_the_place_and_says_what_to_do() {
    use miette::Diagnostic;
    let error = wrong(&SMALL.replace("damping = 0.1", "damping = 7"));
    let label = error.labels().unwrap().next().unwrap();
    assert_eq!(&SMALL[..label.offset()], &SMALL[..SMALL.find("0.1").unwrap()]);
    assert_eq!((label.len(), label.label()), (1, Some("out of range")));
    assert_eq!(
        error.help().unwrap().to_string(),
        "percent? 7 % is 0.07; else give `damping` a value in this range"
    );
    let mut picture = String::new();
    let handler = miette::GraphicalReportHandler::new().with_wrap_lines(false);
    handler.render_report(&mut picture, &error).unwrap();
    for part in ["m.toml", "damping = 7", "at least 0, below 1", "give `damping` a value"] {
        assert!(picture.contains(part), "{part} in {picture}");
    }
}

#[test]
fn control_characters_of_the_file_do_not_reach_the_terminal() {
    let error = wrong(&SMALL.replace("\"slide\"", "\"\"\"a\nb\"\"\""));
    assert!(
        error.to_string().contains("found \"\"\"a\\nb\"\"\"; allowed"),
        "{error}"
    );
}
