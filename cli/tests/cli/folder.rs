//! `generate` and `run` in one folder: neither removes what the other wrote, and no evidence outlives its machine
//! file.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{json, one_axis, posicast, scratch};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Returns one axis with a component on the bus: a package with `sopc/`, `driver/` and `docs/`.
fn machine(frequency_hz: &str) -> String {
    let text = one_axis(
        "kind = \"zv\"",
        &format!("frequency_hz = {frequency_hz}\ndamping = 0.1"),
    );
    text + "[axis.encoder]\nfilter_clocks = 8\n"
}

/// Returns every file under a folder, path to contents.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let text = std::fs::read(&path).unwrap();
                files.insert(path.strip_prefix(folder).unwrap().to_owned(), text);
            }
        }
    }
    files
}

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let (folder, _) = scratch(&machine("50.0"));
        std::fs::write(
            folder.path().join("step.csv"),
            "time_s,position\n0,0\n0.001,0.001\n0.002,0.001\n",
        )
        .unwrap();
        Self { folder }
    }

    /// Returns the folder that both commands use by default.
    fn output(&self) -> PathBuf {
        self.folder.path().join("one")
    }

    fn posicast(&self, words: &[&str]) -> assert_cmd::assert::Assert {
        posicast().current_dir(self.folder.path()).args(words).assert()
    }

    fn generate(&self) -> String {
        let assert = self.posicast(&["generate", "machine.toml"]).success();
        String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
    }

    fn run(&self, more: &[&str]) -> assert_cmd::assert::Assert {
        let words = [
            "run",
            "machine.toml",
            "--json",
            "--command",
            "step.csv",
            "--cycles",
            "20000",
        ];
        self.posicast(&[&words, more].concat())
    }
}

#[test]
fn cli_generate_and_run_share_a_folder_without_loss() {
    let bench = Bench::new();
    assert_eq!(bench.generate(), "");
    let generated = snapshot(&bench.output());
    for part in ["sopc", "driver", "docs", "README.md", "rtl", "one.core"] {
        assert!(bench.output().join(part).exists(), "{part}");
    }

    let failed = bench.run(&["--simulator", "icarus"]).get_output().clone();
    assert_eq!(
        failed.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&failed.stderr)
    );
    assert_eq!(String::from_utf8_lossy(&failed.stderr), "");
    let both = snapshot(&bench.output());
    for (path, text) in &generated {
        let is_the_runs = path == Path::new("report.json") || path == Path::new("posicast.json");
        assert!(is_the_runs || both.get(path) == Some(text), "{}", path.display());
    }
    let report = json(&both[Path::new("report.json")]);
    assert_eq!(report["design"], json(&generated[Path::new("report.json")]));
    assert!(bench.output().join("wave/rtl.vcd").is_file() && bench.output().join("plots/response.svg").is_file());

    let said = bench.generate();
    assert!(
        said.contains("kept the evidence") && said.contains("wave/rtl.vcd"),
        "{said}"
    );
    assert_eq!(snapshot(&bench.output()), both);

    // A run that does not complete leaves both unchanged.
    let mut run = posicast();
    run.current_dir(bench.folder.path())
        .args(["run", "machine.toml", "--simulator", "icarus"]);
    run.env("PATH", "")
        .env("IVERILOG", "/nowhere/iverilog")
        .assert()
        .code(3);
    assert_eq!(snapshot(&bench.output()), both);
}

#[test]
fn cli_generate_removes_evidence_of_another_machine_file_and_says_so() {
    let bench = Bench::new();
    bench.run(&["--simulator", "icarus"]).success();
    assert!(
        bench.output().join("sopc").is_dir(),
        "`run` writes what `generate` writes"
    );
    std::fs::write(bench.output().join("notes.txt"), "mine").unwrap();
    std::fs::write(bench.folder.path().join("machine.toml"), machine("51.0")).unwrap();
    let said = bench.generate();
    assert!(
        said.contains("removed the evidence") && said.contains("wave/rtl.vcd"),
        "{said}"
    );
    assert!(!bench.output().join("wave").exists() && !bench.output().join("plots").exists());
    let report = json(&std::fs::read(bench.output().join("report.json")).unwrap());
    assert!(report.get("result").is_none(), "the report is the design's again");
    assert_eq!(std::fs::read(bench.output().join("notes.txt")).unwrap(), b"mine");

    // Edited evidence is not removed: the command is refused instead.
    bench.run(&["--simulator", "icarus"]).success();
    std::fs::write(bench.output().join("wave/merged.gtkw"), "my view").unwrap();
    std::fs::write(bench.folder.path().join("machine.toml"), machine("52.0")).unwrap();
    let before = snapshot(&bench.output());
    let refused = bench.posicast(&["generate", "machine.toml"]).code(2);
    let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(
        said.contains("wave/merged.gtkw") && said.contains("move it away"),
        "{said}"
    );
    assert_eq!(snapshot(&bench.output()), before);
}

