//! `[axis.error_table]`, and the CSV file beside the machine file.

use posicast_blocks::error_table::{EntryUnit, MOST_ENTRIES};
use posicast_blocks::stage::{StageErrorTable, StageSchedule};
use posicast_machine::hardware;
use posicast_machine::machine_file::{ErrorUse, Machine, SpecError, parse_beside};
use posicast_machine::plan::design_machine;
use proptest::prelude::*;

use super::files::XY_STAGE;

/// Returns the example, whose axis X has a table with this file.
fn with_table(keys: &str, csv: &str) -> Result<Machine, SpecError> {
    let table = format!("[axis.error_table]\n{keys}\n\n[axis.limits]");
    let text = XY_STAGE.replacen("[axis.limits]", &table, 1);
    parse_beside("m.toml", &text, &|name| match name {
        "errors.csv" => Ok(csv.to_owned()),
        _ => Err("cannot be read: no such file".to_owned()),
    })
}

fn built(machine: &Machine) -> StageErrorTable {
    let stage = hardware::stage(machine, &design_machine(machine).unwrap());
    let stage = stage.unwrap_or_else(|error| panic!("{error}")).unwrap();
    assert!(stage.config.axes[1].error_table.is_none());
    stage.config.axes[0].error_table.clone().unwrap()
}

const FILE: &str = "file = \"errors.csv\"";

#[test]
fn points_become_entries_of_the_hardware() {
    // 1 µm per count, 200 mm: 2^10 counts apart are 197 entries; 4 µm more in each 100 mm.
    let csv = "# laser\nposition,error\n-0.1,-0.000004\n0,0\n0.1,0.000004\n";
    let machine = with_table(FILE, csv).unwrap();
    let section = machine.axes[0].error_table.as_ref().unwrap();
    assert_eq!((section.apply, section.points.len()), (ErrorUse::Reference, 3));
    let of = built(&machine);
    let format = of.table.format();
    assert_eq!((format.first_counts, format.spacing_bits), (-100_000, 10));
    assert_eq!((format.unit, of.on_measured), (EntryUnit::Fine, false));
    assert_eq!((of.table.entries().len(), of.table.entries()[0]), (197, -1024));
    // Behind the last point its error stays.
    assert_eq!(of.table.entries()[196], 1024);
    // In the middle: −100,000 + 98 · 1024 is 352 counts behind 0.
    assert_eq!(of.table.entries()[98], (352.0 * 4e-5 * 256.0_f64).round() as i32);
    assert!(hardware::error_table_departure_counts(&machine.axes[0], &of.table) < 0.02);
}

#[test]
fn large_errors_are_in_sixteenths_and_feedback_is_measured() {
    let keys = format!("{FILE}\napply = \"feedback\"");
    let machine = with_table(&keys, "-0.1,0.0006\n0.1,-0.0006").unwrap();
    let of = built(&machine);
    assert_eq!((of.table.format().unit, of.on_measured), (EntryUnit::Coarse, true));
    assert_eq!(of.table.entries()[0], 600 * 16);
}

#[test]
fn a_stage_with_a_table_takes_its_clocks_longer() {
    let machine = with_table(FILE, "-0.1,0\n0.1,0").unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap())
        .unwrap()
        .unwrap();
    let latency = built(&machine).table.latency_clocks();
    assert_eq!(latency, 76);
    let shaper = &stage.config.axes[0].shaper;
    let [without, with] =
        [0, latency].map(|clocks| StageSchedule::of(&[(shaper, clocks)], true, false, 0).control_clocks());
    assert!(with > without && with <= without + latency, "{without}, {with}");
}

#[track_caller]
fn refused(keys: &str, csv: &str, found: &str) {
    let error = with_table(keys, csv).expect_err("the file is wrong");
    assert_eq!(error.problems().len(), 1, "{error}");
    let problem = &error.problems()[0];
    assert_eq!(problem.key, "axis.error_table.file");
    assert!(!problem.remedy.is_empty());
    let said = error.to_string();
    assert!(said.contains(found), "{said}");
}

