//! Recordings of one counter by several tools are equal to each other. The reader itself is tested on them beside `vcd` and
//! `wellen`, in `src/reader/agreement.rs`.

use std::path::{Path, PathBuf};

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict, Reset};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures/waves")
        .join(name)
}

fn compare(a: &str, b: &str, options: &DiffOptions) -> Comparison {
    diff::compare(&fixture(a), &fixture(b), options, &mut |_| {}).unwrap()
}

/// Returns options for the counter's ports after its reset, by the clock of the bench. The top scope is that of the
/// first file.
fn ports(top: &str) -> DiffOptions {
    let mut options = DiffOptions {
        clock: Some(format!("{top}clk")),
        // GHDL's clock runs for one more edge.
        end_fs: Some(400_000_000),
        ..DiffOptions::default()
    };
    options.set_reset(&format!("{top}rst")).unwrap();
    for port in ["clk", "rst", "dut.enable", "dut.count", "dut.wide", "dut.gray"] {
        options.only.push(port.to_owned());
    }
    options
}

#[test]
fn golden_every_producer_recorded_the_same_counter() {
    let files = [
        "verilator.vcd",
        "icarus.vcd",
        "icarus.fst",
        "ghdl.vcd",
        "ghdl.fst",
        "rusthdl.vcd",
        "modelsim_style.vcd",
    ];
    for a in files {
        let top = match a {
            "rusthdl.vcd" => "uut.",
            // GHDL leaves the top scope out of an FST.
            "ghdl.fst" => "",
            _ => "tb.",
        };
        for b in files {
            let result = compare(a, b, &ports(top));
            assert_eq!(result.result, DiffVerdict::Equal, "{a} {b}: {result}");
            assert!(result.samples >= 36, "{a} {b}: {result}");
            let compared = |port: &str| result.compared.iter().any(|(name, _)| name.contains(port));
            assert!(
                ["dut.count", "dut.wide", "dut.gray"].into_iter().all(compared),
                "{a} {b}: {result}"
            );
        }
    }
}

#[test]
fn golden_unrecorded_periods_are_not_compared() {
    for (a, b) in [
        ("icarus.vcd", "icarus_dumpoff.vcd"),
        ("icarus_dumpoff.vcd", "icarus.vcd"),
    ] {
        let sampled = compare(a, b, &ports("tb."));
        assert_eq!((sampled.result, sampled.samples), (DiffVerdict::Equal, 27), "{sampled}");
        assert!(
            sampled
                .to_string()
                .contains("not recorded in one file ($dumpoff) and not compared: 10 samples"),
            "{sampled}"
        );
        let raw = compare(
            a,
            b,
            &DiffOptions {
                raw: true,
                ..DiffOptions::default()
            },
        );
        assert_eq!(raw.result, DiffVerdict::Equal, "{raw}");
        assert!(raw.to_string().contains("not recorded"), "{raw}");
    }
}

#[test]
fn an_edge_that_one_file_lacks_before_a_pause_counts_the_same_in_both_orders() {
    let whole = fixture("icarus_dumpoff.vcd");
    let content = std::fs::read_to_string(&whole).unwrap();
    // From 1 over x to 1 is no rising edge.
    let lacking = content.replace("#80000\nb1000 '\n0$\n", "#80000\nb1000 '\nx$\n");
    assert_ne!(content, lacking);
    let lacks = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(lacks.path(), lacking).unwrap();
    let [one_way, other_way] = [(whole.as_path(), lacks.path()), (lacks.path(), whole.as_path())].map(|(a, b)| {
        let found = diff::compare(a, b, &DiffOptions::default(), &mut |_| {}).unwrap();
        let counts = found.differences.iter().map(|of| (of.signal.clone(), of.count));
        (found.samples, counts.collect::<Vec<_>>())
    });
    assert_eq!(one_way, other_way);
}

#[test]
fn golden_simulators_meet_on_all_signals_but_what_only_one_writes() {
    let mut options = DiffOptions {
        clock: Some("tb.clk".to_owned()),
        reset: Reset::Found,
        ..DiffOptions::default()
    };
    let whole = compare("icarus.vcd", "verilator.vcd", &options);
    // Icarus names `flag$bit` and `odd.name` with the backslash of their escape, and does not write arrays.
    assert_eq!(whole.result, DiffVerdict::Equal, "{whole}");
    assert_eq!(
        whole.only_in_b,
        ["TOP.tb.dut.history[0]", "TOP.tb.dut.history[1]"],
        "{whole}"
    );
    assert!(whole.only_in_a.is_empty() && whole.not_compared.is_empty(), "{whole}");
    options.require_all = true;
    assert_eq!(
        compare("icarus.vcd", "verilator.vcd", &options).result,
        DiffVerdict::Different
    );
}
