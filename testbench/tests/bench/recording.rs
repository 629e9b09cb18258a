//! Tests a recorded move: it has the machine's own clock and true times, and loses no change where clocks are left out.

use std::path::Path;

use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::shaper::ShaperConfig;
use posicast_hdl::machine::AxisShaper;
use posicast_taps::{Tap, TapTable};
use posicast_testbench::blocks::Block;
use posicast_testbench::lockstep::TwoValued;
use posicast_testbench::recording::{Move, RecordedMove};
use posicast_testbench::shaper::MachineShapers;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

use crate::bench::waves::{read, times_of_ones};

const SAMPLE_HZ: f64 = 10e3;
const SAMPLES: usize = 40;
/// Duration of the two clocks of reset in nanoseconds.
const RESET_NS: u64 = 40;

fn machine() -> MachineShapers {
    let half = |delay_samples| Tap {
        delay_samples,
        coefficient: 1 << 15,
    };
    let table = TapTable::new(16, vec![half(0), half(9)]).unwrap();
    let shapers = ["x", "y"].map(|axis| AxisShaper {
        axis: axis.to_owned(),
        config: AxisShaperConfig::Taps(ShaperConfig::new(32, table.clone()).unwrap()),
    });
    let words = (0..SAMPLES as i64).map(|n| 1000 * n).collect::<Vec<_>>();
    MachineShapers::new("stage", shapers.into(), vec![words.clone(), words]).unwrap()
}

/// Records the move, either only the clocks of the passes or all of them.
fn record(top: &MachineShapers, path: &Path, all_clocks: bool) -> RecordedMove {
    let command = Move {
        layout: top.layout(),
        words: top.words(),
        pass_clocks: if all_clocks { u32::MAX } else { top.pass_clocks() },
        clock_hz: 50e6,
        sample_hz: SAMPLE_HZ,
    };
    command.record(&mut TwoValued(top.model(1)), path, "stage").unwrap()
}

fn compare(a: &Path, b: &Path, options: &DiffOptions) -> Comparison {
    diff::compare(a, b, options, &mut |_| {}).unwrap()
}

#[test]
fn a_recorded_move_shows_the_machines_clock_and_true_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.vcd");
    let trace = record(&machine(), &path, false);
    assert_eq!(trace.shaped[0].len(), SAMPLES);

    let (unit, changes) = read(&path);
    assert_eq!(unit, "1 ns");
    let strobes = times_of_ones(&changes["stage.strobe"]);
    let expected: Vec<u64> = (0..SAMPLES as u64).map(|n| RESET_NS + n * 100_000).collect();
    assert_eq!(strobes, expected);
    // In each sample, the product of the first tap appears this many clocks of 20 ns later.
    let pass_ns = (trace.valid_clocks[0][0] - 2) * 20;
    let valid: Vec<u64> = expected.iter().map(|strobe| strobe + pass_ns).collect();
    assert_eq!(times_of_ones(&changes["stage.x_valid"]), valid);

    let rises = times_of_ones(&changes["stage.clk"]);
    let recorded = trace.recorded_clocks as usize;
    assert_eq!(
        rises.len(),
        recorded + 1,
        "each recorded clock, and the edge that ends the last"
    );
    assert!(rises.iter().all(|time| time.is_multiple_of(20)), "{rises:?}");
    let gaps = rises.windows(2).filter(|pair| pair[1] - pair[0] != 20).count();
    assert_eq!(gaps, SAMPLES - 1);
    // In a gap the clock is unknown, and the file marks it as not recorded.
    let unknown = changes["stage.clk"].iter().filter(|(_, value)| value == "x").count();
    let off = changes["stage.recording"]
        .iter()
        .filter(|(_, value)| value == "0")
        .count();
    assert_eq!((unknown, off), (gaps, gaps));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("the machine's clock of 50 MHz") && text.contains("clk is x there and recording is 0"));
    assert_eq!(
        trace.clocks,
        2 + (SAMPLES as u64 - 1) * 5000 + (recorded as u64 - 2) / SAMPLES as u64
    );
}

#[test]
fn nothing_happens_in_the_clocks_that_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let top = machine();
    let passes = record(&top, &at("passes.vcd"), false);
    let all = record(&top, &at("all.vcd"), true);
    assert_eq!(passes.shaped, all.shaped);
    assert!(all.recorded_clocks > 50 * passes.recorded_clocks);
    let options = DiffOptions {
        raw: true,
        require_all: true,
        ignore: vec!["stage.clk".to_owned(), "stage.recording".to_owned()],
        ..DiffOptions::default()
    };
    let compared = compare(&at("passes.vcd"), &at("all.vcd"), &options);
    assert_eq!(
        (compared.result, compared.exact),
        (DiffVerdict::Equal, true),
        "{compared}"
    );
    assert!(compared.samples > 2 * SAMPLES as u64 && compared.signals > 10);
}

#[test]
fn a_difference_between_recorded_moves_is_found_wherever_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let trace = record(&machine(), &at("a.vcd"), false);
    let text = std::fs::read_to_string(at("a.vcd")).unwrap();
    let changes: Vec<usize> = text.match_indices("\n1").map(|(at, _)| at + 1).collect();
    let clock = text.lines().find(|line| line.contains(" clk $end")).unwrap();
    let clock = clock.split_whitespace().nth(3).unwrap().to_owned();
    let mut planted = 0;
    // Every rise of a bit other than the clock is removed, one at a time; the first is in $dumpvars.
    for change in changes {
        let line = text[change..].lines().next().unwrap();
        if line[1..] == clock {
            continue;
        }
        let other = format!("{}0{}", &text[..change], &text[change + 1..]);
        std::fs::write(at("b.vcd"), other).unwrap();
        for clock in [None, Some("stage.clk".to_owned())] {
            let options = DiffOptions {
                clock,
                require_all: true,
                ..DiffOptions::default()
            };
            let compared = compare(&at("a.vcd"), &at("b.vcd"), &options);
            assert_eq!(compared.result, DiffVerdict::Different, "{line} at byte {change}");
            assert_eq!(
                (compared.differences.len(), compared.samples),
                (1, trace.recorded_clocks)
            );
        }
        planted += 1;
    }
    assert!(planted > 100, "{planted}");
}
