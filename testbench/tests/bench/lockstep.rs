//! Tests lockstep runs on hand-written Verilog: the errors that they must find, and their reports.

use crate::bench::common::{COUNTER, Counter, Files, counter_ports};
use posicast_blocks::{ClockedBlock, Port};
use posicast_testbench::Error;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Device, Instance, LockstepOptions, SideBySide, TwoValued};
use posicast_testbench::verilator::{Verilated, VerilogSource};

/// Resets in the first two clocks, then gives the steps `clock mod 7 − 3`.
fn steps() -> impl FnMut(&[u64], &mut [u64]) {
    let mut clock = 0i64;
    move |_: &[u64], inputs: &mut [u64]| {
        inputs.copy_from_slice(&[u64::from(clock < 2), u64::from(clock % 3 == 0), (clock % 7 - 3) as u64]);
        clock += 1;
    }
}

fn against(device: &mut dyn Device, cycles: u64) -> LockstepReport {
    let instances = [Instance::whole("counter", "one", &counter_ports())];
    let mut model = Counter::new();
    lockstep::run(
        &mut model,
        device,
        &mut steps(),
        &instances,
        &LockstepOptions::cycles(cycles),
        &mut |_| {},
        &mut |_| {},
    )
    .unwrap()
}

fn verilated(verilog: &str) -> Verilated {
    let files = Files::new(verilog);
    let ports = counter_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    Verilated::build(&source, 7).unwrap()
}

#[test]
fn lockstep_equal_verilog_matches() {
    let report = against(&mut verilated(COUNTER), 100_000);
    assert_eq!(
        (report.result, report.cycles, report.mismatches()),
        (LockstepVerdict::Match, 100_000, 0)
    );
    assert!(report.blocks[0].first.is_none());
}

#[test]
fn lockstep_catches_one_wrong_bit_and_shows_the_clocks_around_it() {
    // Without the sign extension, the result is wrong from the first negative step on.
    let report = against(&mut verilated(&COUNTER.replace("{23{a__step[8]}}", "{23{1'b0}}")), 1000);
    assert_eq!(report.result, LockstepVerdict::Mismatch);
    let first = report.blocks[0].first.as_ref().unwrap();
    assert_eq!((first.signal.as_str(), first.time), ("count", 10));
    assert_eq!(first.expected, "00000000000000000000000000000010");
    assert_eq!(first.actual, "00000000000000000000001000000010");
    let text = first.to_string();
    let expected = "\
first mismatch in clock 10: `count` is 514 (0x00000202), the model has 2 (0x00000002)
clock           4  5  6   7   8   9    10    11    12    13    14    15     16
rst             0  0  0   0   0   0     0     0     0     0     0     0      0
strobe          0  0  1   0   0   1     0     0     1     0     0     1      0
a__step         1  2  3  -3  -2  -1     0     1     2     3    -3    -2     -1
count (model)   0  0  0   3   3   3     2     2     2     4     4     4      2
count (device)  0  0  0   3   3   3  *514  *514  *514  *516  *516  *516  *1026
moving          0  0  1   0   0   1     0     0     1     0     0     1      0";
    assert_eq!(text, expected);
    assert!(report.blocks[0].mismatches > 500);
}

#[test]
fn lockstep_a_held_device_stops_at_the_first_difference() {
    let devices: [Box<dyn Device>; 2] = [
        Box::new(verilated(COUNTER)),
        Box::new(TwoValued(Box::new(Counter::new()))),
    ];
    for mut device in devices {
        let (mut outputs, mut unknown) = ([0; 2], [0; 2]);
        let mut hold = |inputs: [u64; 3], expected: [u64; 2]| {
            let (equal, result) = device.hold(&inputs, &expected, 1000, &mut outputs, &mut unknown);
            result.unwrap();
            (equal, outputs)
        };
        assert_eq!(hold([1, 0, 0], [0, 0]).0, 1000);
        assert_eq!(hold([0, 0, 5], [0, 0]).0, 1000);
        // The count is 0 in the first clock, and 5 in the second one, which is simulated too.
        assert_eq!(hold([0, 1, 5], [0, 1]), (1, [5, 1]));
        assert_eq!(hold([0, 0, 5], [10, 0]).0, 1000);
        assert_eq!(hold([0, 0, 5], [10, 1]), (0, [10, 0]));
    }
}

#[test]
fn lockstep_ends_early_when_everything_is_wrong() {
    let mut device = verilated(&COUNTER.replace("assign moving =", "assign moving = !"));
    let instances = [Instance::whole("counter", "one", &counter_ports())];
    let options = LockstepOptions {
        mismatch_limit: 50,
        ..LockstepOptions::cycles(u64::MAX)
    };
    let mut model = Counter::new();
    let report = lockstep::run(
        &mut model,
        &mut device,
        &mut steps(),
        &instances,
        &options,
        &mut |_| {},
        &mut |_| {},
    )
    .unwrap();
    assert!(report.cycles < 200 && report.mismatches() == 50, "{report:?}");
}

