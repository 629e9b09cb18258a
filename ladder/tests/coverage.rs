//! Measures the coverage of a few blocks, as the example `coverage` does for all; unreached code must be detected.

use posicast_blocks::{Direction, Port};
use posicast_ladder::coverage::explanation::{all, parse};
use posicast_ladder::coverage::point::{PointKind, read};
use posicast_ladder::coverage::{CLOCKS, Measured, measure, measure_with, outdated, subjects};
use posicast_testbench::blocks::Block;
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::verilator::{Verilated, VerilogSource};

fn block(name: &str) -> Box<dyn Block> {
    subjects()
        .unwrap()
        .into_iter()
        .find(|block| block.name() == name)
        .unwrap()
}

fn measured(name: &str) -> Measured {
    measure(block(name).as_ref(), CLOCKS).unwrap()
}

#[test]
fn long_coverage_of_the_divider_and_the_schedule_is_explained() {
    let (explanations, all_blocks) = (all().unwrap(), subjects().unwrap());
    for name in ["divider", "schedule"] {
        let measured = measured(name);
        assert_eq!(measured.problems(&explanations), [""; 0]);
        assert_eq!(
            outdated(std::slice::from_ref(&measured), &all_blocks, &explanations),
            [""; 0]
        );
        assert!(
            measured.lines.all > 5 && measured.toggles.all > 20 && measured.bins.all > 0,
            "{measured:?}"
        );
    }
}

#[test]
fn long_coverage_of_idle_inputs_leaves_holes_that_nothing_explains() {
    let block = block("divider");
    let idle = || -> Box<dyn Stimuli> {
        let mut clock = 0;
        Box::new(move |_: &[u64], inputs: &mut [u64]| {
            inputs.fill(0);
            inputs[0] = u64::from(clock < 2);
            clock += 1;
        })
    };
    let measured = measure_with(block.as_ref(), &idle, 10_000).unwrap();
    let problems = measured.problems(&all().unwrap());
    for kind in ["line", "toggle", "bin"] {
        let found = problems.iter().any(|problem| problem.contains(&format!("| {kind} |")));
        assert!(found, "no {kind} among {problems:?}");
    }
}

#[test]
fn long_coverage_without_a_hole_for_an_explanation_is_noticed() {
    let measured = [measured("schedule")];
    let others = subjects().unwrap();
    let explanations = "schedule * | * | toggle | clk | it stands still\nother | * | bin | x | y\n\
                        * | * | toggle | clk | a block that was not measured may have it";
    let outdated = outdated(&measured, &others, &parse(explanations).unwrap());
    assert!(
        outdated.len() == 1 && outdated[0].contains("schedule * | * | toggle | clk"),
        "{outdated:?}"
    );
}

/// Verilator's counts are correct for a module whose behaviour is obvious.
#[test]
fn long_coverage_counts_what_happens_and_nothing_else() {
    const VERILOG: &str = "module plain(input clk, input go, input stay, output reg [1:0] count);\n\
        always @(posedge clk)\n  if (go) begin\n    if (stay) begin\n      count <= count;\n    end else begin\n\
        count <= {1'b0, !count[0]};\n    end\n  end else begin\n    count <= 2'd0;\n  end\nendmodule\n";
    let folder = tempfile::tempdir().unwrap();
    let (file, counts) = (folder.path().join("plain.v"), folder.path().join("coverage.dat"));
    std::fs::write(&file, VERILOG).unwrap();
    let port = |name: &str, direction, width| Port {
        name: name.to_owned(),
        direction,
        width,
        signed: false,
    };
    let ports = [
        port("go", Direction::Input, 1),
        port("stay", Direction::Input, 1),
        port("count", Direction::Output, 2),
    ];
    let source = VerilogSource {
        files: &[file],
        top: "plain",
        ports: &ports,
    };
    let mut device = Verilated::counting(&source, 1).unwrap();
    let mut shown = [0; 20];
    let inputs: Vec<u64> = (0..20).flat_map(|clock| [u64::from(clock > 1), 0]).collect();
    device.run(&inputs, &mut shown).unwrap();
    device.write_coverage(&counts).unwrap();
    let points = read(&counts, source.files).unwrap();
    let count = |kind, what: &str| {
        let found = points.iter().find(|point| point.kind == kind && point.what == what);
        found.unwrap_or_else(|| panic!("no `{what}` in {points:?}")).count
    };
    assert_eq!(count(PointKind::Line, "if (go) begin"), 18);
    assert_eq!(count(PointKind::Line, "not if (go) begin"), 2);
    assert_eq!(count(PointKind::Line, "if (stay) begin"), 0);
    assert_eq!(count(PointKind::Line, "not if (stay) begin"), 18);
    // Its random start value may differ from it once.
    assert!((17..=19).contains(&count(PointKind::Toggle, "count[0]")));
    assert!(count(PointKind::Toggle, "count[1]") <= 1);

    // A simulation that does not count reports it.
    let mut plain = Verilated::build(&source, 1).unwrap();
    assert!(
        plain
            .write_coverage(&counts)
            .unwrap_err()
            .to_string()
            .contains("not built to count")
    );
}
