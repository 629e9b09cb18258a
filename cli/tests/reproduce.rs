//! `posicast reproduce` and `posicast design --compare`: exit status, standard output, the JSON documents.

use assert_cmd::Command;
use predicates::str::contains;
use serde_json::Value;

const PAPERS: [&str; 5] = [
    "hybrid-ei",
    "negative-hybrid",
    "vibrationless",
    "antisymmetry",
    "xy-stage",
];

fn posicast(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("posicast").unwrap().args(arguments).assert()
}

fn json(arguments: &[&str]) -> Value {
    let output = posicast(arguments).success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

#[test]
fn cli_json_has_every_paper_and_counts_that_add_up() {
    let document = json(&["reproduce", "--json"]);
    let papers = document["papers"].as_array().unwrap();
    let names: Vec<&str> = papers.iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(names, PAPERS);
    let (mut reproduced, mut errata, mut not_comparable) = (0, 0, 0);
    for row in papers.iter().flat_map(|p| p["rows"].as_array().unwrap()) {
        let keys: Vec<&String> = row.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["item", "paper", "ours", "verdict", "reason"]);
        let reason = row["reason"].as_str().unwrap();
        match row["verdict"].as_str().unwrap() {
            "reproduced" => reproduced += 1,
            "erratum" => {
                errata += 1;
                assert!(!reason.is_empty(), "{row}");
            }
            "not comparable" => {
                not_comparable += 1;
                assert!(row["ours"].is_null() && !reason.is_empty(), "{row}");
            }
            other => panic!("{other}: {row}"),
        }
        let (paper, ours) = (&row["paper"], &row["ours"]);
        let same_shape = (paper.is_number() && ours.is_number())
            || (paper.is_string() && ours.is_string())
            || paper
                .as_array()
                .zip(ours.as_array())
                .is_some_and(|(a, b)| a.len() == b.len());
        assert!(same_shape || ours.is_null(), "{row}");
    }
    assert_eq!(document["reproduced"], reproduced);
    assert_eq!(document["errata"], errata);
    assert_eq!(document["not_comparable"], not_comparable);
    assert_eq!(document["not_reproduced"], 0);
}

#[test]
fn cli_text_ends_with_the_counts() {
    posicast(&["reproduce", "antisymmetry"])
        .success()
        .stdout(contains("antisymmetry: "))
        .stdout(contains("Table 2: two impulses"))
        .stdout(predicates::str::is_match(r"\n\d+ reproduced, \d+ errata, \d+ not comparable\n$").unwrap());
}

#[test]
fn cli_an_unknown_paper_is_refused_with_the_five() {
    let assert = posicast(&["reproduce", "hybrid", "--json"]).code(2).stdout("");
    PAPERS
        .iter()
        .fold(assert, |assert, name| assert.stderr(contains(*name)));
}

#[test]
fn cli_figures_are_drawn_one_file_per_paper() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figures");
    posicast(&["reproduce", "--plot", path.to_str().unwrap()]).success();
    for name in PAPERS {
        let svg = std::fs::read_to_string(path.join(format!("{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("polyline"), "{name}");
    }
}

#[test]
fn cli_a_folder_that_cannot_be_made_is_bad_input() {
    let file = tempfile::NamedTempFile::new().unwrap();
    posicast(&["reproduce", "xy-stage", "--plot", file.path().to_str().unwrap()])
        .code(2)
        .stdout("")
        .stderr(contains("folder"));
}

const MACHINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/xy-stage.toml");

#[test]
fn cli_compare_lists_kinds_by_duration_and_marks_the_best() {
    let document = json(&["design", MACHINE, "--compare", "--json"]);
    assert_eq!(document["band_percent"], 10.0);
    for axis in document["axes"].as_array().unwrap() {
        let kinds = axis["kinds"].as_array().unwrap();
        let durations: Vec<f64> = kinds.iter().map(|k| k["duration_s"].as_f64().unwrap()).collect();
        assert!(durations.is_sorted() && durations.len() > 5);
        assert_eq!(kinds.iter().filter(|k| k["in_file"] == true).count(), 1);
        assert!(kinds.iter().any(|k| k["pareto"] == true) && kinds.iter().any(|k| k["pareto"] == false));
    }
    posicast(&["design", MACHINE, "--compare", "--band", "15"])
        .success()
        .stdout(contains("±15 %"))
        .stdout(contains("as in the file"));
}

#[test]
fn cli_compare_refuses_a_senseless_band() {
    posicast(&["design", MACHINE, "--compare", "--band", "nan"])
        .code(2)
        .stdout("")
        .stderr(contains("0 to 90"));
    posicast(&["design", MACHINE, "--band", "5"])
        .code(2)
        .stdout("")
        .stderr(contains("--compare"));
}
