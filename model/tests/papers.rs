//! The papers' tables: how many rows end with which verdict, and that none is a fault of ours.
//!
//! The counts are those of the notes on the papers, one row per printed number. A change of them is a change of what
//! posicast says about a paper: it needs a reason.
#![cfg(test)]

use posicast_model::papers::{Paper, Value, Verdict};

/// Reproduced, errata, not comparable.
fn counts(paper: Paper) -> [usize; 3] {
    let rows = paper.reproduce().unwrap();
    let faults: Vec<_> = rows
        .iter()
        .filter(|row| row.verdict == Verdict::NotReproduced)
        .collect();
    assert!(faults.is_empty(), "{faults:#?}");
    [Verdict::Reproduced, Verdict::Erratum, Verdict::NotComparable]
        .map(|verdict| rows.iter().filter(|row| row.verdict == verdict).count())
}

#[test]
fn golden_verdicts_of_hybrid_ei() {
    assert_eq!(counts(Paper::HybridEi), [36, 13, 0]);
}

#[test]
fn golden_verdicts_of_negative_hybrid() {
    assert_eq!(counts(Paper::NegativeHybrid), [71, 43, 0]);
}

#[test]
fn golden_verdicts_of_vibrationless() {
    assert_eq!(counts(Paper::Vibrationless), [8, 11, 0]);
}

#[test]
fn golden_verdicts_of_antisymmetry() {
    assert_eq!(counts(Paper::Antisymmetry), [22, 6, 0]);
}

#[test]
fn golden_verdicts_of_xy_stage() {
    assert_eq!(counts(Paper::XyStage), [31, 18, 9]);
}

#[test]
fn unit_every_row_is_told_from_the_others_and_every_departure_has_its_reason() {
    for paper in Paper::ALL {
        let rows = paper.reproduce().unwrap();
        for (index, row) in rows.iter().enumerate() {
            assert!(rows[..index].iter().all(|other| other.item != row.item), "{}", row.item);
            let needs_reason = matches!(row.verdict, Verdict::Erratum | Verdict::NotComparable);
            assert!(!needs_reason || !row.reason.is_empty(), "{}", row.item);
            assert_eq!(
                row.ours.is_none(),
                row.verdict == Verdict::NotComparable,
                "{}",
                row.item
            );
            if let Value::Number(printed) = row.paper {
                assert!(printed.is_finite(), "{}: {}", row.item, row.printed);
            }
        }
    }
}

#[test]
fn unit_the_figures_have_finite_points() {
    for paper in Paper::ALL {
        let figures = paper.figures().unwrap();
        assert!(!figures.is_empty());
        for curve in figures.iter().flat_map(|figure| &figure.curves) {
            assert!(curve.points.len() > 1, "{}", curve.name);
            assert!(
                curve.points.iter().all(|(x, y)| x.is_finite() && y.is_finite()),
                "{}",
                curve.name
            );
        }
    }
}
