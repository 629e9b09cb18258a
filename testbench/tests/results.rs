//! The results of proofs that were computed already, in `formal/results.txt`.
//!
//! A proof takes seconds to a minute, and its result changes only with what Yosys is given. So the file has a line for each task:
//! its fingerprint, the block, what was asked, and the answer. A task whose Verilog, properties or scripts changed is not in the
//! file, and is computed. `POSICAST_PROVE_AGAIN=1` computes all, as `scripts/verify-all` does. `scripts/record-proofs` writes the
//! file: it names another one in `POSICAST_RECORD_PROOFS`, to which each test appends its line.

use std::fs::File;
use std::io::Write as _;

use libtest_mimic::{Failed, Trial as Test};
use posicast_testbench::formal::Task;

const RESULTS: &str = include_str!("../formal/results.txt");

/// The tests of the file and of the fingerprints.
pub(crate) fn tests() -> Vec<Test> {
    let test = |name: &str, check: fn()| {
        Test::test(format!("formal::{name}"), move || -> Result<(), Failed> {
            check();
            Ok(())
        })
    };
    vec![
        test(
            "a_fingerprint_changes_with_verilog_properties_and_engine_but_no_comment",
            a_fingerprint_changes_with_verilog_properties_and_engine_but_no_comment,
        ),
        test("each_result_has_a_line_of_its_own", each_result_has_a_line_of_its_own),
    ]
}

/// What is asked of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Question {
    /// How many assertions and covers it has; it is proven.
    IsProven,
    /// Which property a counterexample violates.
    Counterexample,
    /// Whether the proof does not succeed.
    IsUnproven,
}

impl Question {
    /// Its words in the file.
    fn words(self) -> &'static str {
        match self {
            Self::IsProven => "proven",
            Self::Counterexample => "counterexample",
            Self::IsUnproven => "no proof",
        }
    }
}

/// The answer to a question about a task: that of the file, or else that of `compute`.
pub(crate) fn known_or(task: &Task, question: Question, compute: impl FnOnce() -> String) -> String {
    let begin = beginning(task, question);
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
fn beginning(task: &Task, question: Question) -> String {
    format!("{} {} | {} | ", task.fingerprint(), task.name, question.words())
}

/// Whether the file has the answer.
pub(crate) fn is_recorded(task: &Task, question: Question) -> bool {
    recorded(&beginning(task, question)).is_some()
}

/// The answer of the line that begins in this way.
fn recorded(beginning: &str) -> Option<&'static str> {
    RESULTS.lines().find_map(|line| line.strip_prefix(beginning))
}

fn a_fingerprint_changes_with_verilog_properties_and_engine_but_no_comment() {
    let proof = || {
        posicast_testbench::blocks::proofs_named("group")
            .unwrap()
            .swap_remove(0)
    };
    let same = proof().fingerprint();
    assert_eq!(proof().fingerprint(), same);
    let mut verilog = proof();
    verilog.modules[0].text.push_str("wire other;\n");
    let mut engine = proof();
    engine.engine = posicast_testbench::formal::Engine::Induction { clocks: 7 };
    let mut comment = proof();
    comment.modules[0].text.insert_str(0, "// A word about it.\n");
    let behind_code = comment.modules[0].text.replacen(";\n", "; // what it is\n", 1);
    assert_ne!(behind_code, comment.modules[0].text);
    comment.modules[0].text = behind_code;
    assert_eq!(comment.fingerprint(), same);
    let other_properties = posicast_testbench::blocks::proofs_named("divider")
        .unwrap()
        .swap_remove(0);
    for other in [verilog, engine, other_properties] {
        assert_ne!(other.fingerprint(), same);
    }
}

fn each_result_has_a_line_of_its_own() {
    let mut lines: Vec<&str> = RESULTS.lines().collect();
    lines.dedup();
    assert!(lines.is_sorted() && lines.len() == RESULTS.lines().count());
    assert!(lines.iter().all(|line| line.split(" | ").count() == 3));
}
