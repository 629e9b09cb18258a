//! `campaign`: the same results whatever the number of shards is, and no verdict from what is missing, doubled or of another campaign.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{assert_fits_schema, example, json, posicast};
use std::path::Path;
use std::process::Output;

/// Runs `campaign` with these words.
fn campaign(words: &[&str]) -> Output {
    posicast().arg("campaign").args(words).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A sweep over eight designs, as one of so many shards, into `folder`.
fn shard(folder: &Path, number: u64, of: u64, seed: &str) -> Output {
    let machine = example("xy-stage.toml");
    let json = folder.join(format!("{number}.json"));
    campaign(&[
        "sweep",
        machine.to_str().unwrap(),
        "--set",
        "axis.x.shaper.kind=zv,zvd,ei,none-such",
        "--set",
        "clock.sample_hz=2000,10000",
        "--seed",
        seed,
        "--shard",
        &format!("{number}/{of}"),
        "--json",
        json.to_str().unwrap(),
    ])
}

fn merged(folder: &Path) -> Output {
    campaign(&["merge", "--json", folder.to_str().unwrap()])
}

#[test]
fn cli_campaign_gives_the_same_whatever_the_number_of_shards() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    assert!(shard(&whole, 1, 1, "1").status.success());
    let whole = merged(&whole);
    assert!(whole.status.success(), "{}", said(&whole));
    let parts = folder.path().join("parts");
    for number in [3, 1, 2] {
        assert!(shard(&parts, number, 3, "1").status.success());
    }
    assert_eq!(merged(&parts).stdout, whole.stdout);
    let document = json(&whole.stdout);
    assert_fits_schema("campaign", &document);
    // The figures of a ZVD shaper are those of `design`.
    let design = json(
        &posicast()
            .args(["design", "--json"])
            .arg(example("xy-stage.toml"))
            .output()
            .unwrap()
            .stdout,
    );
    let duration_ms = 1e3 * design["axes"][0]["duration_s"].as_f64().unwrap();
    let rows = document["rows"].as_array().unwrap();
    let row = |name: &str| rows.iter().find(|row| row["name"] == name).unwrap();
    let zvd = row("axis.x.shaper.kind=zvd clock.sample_hz=10000");
    let found = zvd["figures"]["x duration, ms"].as_f64().unwrap();
    assert!((found - duration_ms).abs() < 1e-4 * duration_ms, "{zvd}");
    let refused = row("axis.x.shaper.kind=none-such clock.sample_hz=2000");
    assert!(
        refused["figures"]["refused"].as_str().unwrap().contains("none-such"),
        "{refused}"
    );
}

#[test]
fn cli_campaign_runs_a_finished_shard_once_and_destroys_no_file() {
    let folder = tempfile::tempdir().unwrap();
    assert!(shard(folder.path(), 1, 2, "1").status.success());
    let file = folder.path().join("1.json");
    let first = std::fs::read(&file).unwrap();
    let again = shard(folder.path(), 1, 2, "1");
    assert!(said(&again).contains("finished already"), "{}", said(&again));
    let other_seed = shard(folder.path(), 1, 2, "2");
    assert_eq!(other_seed.status.code(), Some(2));
    assert!(
        said(&other_seed).contains("of another campaign"),
        "{}",
        said(&other_seed)
    );
    assert_eq!(std::fs::read(&file).unwrap(), first);
    std::fs::write(&file, "notes").unwrap();
    assert_eq!(shard(folder.path(), 1, 2, "1").status.code(), Some(2));
    assert_eq!(std::fs::read(&file).unwrap(), b"notes");
}

