//! The papers' tables: every row ends as agreed, and how many of each verdict there are.
#![cfg(test)]

use posicast_model::papers::{Paper, Verdict};

fn count(paper: Paper) -> [usize; 4] {
    let rows = paper.reproduce().unwrap();
    for row in &rows {
        println!(
            "{:14} {} | {} | {:?} | {}",
            row.verdict, row.item, row.printed, row.ours, row.reason
        );
    }
    [
        Verdict::Reproduced,
        Verdict::Erratum,
        Verdict::NotComparable,
        Verdict::NotReproduced,
    ]
    .map(|verdict| rows.iter().filter(|row| row.verdict == verdict).count())
}

#[test]
fn golden_xy_stage() {
    assert_eq!(count(Paper::XyStage), [0, 0, 0, 0]);
}
