//! The papers' tables: how many rows have which verdict, and that none is a bug of ours.
//!
//! The counts are those of the notes on the papers, one row per printed number. If they change, posicast says
//! something else about a paper, which needs a reason.

use posicast_papers::{Paper, PaperVerdict, Value};

/// Returns the numbers of reproduced, erratum and not comparable rows.
fn counts(paper: Paper) -> [usize; 3] {
    let rows = paper.reproduce().unwrap();
    let faults: Vec<_> = rows
        .iter()
        .filter(|row| row.verdict == PaperVerdict::NotReproduced)
        .collect();
    assert!(faults.is_empty(), "{faults:#?}");
    [
        PaperVerdict::Reproduced,
        PaperVerdict::Erratum,
        PaperVerdict::NotComparable,
    ]
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
    assert_eq!(counts(Paper::XyStage), [35, 21, 4]);
}

#[test]
fn every_row_is_told_from_the_others_and_every_departure_has_its_reason() {
    for paper in Paper::ALL {
        let rows = paper.reproduce().unwrap();
        for (index, row) in rows.iter().enumerate() {
            assert!(rows[..index].iter().all(|other| other.item != row.item), "{}", row.item);
            let needs_reason = matches!(row.verdict, PaperVerdict::Erratum | PaperVerdict::NotComparable);
            assert!(!needs_reason || !row.reason.is_empty(), "{}", row.item);
            assert_eq!(
                row.ours.is_none(),
                row.verdict == PaperVerdict::NotComparable,
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
fn the_figures_have_finite_points() {
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

/// The correct values that replace the errata, recomputed elsewhere, to the digits given there.
#[test]
fn golden_our_numbers_of_the_errata() {
    let cases: [(Paper, &str, &[f64], f64); 17] = [
        (Paper::HybridEi, "Table 2: residual of EI at 10.36", &[44.53], 5e-3),
        (Paper::HybridEi, "Table 2: residual of ZVD at 16.614", &[6.907], 5e-4),
        (Paper::HybridEi, "Table 2: residual of ZVD at 17.2", &[4.759], 5e-4),
        (Paper::HybridEi, "Table 2: residual of Multi-EI at 17.2", &[1.371], 5e-4),
        (Paper::HybridEi, "text: no 2λ exceeds", &[1.183], 5e-4),
        (Paper::NegativeHybrid, "Table 5: ZV-ZVD in ms", &[10.864], 5e-4),
        (Paper::NegativeHybrid, "Table 5: NZVD-NEI in ms", &[11.991], 5e-4),
        (Paper::NegativeHybrid, "text: smallest saving", &[30.75], 5e-3),
        (Paper::NegativeHybrid, "text: vibration of NEI-NEI", &[16.91], 5e-3),
        (Paper::Vibrationless, "Table 1: Δ, n = 2", &[0.142_838_8], 5e-8),
        (
            Paper::Vibrationless,
            "Table 1: frequencies, n = 3",
            &[0.740_223_7, 0.992_028_4, 1.255_081_2],
            5e-8,
        ),
        (
            Paper::Vibrationless,
            "Table 1: Δ of the printed frequencies, n = 3",
            &[0.1146],
            5e-5,
        ),
        (
            Paper::Antisymmetry,
            "Table 2: three impulses",
            &[0.299_84, 0.495_973, 0.204_187],
            2e-6,
        ),
        (
            Paper::Antisymmetry,
            "text: vibration after two impulses",
            &[0.0553],
            5e-5,
        ),
        (
            Paper::XyStage,
            "chapter 3: overshoot with ZVD, plant −10 %, X",
            &[1.501],
            5e-4,
        ),
        (
            Paper::XyStage,
            "Table 2-1: K_S of Y in N/µm, with its own",
            &[53.21],
            5e-3,
        ),
        (Paper::XyStage, "Table 2-2: K_t", &[0.3495], 5e-5),
    ];
    let tables = Paper::ALL.map(|paper| (paper, paper.reproduce().unwrap()));
    for (paper, item, expected, tolerance) in cases {
        let (_, rows) = tables.iter().find(|(other, _)| *other == paper).unwrap();
        let row = rows.iter().find(|row| row.item.starts_with(item)).unwrap();
        assert_eq!(row.verdict, PaperVerdict::Erratum, "{item}");
        let ours = match row.ours.clone().unwrap() {
            Value::Number(number) => vec![number],
            Value::Numbers(numbers) => numbers,
            Value::Text(text) => panic!("{item}: {text}"),
        };
        assert_eq!(ours.len(), expected.len(), "{item}");
        for (ours, expected) in ours.iter().zip(expected) {
            assert!(
                (ours - expected).abs() <= tolerance,
                "{item}: {ours} instead of {expected}"
            );
        }
    }
}