#[test]
fn cli_campaign_merge_names_missing_double_and_foreign_shards() {
    let folder = tempfile::tempdir().unwrap();
    let empty = merged(folder.path());
    assert_eq!(empty.status.code(), Some(2));
    for number in [1, 3] {
        shard(folder.path(), number, 3, "1");
    }
    let missing = merged(folder.path());
    assert_eq!(missing.status.code(), Some(1));
    assert!(
        said(&missing).contains("1 of 3 shards are missing: 2/3"),
        "{}",
        said(&missing)
    );
    shard(folder.path(), 2, 3, "8");
    let other = merged(folder.path());
    assert_eq!(other.status.code(), Some(2));
    assert!(said(&other).contains("`seed` is 8, not 1"), "{}", said(&other));
    std::fs::copy(folder.path().join("1.json"), folder.path().join("2.json")).unwrap();
    let doubled = merged(folder.path());
    assert_eq!(doubled.status.code(), Some(2));
    assert!(
        said(&doubled).contains("shard 1/3 is there twice"),
        "{}",
        said(&doubled)
    );
}

/// A shard has the checksum with which it was written.
#[test]
fn cli_campaign_merge_refuses_a_shard_that_was_edited() {
    let folder = tempfile::tempdir().unwrap();
    for number in [1, 2] {
        shard(folder.path(), number, 2, "1");
    }
    assert_eq!(merged(folder.path()).status.code(), Some(0));
    let file = folder.path().join("2.json");
    let whole = std::fs::read_to_string(&file).unwrap();
    let without_seal = whole
        .lines()
        .filter(|line| !line.contains("$comment"))
        .collect::<Vec<_>>()
        .join("\n");
    for (edited, what) in [
        (whole.replace("none-such", "none-Such"), "another result"),
        (whole.replace("\"seconds\": ", "\"seconds\": 1"), "another time"),
        (whole.clone() + "\n", "a line more"),
        (without_seal, "no checksum"),
    ] {
        assert_ne!(edited, whole, "{what}");
        std::fs::write(&file, &edited).unwrap();
        for command in [merged(folder.path()), shard(folder.path(), 2, 2, "1")] {
            assert_eq!(command.status.code(), Some(2), "{what}: {}", said(&command));
            assert!(command.stdout.is_empty());
            let said = said(&command);
            assert!(
                said.contains("2.json: was changed since this shard was written"),
                "{what}: {said}"
            );
        }
        assert_eq!(std::fs::read_to_string(&file).unwrap(), edited, "it is not replaced");
    }
    std::fs::write(&file, whole).unwrap();
    assert_eq!(merged(folder.path()).status.code(), Some(0));
}

#[test]
fn cli_campaign_names_a_broken_block_and_the_command_that_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("package");
    let generated = posicast()
        .arg("generate")
        .arg(example("xy-stage.toml"))
        .arg("-o")
        .arg(&package)
        .output();
    assert!(generated.unwrap().status.success());
    let counter = package.join("rtl/posicast_pulse_counter.v");
    let text = std::fs::read_to_string(&counter).unwrap();
    let broken = text.replace("count_q + change", "count_q - change");
    assert_ne!(text, broken);
    std::fs::write(&counter, broken).unwrap();
    let lock_step = |edited: &[&str]| {
        let mut words = vec!["lock-step", package.to_str().unwrap(), "--block", "pulse_counter"];
        words.extend(["--clocks", "40000", "--unit-clocks", "20000"]);
        words.extend(edited);
        campaign(&words)
    };
    let refused = lock_step(&[]);
    assert_eq!(refused.status.code(), Some(1), "{}", said(&refused));
    let part = folder.path().join("parts/1.json");
    let ran = lock_step(&["--edited", "--json", part.to_str().unwrap()]);
    assert_eq!(ran.status.code(), Some(1), "{}", said(&ran));
    let merged = campaign(&["merge", part.parent().unwrap().to_str().unwrap()]);
    assert_eq!(merged.status.code(), Some(1));
    let text = said(&merged);
    assert!(
        text.contains("FAIL: lock-step of xy_stage") && text.contains("unit 0, pulse_counter"),
        "{text}"
    );
    let repeat = text
        .lines()
        .find_map(|line| line.strip_prefix("to repeat the first failure alone: posicast campaign "));
    let words = shlex::split(repeat.unwrap()).unwrap();
    let alone = campaign(&words.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(alone.status.code(), Some(1), "{}", said(&alone));
    assert!(said(&alone).contains("1 unit, 1 failed"), "{}", said(&alone));
}

