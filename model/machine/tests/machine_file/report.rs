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
fn the_error_has_the_place_in_the_text_and_says_what_to_do() {
    let text = SMALL.replace("damping = 0.1", "damping = 7");
    let error = wrong(&text);
    let problem = &error.problems()[0];
    assert_eq!(
        (&error.text()[problem.span.clone()], problem.cause.label()),
        ("7", "out of range")
    );
    assert_eq!((error.file_name(), error.text()), ("m.toml", text.as_str()));
    assert!(error.to_string().contains("at least 0, below 1"), "{error}");
    assert_eq!(
        error.help(),
        "percent? 7 % is 0.07; else give `damping` a value in this range"
    );
}

#[test]
fn control_characters_of_the_file_do_not_reach_the_terminal() {
    let error = wrong(&SMALL.replace("\"slide\"", "\"\"\"a\nb\"\"\""));
    assert!(
        error.to_string().contains("found \"\"\"a\\nb\"\"\"; allowed"),
        "{error}"
    );
}