#[test]
fn cli_generate_prints_three_lines_and_lists_the_files_on_request() {
    let bench = Bench::new();
    let said = |words: &[&str]| {
        let assert = bench
            .posicast(&[&["generate", "machine.toml"], words].concat())
            .success();
        String::from_utf8(assert.get_output().stdout.clone()).unwrap()
    };
    let summary = said(&[]);
    let files = snapshot(&bench.output());
    let lines: Vec<&str> = summary.lines().collect();
    assert_eq!(lines.len(), 3, "{summary}");
    assert!(
        lines[0].starts_with(&format!("{} files in one: ", files.len())),
        "{summary}"
    );
    assert!(
        lines[0].contains("rtl/ (") && lines[0].contains("README.md"),
        "{summary}"
    );
    assert_eq!(lines[1], "top module: one (the shapers)");
    assert!(lines[2].starts_with("next: read one/README.md"), "{summary}");
    let listed = said(&["--verbose"]);
    let listed: Vec<&Path> = listed.lines().map(Path::new).collect();
    assert_eq!(listed.len(), files.len());
    assert!(
        files
            .keys()
            .all(|file| listed.contains(&Path::new("one").join(file).as_path()))
    );
    let document = json(said(&["--json"]).as_bytes());
    assert_eq!((&document["name"], &document["folder"]), (&"one".into(), &"one".into()));
    assert_eq!(document["top"], serde_json::json!(["one"]));
    assert_eq!(document["files"].as_array().unwrap().len(), files.len());
}

#[test]
fn cli_run_prints_a_summary_and_all_results_on_request() {
    let bench = Bench::new();
    let said = |words: &[&str]| {
        let words = [&["run", "machine.toml", "--simulator", "icarus"], words].concat();
        let run = posicast()
            .current_dir(bench.folder.path())
            .args(words)
            .output()
            .unwrap();
        (run.status.code(), String::from_utf8(run.stdout).unwrap())
    };
    let (status, summary) = said(&[]);
    assert_eq!(status, Some(0), "{summary}");
    assert!((6..=12).contains(&summary.lines().count()), "{summary}");
    for part in [
        "one: ",
        "  x     zv",
        "\nchecks: ",
        " ok\n",
        " files written to one: ",
        "PASS: the Verilog",
    ] {
        assert!(summary.contains(part), "{part:?} in {summary}");
    }
    assert!(
        !summary.contains('\u{1b}') && !summary.contains("ok      "),
        "{summary}"
    );
    let (_, verbose) = said(&["--verbose"]);
    assert!(
        verbose.contains("RTL against model and float design") && verbose.contains("ok      RTL equals"),
        "{verbose}"
    );
    let (_, coloured) = said(&["--quiet", "--color", "always"]);
    assert_eq!(
        coloured,
        "\u{1b}[1m\u{1b}[32mPASS\u{1b}[0m: the Verilog computes what was designed.\n"
    );
    // A command that stands still compares nothing: the check that reports it is always shown.
    std::fs::write(bench.folder.path().join("still.csv"), "time_s,position\n0,0\n0.01,0\n").unwrap();
    {
        let (status, failed) = said(&["--command", "still.csv", "--quiet"]);
        assert_eq!(status, Some(1), "{failed}");
        assert!(
            failed.contains("FAILED  the command moves every axis: ") && failed.contains("likely cause"),
            "{failed}"
        );
        assert!(failed.contains("FAIL: do not put this Verilog"), "{failed}");
    }
}