/// The figures are those of the tables in `ladder/RESULTS.md`.
#[test]
fn long_cli_campaign_runs_the_other_rungs_of_the_ladder() {
    let recording = Path::new(env!("CARGO_MANIFEST_DIR")).join("../waves/tests/fixtures/waves/icarus.vcd");
    for (words, cells) in [
        (
            &["proofs", "--block", "sample_select"][..],
            ["sample_select, ", "2 units, 0 failed"],
        ),
        (
            &["netlists", "--block", "divider", "--clocks", "20000"],
            ["divider", "20000"],
        ),
        (&["coverage", "--block", "schedule"], ["schedule", "of"]),
        (
            &["identify", "--logs", "1"],
            ["logs of random machines", "1 unit, 0 failed"],
        ),
        (
            &["waveforms", recording.to_str().unwrap(), "--cases", "1"],
            ["damaged recordings", "1 unit, 0 failed"],
        ),
    ] {
        let done = campaign(words);
        assert_eq!(done.status.code(), Some(0), "{words:?}: {}", said(&done));
        for cell in cells {
            assert!(said(&done).contains(cell), "{words:?}: {}", said(&done));
        }
    }
}

#[test]
fn cli_campaign_of_refused_combinations_alone_fails() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("1.json");
    let machine = example("xy-stage.toml");
    let words = [
        "sweep",
        machine.to_str().unwrap(),
        "--set",
        "foo=1,2",
        "--json",
        file.to_str().unwrap(),
    ];
    let swept = campaign(&words);
    assert_eq!(swept.status.code(), Some(1), "{}", said(&swept));
    assert!(
        said(&swept).contains("2 units, 0 failed, 2 refused"),
        "{}",
        said(&swept)
    );
    let merged = campaign(&["merge", folder.path().to_str().unwrap()]);
    assert_eq!(merged.status.code(), Some(1), "{}", said(&merged));
    assert!(said(&merged).contains("FAIL: sweep of xy_stage"), "{}", said(&merged));
    assert!(!said(&merged).contains("PASS"), "{}", said(&merged));
}

#[test]
fn cli_campaign_refuses_unknown_names_and_missing_options() {
    let machine = example("xy-stage.toml");
    let machine = machine.to_str().unwrap();
    for (words, expected) in [
        (&["mutants", "--block", "divder"][..], "did you mean `divider`?"),
        (&["proofs", "--block", "divder"], "did you mean `divider`?"),
        (&["netlists", "--block", "stage"], "choose from:"),
        (&["coverage", "--block", "divder"], "did you mean `divider`?"),
        (&["lock-step", machine, "--block", "divder"], "did you mean `divider`?"),
        (&["sweep", machine, "--set", "axis.z.shaper.kind=zv"], "there is no `z`"),
        (
            &["sweep", machine, "--set", "axis.x.shaper.kind"],
            "a place and its values are needed",
        ),
        (&["sweep", machine], "--set"),
        (&["faults", "--shard", "0/3"], "is not a shard"),
        (
            &["faults", "--cases", "100", "--unit", "2"],
            "this campaign has 2 units",
        ),
        (&["waveforms", "no-such-file.vcd"], "no-such-file.vcd: cannot read it"),
        (&["merge", "no-such-folder"], "no-such-folder: cannot read the folder"),
    ] {
        let refused = campaign(words);
        assert_eq!(refused.status.code(), Some(2), "{words:?}");
        assert!(said(&refused).contains(expected), "{words:?}: {}", said(&refused));
    }
}
