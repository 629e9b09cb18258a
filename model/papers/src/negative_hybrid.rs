//! "negative-hybrid": negative-impulse shapers, a different one per mode, for a robot with two modes.
//!
//! The paper's NZV, NZVD and NEI are our `ps-zv`, `ps-zvd` and `ps-ei`; X-Y means X for mode 1 and Y for mode 2. The
//! paper does not give the shares of the two modes in its step responses; half each is assumed, as its statements
//! about them require.

use super::designs::{amplitudes, hybrid, shaper, times_s};
use super::negative_shapers::{MODES, NEGATIVE, PAIRS, negative, positive};
use super::negative_statements::{self, least, most};
use super::sheet::{Rule, Sheet};
use posicast_shaper::design::DesignError;
use posicast_shaper::mode::Mode;

pub(super) fn rows(sheet: &mut Sheet) -> Result<(), DesignError> {
    single_mode_times(sheet)?;
    convolved_lists(sheet)?;
    durations(sheet)?;
    negative_statements::rows(sheet)
}

/// Printed single-mode times of one kind at one mode.
struct Times {
    /// Index into [`NEGATIVE`].
    kind: usize,
    /// Index into [`MODES`].
    mode: usize,
    /// Times in ms, each with whether eq. (2) with undamped frequencies gives it.
    printed_ms: &'static [(&'static str, bool)],
}

const TIMES: [Times; 6] = [
    Times {
        kind: 0,
        mode: 0,
        printed_ms: &[("2.90", false), ("3.86", true)],
    },
    Times {
        kind: 1,
        mode: 0,
        printed_ms: &[("2.17", true), ("3.70", false), ("8.49", false), ("9.00", false)],
    },
    Times {
        kind: 2,
        mode: 0,
        printed_ms: &[("2.24", true), ("3.76", false), ("8.53", false), ("9.07", false)],
    },
    Times {
        kind: 0,
        mode: 1,
        printed_ms: &[("0.93", false), ("1.26", true)],
    },
    Times {
        kind: 1,
        mode: 1,
        printed_ms: &[("0.68", true), ("1.21", true), ("2.76", true), ("2.95", true)],
    },
    Times {
        kind: 2,
        mode: 1,
        printed_ms: &[("0.70", true), ("1.23", true), ("2.77", true), ("2.97", true)],
    },
];
/// The only printed time that neither reading of the frequencies gives.
const NEITHER: &str = "0.93";

/// Adds the times behind Tables 3 and 4, under both readings of the measured frequencies.
fn single_mode_times(sheet: &mut Sheet) -> Result<(), DesignError> {
    const AS_DAMPED: &str = "the tables take T = √(1−ζ²)/f, against the paper's own eq. (2): it fits if the measured \
                             frequencies are damped ones";
    const UNDER_NEITHER: &str = "0.92 under either reading of the measured frequencies";
    for Times { kind, mode, printed_ms } in TIMES {
        let (name, kind) = NEGATIVE[kind];
        let at = MODES[mode];
        let damped = Mode {
            frequency_hz: at.frequency_hz / (1.0 - at.damping * at.damping).sqrt(),
            ..at
        };
        let by_equation = times_s(&shaper(kind, &[at])?);
        let as_damped = times_s(&shaper(kind, &[damped])?);
        let found = by_equation.iter().zip(&as_damped);
        for (index, ((printed, agrees), (by_equation, as_damped))) in printed_ms.iter().zip(found).enumerate() {
            let item = |reading: &str| {
                let impulse = index + 2;
                format!("Tables 3, 4: {name} at mode {}, t{impulse} in ms, {reading}", mode + 1)
            };
            let reason = if *printed == NEITHER { UNDER_NEITHER } else { AS_DAMPED };
            if *agrees {
                sheet.equal(item("eq. (2)"), *printed, by_equation * 1e3);
            } else {
                sheet.erratum(item("eq. (2)"), *printed, by_equation * 1e3, reason);
            }
            if *printed == NEITHER {
                sheet.erratum(item("f read as damped"), *printed, as_damped * 1e3, reason);
            } else {
                sheet.equal(item("f read as damped"), *printed, as_damped * 1e3);
            }
        }
    }
    Ok(())
}

