//! `posicast diff`: exit status and document.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{json, posicast};
use std::path::Path;

fn vcd(folder: &Path, name: &str, values: &[u8]) -> std::path::PathBuf {
    let mut text = "$timescale 1ns $end\n$scope module top $end\n$var wire 1 ! clk $end\n$var wire 4 \" y $end\n\
                    $upscope $end\n$enddefinitions $end\n"
        .to_owned();
    for (clock, value) in values.iter().enumerate() {
        text += &format!("#{}\n0!\nb{value:04b} \"\n#{}\n1!\n", 10 * clock, 10 * clock + 5);
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn cli_diff_distinguishes_equal_different_and_incomparable() {
    let folder = tempfile::tempdir().unwrap();
    let a = vcd(folder.path(), "a.vcd", &[1, 2, 3, 4]);
    let b = vcd(folder.path(), "b.vcd", &[1, 2, 7, 4]);
    let diff = |other: &Path, arguments: &[&str]| {
        let output = posicast()
            .arg("diff")
            .arg(&a)
            .arg(other)
            .arg("--json")
            .args(arguments)
            .output()
            .unwrap();
        (output.status.code(), json(&output.stdout))
    };
    let (code, document) = diff(&a, &[]);
    assert_eq!((code, document["result"].as_str()), (Some(0), Some("equal")));
    let (code, document) = diff(&b, &[]);
    assert_eq!((code, document["result"].as_str()), (Some(1), Some("different")));
    let first = &document["differences"][0];
    assert!(first["signal"].as_str().unwrap().ends_with('y'));
    assert_eq!(
        (first["a"].as_str(), first["b"].as_str(), first["count"].as_u64()),
        (Some("0011"), Some("0111"), Some(1))
    );
    assert!((document["first_time"].as_f64().unwrap() - 25e-9).abs() < 1e-15);
    assert_eq!(diff(&b, &["--tolerance", "4"]).0, Some(0));
    let c = vcd(folder.path(), "c.vcd", &[1]);
    let other = std::fs::read_to_string(&c).unwrap().replace(" y ", " z ");
    std::fs::write(&c, other).unwrap();
    let (code, document) = diff(&c, &[]);
    assert_eq!((code, document["result"].as_str()), (Some(2), Some("incomparable")));
    posicast()
        .arg("diff")
        .args([&a, &b])
        .args(["--clock", "nonesuch"])
        .assert()
        .code(2)
        .stdout("");
}

#[test]
fn cli_diff_refuses_a_truncated_file() {
    let folder = tempfile::tempdir().unwrap();
    let a = vcd(folder.path(), "a.vcd", &[1, 2, 3, 4]);
    let text = std::fs::read_to_string(&a).unwrap();
    let cut = folder.path().join("cut.vcd");
    std::fs::write(&cut, &text[..60]).unwrap();
    let output = posicast().arg("diff").arg(&a).arg(&cut).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.is_empty()), (Some(2), true));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cut.vcd"));
}

#[test]
fn cli_diff_writes_files_that_show_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let a = vcd(folder.path(), "a.vcd", &[1, 2, 3, 4]);
    let b = vcd(folder.path(), "b.vcd", &[1, 2, 7, 4]);
    let at = |name: &str| folder.path().join(name);
    let output = posicast()
        .arg("diff")
        .args([&a, &b])
        .arg("--show")
        .arg(at("first"))
        .arg("--junit")
        .arg(at("junit.xml"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("first divergence at sample 2, 25 ns") && text.ends_with('\n'),
        "{text}"
    );
    assert!(
        text.starts_with("different: 1 of 2 signals differs, compared at 4 samples\n"),
        "{text}"
    );
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("1 of 2 signals differs"), "{said}");
    for name in ["first.vcd", "first.gtkw", "first.sucl", "first.svg"] {
        assert!(at(name).is_file(), "{name}");
    }
    assert!(
        std::fs::read_to_string(at("junit.xml"))
            .unwrap()
            .contains("failures=\"1\"")
    );
}

#[test]
fn cli_diff_options_that_fit_nothing_are_usage_errors() {
    let folder = tempfile::tempdir().unwrap();
    let a = vcd(folder.path(), "a.vcd", &[1, 2, 3, 4]);
    let maps = folder.path().join("maps");
    std::fs::write(&maps, "# one\ntop.y=top.y\n").unwrap();
    let diff = |arguments: &[&str]| posicast().arg("diff").args([&a, &a]).args(arguments).assert();
    for arguments in [
        &["--reset", "nothing"][..],
        &["--only", "nothing"],
        &["--root-a", "nothing"],
        &["--view", "y=q999"],
        &["--latency", "y=5ns"],
        &["--time-tolerance", "5ns"],
        &["--glitch", "5 parsecs"],
        &["--start", "1s"],
        &["--raw", "--clock", "clk"],
        &["--map-file", "absent"],
    ] {
        diff(arguments).code(2);
    }
    let maps = maps.to_str().unwrap();
    diff(&["--map-file", maps, "--latency", "y=-1", "--ignore", "y"]).code(2);
    diff(&[
        "--map-file",
        maps,
        "--view",
        "*=unsigned",
        "--unknown",
        "zero",
        "--start",
        "5ns",
    ])
    .code(0);
    diff(&[
        "--raw",
        "--time-tolerance",
        "1ns",
        "--glitch",
        "1ns",
        "--edge",
        "falling",
    ])
    .code(0);
}