#[test]
fn what_is_wrong_with_a_file_is_said_with_its_row() {
    for (csv, found) in [
        ("", "errors.csv: no row of numbers"),
        ("position,error\n0,0\n", "errors.csv: one row of numbers"),
        ("-0.1,0\n0.1,nan", "errors.csv: row 2, `0.1,nan`"),
        ("-0.1,0\n0.05\n0.1,0", "errors.csv: row 2, `0.05`"),
        ("-0.1,0\n0.05,0,0\n0.1,0", "errors.csv: row 2, `0.05,0,0`"),
        ("travel,error\n-0.1,0\n0.1,0", "errors.csv: row 1, `travel,error`"),
        (
            "-0.1,0\n0.1,0\n0.05,0",
            "errors.csv: row 3, the position 0.05 after 0.1",
        ),
        ("-0.1,0\n0,0\n0,0\n0.1,0", "errors.csv: row 3, the position 0 after 0"),
        (
            "-0.1,0\n0,0.02\n0.1,0.02",
            "errors.csv: row 2, an error that changes by 0.2 of the way",
        ),
        ("-0.1,0\n0.09,0", "errors.csv: rows 1 to 2, positions -0.1 to 0.09"),
        ("-0.05,0\n0.1,0", "positions that cover the travel, -0.1 to 0.1"),
        (
            "-0.1,0.009\n0.1,0.009",
            "errors.csv: row 1, position -100000 and error 9000 counts",
        ),
        ("-0.1,0\n9,0", "errors.csv: row 2, position 9000000"),
    ] {
        refused(FILE, csv, found);
    }
    let many: String = (0..=10_000)
        .map(|row| format!("{},0\n", f64::from(row) * 1e-4 - 0.2))
        .collect();
    refused(FILE, &many, "errors.csv: row 10001, one more than 10000");
}

#[test]
fn the_file_is_beside_the_machine_file() {
    refused("file = \"none.csv\"", "", "none.csv: cannot be read: no such file");
    for name in ["../errors.csv", "/errors.csv", "errors.txt", ".csv", "a\\\\b.csv"] {
        refused(&format!("file = \"{name}\""), "", "a name that ends in .csv");
    }
    refused("apply = \"feedback\"", "", "axis.error_table.file");
    let plain = posicast_machine::machine_file::parse(
        "m.toml",
        &XY_STAGE.replacen(
            "[axis.limits]",
            &format!("[axis.error_table]\n{FILE}\n[axis.limits]"),
            1,
        ),
    );
    assert!(plain.unwrap_err().to_string().contains("not read here"));
}

#[test]
fn axes_that_cannot_have_one_say_so() {
    let good = "-0.1,0\n0.1,0";
    let text = XY_STAGE.replacen(
        "[axis.limits]",
        &format!("[axis.error_table]\n{FILE}\n\n[axis.limits]"),
        1,
    );
    let of = |text: &str| {
        parse_beside("m.toml", text, &|_| Ok(good.to_owned()))
            .unwrap_err()
            .to_string()
    };
    let said = of(&text.replacen(
        "counts_per_unit = 1_000_000",
        "counts_per_unit = 1_000_000\nmodulo = true",
        1,
    ));
    assert!(said.contains("does not wrap"), "{said}");
    let scale = "[axis.scale]\ncounts_per_unit = 1_000_000\nuse = \"position\"\n\n[axis.error_table]";
    let said = of(&text.replacen("[axis.error_table]", scale, 1));
    assert!(said.contains("whose loop runs on its scale"), "{said}");
}

proptest! {
    /// For any measurement, the hardware accepts the table, which has the measured errors at its entries.
    #[test]
    fn prop_every_file_that_is_read_can_be_built(
        steps in proptest::collection::vec((1e-5f64..0.02, -0.05f64..0.05), 20..200),
        start in -0.5f64..-0.1,
    ) {
        let (mut position, mut error) = (start, 0.0);
        let mut csv = format!("{position},{error}\n");
        for (step, slope) in steps {
            position += step;
            error = (error + 0.99 * slope * step).clamp(-0.008, 0.008);
            csv += &format!("{position},{error}\n");
        }
        prop_assume!(position > 0.1 && position < 8.0);
        let machine = with_table(FILE, &csv).unwrap_or_else(|error| panic!("{error}"));
        let table = built(&machine).table;
        let format = table.format();
        prop_assert!(table.entries().len() <= MOST_ENTRIES);
        let section = machine.axes[0].error_table.as_ref().unwrap();
        for (index, entry) in (0..).zip(table.entries()) {
            let place = f64::from(format.first_counts) + f64::from(index << format.spacing_bits);
            let exact = section.at(place * 1e-6) * 1e6 / format.unit.counts();
            prop_assert!((f64::from(*entry) - exact).abs() <= 0.5 + 1e-6);
        }
    }
}