/// Adds the rows of Tables 3 and 4: impulses, amplitudes, last times.
fn convolved_lists(sheet: &mut Sheet) -> Result<(), DesignError> {
    const LAST_MS: [&str; 6] = ["6.81", "6.83", "10.26", "11.97", "10.33", "12.02"];
    const COUNT: [&str; 6] = ["15", "15", "15", "25", "15", "25"];
    for ((pair, last), count) in PAIRS.into_iter().zip(LAST_MS).zip(COUNT) {
        let (name, convolved) = negative(pair)?;
        sheet.equal(
            format!("Tables 3, 4: impulses of {name}"),
            count,
            convolved.impulses().len() as f64,
        );
        // The paper prints the amplitudes as products of 1, −2, 2(, −2, 2), not in order of time, so they are
        // compared as sorted sets.
        let factors = [pair.0, pair.1].map(|k| {
            if k == 0 {
                &[1.0, -2.0, 2.0][..]
            } else {
                &[1.0, -2.0, 2.0, -2.0, 2.0]
            }
        });
        let mut products: Vec<f64> = factors[0]
            .iter()
            .flat_map(|a| factors[1].iter().map(move |b| a * b))
            .collect();
        let mut found = amplitudes(&convolved);
        products.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        sheet.formula(format!("Tables 3, 4: amplitudes of {name}, sorted"), products, found);
        let as_damped = MODES.map(|m| Mode {
            frequency_hz: m.frequency_hz / (1.0 - m.damping * m.damping).sqrt(),
            ..m
        });
        let convolved = hybrid(&[(NEGATIVE[pair.0].1, as_damped[0]), (NEGATIVE[pair.1].1, as_damped[1])])?;
        sheet.by_rule(
            format!("Tables 3, 4: last time of {name} in ms, f read as damped"),
            last,
            convolved.duration_s() * 1e3,
            Rule::Within(0.01),
            "printed as the sum of two times that are rounded to 10 µs each",
        );
    }
    // These are two times as the paper prints them; every other entry is the sum of two such times.
    let (second_of_nei, first_of_nzv) = (2.24, 0.93);
    sheet.erratum(
        "Table 4: NEI-NZV, t in ms that is the sum of the printed 2.24 and 0.93",
        "3.16",
        second_of_nei + first_of_nzv,
        "every other entry of Tables 3 and 4 is the sum of two printed single-mode times; this one is not",
    );
    Ok(())
}

/// Table 5 as printed: positive duration, negative duration, saving in percent, saving in seconds.
const TABLE_5: [[&str; 4]; 6] = [
    ["10.5", "6.4", "39.04", "0.0041"],
    ["10.8", "6.9", "36.11", "0.0039"],
    ["15.1", "10.0", "33.77", "0.0051"],
    ["17.7", "13.4", "24.29", "0.0043"],
    ["15.4", "10.2", "33.77", "0.0052"],
    ["17.4", "12.7", "27.01", "0.0047"],
];

fn durations(sheet: &mut Sheet) -> Result<(), DesignError> {
    const READ_OFF: &str = "not the shaper's duration; it contradicts Tables 3 and 4, too: probably read off a plot";
    const FROM_COLUMNS: &str = "from the two columns of the table, which themselves are wrong";
    let mut savings = Vec::new();
    let mut longest = (String::new(), 0.0);
    for (pair, printed) in PAIRS.into_iter().zip(TABLE_5) {
        let (positive_name, positive) = positive(pair)?;
        let (negative_name, negative) = negative(pair)?;
        let [positive_s, negative_s] = [positive.duration_s(), negative.duration_s()];
        let saving = 100.0 * (1.0 - negative_s / positive_s);
        savings.push(saving);
        if negative_s > longest.1 {
            longest = (negative_name.clone(), negative_s);
        }
        let positive_item = format!("Table 5: {positive_name} in ms");
        match positive_name.as_str() {
            "EI-ZVD" => sheet.equal(positive_item, printed[0], positive_s * 1e3),
            "ZV-EI" => sheet.by_rule(
                positive_item,
                printed[0],
                positive_s * 1e3,
                Rule::Within(0.07),
                "agrees to 0.07 ms",
            ),
            _ => sheet.erratum(positive_item, printed[0], positive_s * 1e3, READ_OFF),
        }
        let negative_item = format!("Table 5: {negative_name} in ms");
        sheet.erratum(negative_item, printed[1], negative_s * 1e3, READ_OFF);
        let item = |what: &str| format!("Table 5: saving of {negative_name}, {what}");
        // This repeats the paper's arithmetic on its own columns.
        let columns = [printed[0], printed[1]].map(|n| n.parse().unwrap_or(f64::NAN));
        let of_columns = 100.0 * (1.0 - columns[1] / columns[0]);
        if printed[2] == "39.04" {
            let note = "truncated in print; 39.05 rounded";
            sheet.by_rule(
                item("%, of the printed columns"),
                printed[2],
                of_columns,
                Rule::Truncated,
                note,
            );
        } else {
            sheet.equal(item("%, of the printed columns"), printed[2], of_columns);
        }
        let seconds = (columns[0] - columns[1]) * 1e-3;
        sheet.equal(item("s, of the printed columns"), printed[3], seconds);
        sheet.erratum(item("%"), printed[2], saving, FROM_COLUMNS);
    }
    let (least, most) = (least(&savings), most(&savings));
    sheet.erratum(
        "text: smallest saving, %",
        "24.29",
        least,
        "it is EI-ZVD's; Table 5's columns are wrong",
    );
    sheet.erratum(
        "text: largest saving, %",
        "39.04",
        most,
        "it is ZV-ZVD's; Table 5's columns are wrong",
    );
    sheet.refuted(
        "Table 5: the longest negative hybrid",
        "NZVD-NEI",
        format!("{}, {:.3} ms", longest.0, longest.1 * 1e3),
        longest.0 == "NZVD-NEI",
        "Table 5's columns are wrong",
    );
    Ok(())
}
