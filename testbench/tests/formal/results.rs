//! The results of proofs that were computed already, in `formal/results.txt`.
//!
//! A proof takes seconds to a minute, and its result changes only with what Yosys is given. So the file has a line for each task:
//! its fingerprint, the block, what was asked, and the answer. A task whose Verilog, properties or scripts changed is not in the
//! file, and is computed. `POSICAST_PROVE_AGAIN=1` computes all, as `scripts/verify-all` does. `scripts/record-proofs` writes the
//! file: it names another one in `POSICAST_RECORD_PROOFS`, to which each test appends its line.

use std::fs::File;
use std::io::Write as _;

use posicast_testbench::formal::Task;

const RESULTS: &str = include_str!("../../formal/results.txt");

/// The answer to what is `asked` of a task: that of the file, or else that of `compute`.
pub(crate) fn known_or(task: &Task, asked: &str, compute: impl FnOnce() -> String) -> String {
    let begin = beginning(task, asked);
    let again = std::env::var_os("POSICAST_PROVE_AGAIN").is_some();
    let answer = match recorded(&begin) {
        Some(answer) if !again => answer.to_owned(),
        _ => compute(),
    };
    if let Some(path) = std::env::var_os("POSICAST_RECORD_PROOFS") {
        let mut file = File::options().append(true).create(true).open(path).unwrap();
        file.write_all(format!("{begin}{answer}\n").as_bytes()).unwrap();
    }
    answer
}

/// The part of a line before the answer.
fn beginning(task: &Task, asked: &str) -> String {
    format!("{} {} | {asked} | ", task.fingerprint(), task.name)
}

/// The answer of the line that begins in this way.
fn recorded(beginning: &str) -> Option<&'static str> {
    RESULTS.lines().find_map(|line| line.strip_prefix(beginning))
}

/// A proof that is not in the file is computed in every run of the tests, without a word.
#[test]
fn every_proof_is_recorded() {
    let proofs = posicast_testbench::blocks::proofs().unwrap();
    assert!(proofs.len() > 1);
    let is_missing = |task: &&Task| recorded(&beginning(task, "proven")).is_none();
    let missing: Vec<&str> = proofs.iter().filter(is_missing).map(|task| task.name).collect();
    assert!(
        missing.is_empty(),
        "{} of {} proofs are not in testbench/formal/results.txt; `scripts/record-proofs` writes it: {missing:?}",
        missing.len(),
        proofs.len()
    );
}

#[test]
fn a_fingerprint_changes_with_verilog_properties_and_engine_but_no_comment() {
    let proof = || {
        posicast_testbench::blocks::proofs_named("group")
            .unwrap()
            .swap_remove(0)
    };
    let same = proof().fingerprint();
    assert_eq!(proof().fingerprint(), same);
    let mut verilog = proof();
    verilog.modules[0].text.push('\n');
    let mut engine = proof();
    engine.engine = posicast_testbench::formal::Engine::Induction { clocks: 7 };
    let mut comment = proof();
    comment.modules[0].text.insert_str(0, "// A word about it.\n");
    assert_eq!(comment.fingerprint(), same);
    let other_properties = posicast_testbench::blocks::proofs_named("divider")
        .unwrap()
        .swap_remove(0);
    for other in [verilog, engine, other_properties] {
        assert_ne!(other.fingerprint(), same);
    }
}

#[test]
fn each_result_has_a_line_of_its_own() {
    let mut lines: Vec<&str> = RESULTS.lines().collect();
    lines.dedup();
    assert!(lines.is_sorted() && lines.len() == RESULTS.lines().count());
    assert!(lines.iter().all(|line| line.split(" | ").count() == 3));
}
