//! Remedies: what a wrong value most likely means, and the word that a misspelt one was meant to be.

use crate::machine_file::files::{SMALL, wrong};

/// Returns the remedies, with their lines, for a file that has `from` replaced by `to`.
fn remedies(from: &str, to: &str) -> Vec<(usize, String)> {
    assert!(SMALL.contains(from), "{from}");
    let error = wrong(&SMALL.replace(from, to));
    error.problems().iter().map(|p| (p.line, p.remedy.clone())).collect()
}

/// Returns the only remedy.
fn remedy(from: &str, to: &str) -> (usize, String) {
    let mut found = remedies(from, to);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

#[test]
fn a_clock_in_megahertz_is_asked_for_at_its_own_line() {
    let (line, remedy) = remedy("frequency_hz = 50_000_000", "frequency_hz = 50");
    assert_eq!(line, 3);
    assert_eq!(
        remedy,
        "50 MHz? Frequencies are in Hz: write `frequency_hz = 50_000_000`"
    );
}

#[test]
fn a_sample_rate_in_kilohertz_is_asked_for() {
    let expected = (
        4,
        "10 kHz? Frequencies are in Hz: write `sample_hz = 10_000`".to_owned(),
    );
    assert_eq!(remedy("sample_hz = 10_000", "sample_hz = 10"), expected);
    // 10 Hz also divide a clock of 50 Hz: only the mode shows that they are too few.
    let slow = "frequency_hz = 50\nsample_hz = 10\n";
    let (line, remedy) = remedy("frequency_hz = 50_000_000\nsample_hz = 10_000\n", slow);
    assert_eq!(line, 13);
    assert!(
        remedy.starts_with("10 kHz? Frequencies are in Hz: write `clock.sample_hz = 10_000`; else"),
        "{remedy}"
    );
}

#[test]
fn a_ratio_above_one_is_asked_for_in_percent() {
    let expected = "percent? 5 % is 0.05; else give `damping` a value in this range";
    assert_eq!(remedy("damping = 0.1", "damping = 5"), (14, expected.to_owned()));
}

#[test]
fn misspelt_kinds_families_boards_and_units_get_the_word_that_is_meant() {
    for (word, meant) in [("zdv", "zvd"), ("ZVD", "zvd"), ("two_hump_ei", "two-hump-ei")] {
        assert_eq!(
            remedy("\"zvd\"", &format!("\"{word}\"")).1,
            format!("did you mean \"{meant}\"?")
        );
    }
    let target = |family: &str, board: &str| {
        remedy(
            "[clock]",
            &format!("[target]\nfamily = \"{family}\"\nboard = \"{board}\"\n[clock]"),
        )
        .1
    };
    assert_eq!(target("CycloneV", "de1"), "did you mean \"cyclone5\"?");
    assert_eq!(target("cyclone5", "DE1-SoC"), "did you mean \"de1soc\"?");
    assert!(target("cyclone5", "de10nano").starts_with("leave `board` out"));
    let unit = remedy("counts_per_unit", "unit = \"millimeter\"\ncounts_per_unit").1;
    assert_eq!(unit, "did you mean \"mm\"?");
}

#[test]
fn a_misspelt_key_or_table_is_the_one_problem_of_the_file() {
    for (from, to, line, meant) in [
        ("[axis.shaper]", "[axis.shapr]", 10, "shaper"),
        ("[[axis.mode]]", "[[axis.mdoe]]", 12, "mode"),
        ("[clock]", "[clok]", 2, "clock"),
        ("damping = 0.1", "dampnig = 0.1", 14, "damping"),
        ("damping = 0.1", "zeta = 0.1", 14, "damping"),
        ("frequency_hz = 40.0", "freq = 40.0", 13, "frequency_hz"),
        ("kind = ", "type = ", 11, "kind"),
    ] {
        let expected = (line, format!("did you mean `{meant}`? Else remove the key"));
        assert_eq!(remedy(from, to), expected, "{to}");
    }
}

#[test]
fn a_key_in_the_wrong_table_is_sent_to_its_own() {
    let found = remedy("damping = 0.1", "damping = 0.1\ndead_time_s = 1e-6").1;
    assert_eq!(found, "move it to [axis.pwm], which it belongs to");
}

#[test]
fn a_value_of_another_type_is_shown_as_it_should_be() {
    for (from, to, expected) in [
        (
            "damping = 0.1",
            "damping = \"0.1\"",
            "write it without quotes: `damping = 0.1`",
        ),
        (
            "command_bits = 32",
            "command_bits = 32.0",
            "write it without a point: `command_bits = 32`",
        ),
        (
            "counts_per_unit",
            "modulo = \"yes\"\ncounts_per_unit",
            "write it without quotes: `modulo = true`",
        ),
        ("[[axis]]", "[axis]", "write its header with two brackets: [[axis]]"),
        (
            "[axis.shaper]",
            "[[axis.shaper]]",
            "there is one such table: write its header with one bracket, [axis.shaper]",
        ),
    ] {
        let found = remedies(from, to);
        assert!(found.iter().any(|(_, remedy)| remedy == expected), "{found:?}");
    }
}

#[test]
fn what_is_no_toml_is_quoted_and_mended() {
    for (from, to, part) in [
        ("\"zvd\"", "zvd", "in quotes"),
        ("50_000_000", "50,000,000", "set apart with `_`"),
        ("damping = 0.1", "damping = 0.1\ndamping = 0.2", "remove one of the two"),
        ("[clock]", "[clock]\n[clock]", "join the two"),
        ("40.0", "40 Hz", "the number alone"),
    ] {
        let error = wrong(&SMALL.replace(from, to));
        let remedy = &error.problems()[0].remedy;
        assert!(remedy.contains(part), "{remedy}");
        assert!(error.to_string().contains(", in `"), "{error}");
    }
}

#[test]
fn each_of_several_remedies_names_its_line() {
    let text = SMALL
        .replace("\"zvd\"", "\"zdv\"")
        .replace("damping = 0.1", "damping = 5");
    let help = wrong(&text).help();
    let expected =
        "line 11: did you mean \"zvd\"?\nline 14: percent? 5 % is 0.05; else give `damping` a value in this range";
    assert_eq!(help, expected);
}