#[test]
fn lockstep_an_undriven_output_is_a_mismatch_under_icarus() {
    let undriven = COUNTER.replace("assign moving = strobe && a__step != 0;", "");
    let files = Files::new(&undriven);
    let ports = counter_ports();
    let source = VerilogSource {
        files: &files.files,
        top: "counter",
        ports: &ports,
    };
    let report = against(&mut Icarus::build(&source).unwrap(), 20);
    let first = report.blocks[0].first.as_ref().unwrap();
    assert_eq!(
        (first.time, first.signal.as_str(), first.actual.as_str()),
        (0, "moving", "x")
    );
    assert_eq!(report.mismatches(), 20, "also where the model's value is 0");
}

#[test]
fn lockstep_other_ports_are_refused() {
    let mut model = Counter::new();
    let mut other = Counter::new();
    other.ports.pop();
    let instances = [Instance::whole("counter", "one", &counter_ports())];
    let mut run = |device: &mut dyn Device| {
        let options = LockstepOptions::cycles(1);
        lockstep::run(
            &mut model,
            device,
            &mut steps(),
            &instances,
            &options,
            &mut |_| {},
            &mut |_| {},
        )
    };
    assert!(matches!(run(&mut TwoValued(Box::new(other))), Err(Error::Unlike(_))));
    let mut more = Counter::new();
    more.ports.push(Port {
        name: "more".to_owned(),
        ..counter_ports()[3].clone()
    });
    assert!(matches!(run(&mut TwoValued(Box::new(more))), Err(Error::Unlike(_))));
}

#[test]
fn lockstep_joined_models_share_reset_and_strobe() {
    let axes = || -> Vec<(String, Box<dyn ClockedBlock>)> {
        ["x", "y"]
            .map(|axis| (axis.to_owned(), Box::new(Counter::new()) as Box<dyn ClockedBlock>))
            .into()
    };
    let joined = SideBySide::new(axes());
    let names: Vec<&str> = joined.ports().iter().map(|p| p.name.as_str()).collect();
    let expected = [
        "rst",
        "strobe",
        "x_a__step",
        "x_count",
        "x_moving",
        "y_a__step",
        "y_count",
        "y_moving",
    ];
    assert_eq!(names, expected);

    // The Verilog has the axes in another order: ports are matched by name.
    let top = format!(
        "{COUNTER}
        module top(input wire clk, input wire rst, input wire strobe,
            input wire [8:0] y_a__step, output wire [31:0] y_count, output wire y_moving,
            input wire [8:0] x_a__step, output wire [31:0] x_count, output wire x_moving);
        counter x(clk, rst, strobe, x_a__step, x_count, x_moving);
        counter y(clk, rst, strobe, y_a__step ^ 9'd1, y_count, y_moving);
        endmodule"
    );
    let files = Files::new(&top);
    let (mut ports, y) = (joined.ports()[..2].to_vec(), joined.ports()[5..].to_vec());
    ports.extend(y.into_iter().chain(joined.ports()[2..5].to_vec()));
    let source = VerilogSource {
        files: &files.files,
        top: "top",
        ports: &ports,
    };
    let mut device = Verilated::build(&source, 1).unwrap();
    let instances = joined.instances("counter");
    let mut model = joined;
    let mut clock = 0;
    let mut stimuli = |_: &[u64], inputs: &mut [u64]| {
        clock += 1;
        inputs.copy_from_slice(&[u64::from(clock == 1), 1, clock % 5, 500]);
    };
    let options = LockstepOptions::cycles(1000);
    let mut calls = Vec::new();
    let report = lockstep::run(
        &mut model,
        &mut device,
        &mut stimuli,
        &instances,
        &options,
        &mut |_| {},
        &mut |clocks| calls.push(clocks),
    )
    .unwrap();
    assert_eq!(calls, [1000]);
    let found: Vec<_> = report
        .blocks
        .iter()
        .map(|b| (b.instance.as_str(), b.mismatches > 0))
        .collect();
    assert_eq!(found, [("x", false), ("y", true)]);
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["result"], "mismatch");
    assert_eq!(json["blocks"][0]["first"], serde_json::Value::Null);
    assert_eq!(json["blocks"][1]["first"]["signal"], "y_count");
    let keys: Vec<&str> = json["blocks"][1]
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    assert_eq!(
        keys,
        ["name", "instance", "cycles", "mismatches", "first", "not_exercised"]
    );
}
