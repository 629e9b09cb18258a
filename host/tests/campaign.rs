//! The fault campaign of the host link, in a few cases and in many.

#[path = "../examples/link_campaign/campaign/mod.rs"]
#[allow(dead_code)] // The table of the example reads more of an outcome.
mod cases;

use cases::Kind;

fn run(cases: std::ops::Range<u64>, seed: u64) {
    let all = cases::run(cases.clone(), seed).unwrap();
    assert_eq!(all.len() as u64, cases.end - cases.start);
    for (number, outcome) in all {
        assert!(
            outcome.failures.is_empty(),
            "case {number}, {}: {:?}",
            outcome.kind.name(),
            outcome.failures
        );
        assert!(outcome.writes > 0 || outcome.kind != Kind::None);
    }
}

#[test]
fn the_comparison_finds_wrong_writes() {
    cases::comparison_finds_wrong_writes();
}

/// One case of each kind.
#[test]
fn prop_no_fault_of_line_or_host_writes_wrongly_or_leaves_outputs_on() {
    run(0..Kind::ALL.len() as u64, 1);
}

#[test]
fn long_a_thousand_faults_of_line_and_host() {
    run(0..1000, 2);
}
