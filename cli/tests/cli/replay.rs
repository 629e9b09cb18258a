//! `verify --stimulus`: a recording replayed, and what is wrong or missing in it.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{assert_fits_schema, example, json, posicast};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::{Direction, Port};
use posicast_testbench::blocks::Block;
use posicast_testbench::divider::DividerBlock;
use posicast_testbench::lockstep::{self, Instance, LockstepOptions, TwoValued};
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::wave::{Recorder, Signal};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const CLOCKS: u64 = 2000;
const SEED: u64 = 7;

/// Stimuli that reset, and then start a division of these values every 200 clocks; nothing else changes.
struct Constant {
    clock: u64,
    starts: bool,
    steps: u64,
}

impl Stimuli for Constant {
    /// The inputs are `rst`, `start`, `steps`, `elapsed`, `clear_flags`.
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let start = self.starts && self.clock % 200 == 10;
        inputs.copy_from_slice(&[u64::from(self.clock < 3), u64::from(start), self.steps, 1000, 0]);
        self.clock += 1;
    }
}

/// Records the divider of the XY stage in our own lockstep run. `change` may change a row of values, clock by clock;
/// ports for which `keep` is false are left out.
fn record(path: &Path, keep: impl Fn(&Port) -> bool, change: impl FnMut(u64, &mut [u64])) -> Vec<Port> {
    let block = DividerBlock::new(DividerConfig::new(5000).unwrap(), "");
    record_with(path, block.stimuli(CLOCKS, SEED).as_mut(), keep, change)
}

fn record_with(
    path: &Path,
    stimuli: &mut dyn Stimuli,
    keep: impl Fn(&Port) -> bool,
    mut change: impl FnMut(u64, &mut [u64]),
) -> Vec<Port> {
    let block = DividerBlock::new(DividerConfig::new(5000).unwrap(), "");
    let mut model = block.model(SEED);
    let ports = model.ports().to_vec();
    let of = |direction| ports.iter().filter(move |port| port.direction == direction);
    let ports: Vec<Port> = of(Direction::Input).chain(of(Direction::Output)).cloned().collect();
    let kept: Vec<bool> = ports.iter().map(keep).collect();
    let shown = ports.iter().zip(&kept).filter(|(_, keep)| **keep);
    let signals: Vec<Signal> = shown.map(|(port, _)| Signal::bits(&port.name, port.width)).collect();
    let mut recorder = Recorder::create(path, 50e6, &["tb", "dut"], &signals).unwrap();
    lockstep::run(
        model.as_mut(),
        &mut TwoValued(block.model(SEED)),
        stimuli,
        &[Instance::whole("divider", "", &ports)],
        &LockstepOptions::cycles(CLOCKS),
        &mut |clock| {
            let mut row = [clock.inputs, clock.actual].concat();
            change(clock.time, &mut row);
            let row: Vec<u64> = row
                .into_iter()
                .zip(&kept)
                .filter(|(_, keep)| **keep)
                .map(|(v, _)| v)
                .collect();
            recorder.clock(&[&row]).unwrap();
        },
        &mut |_| {},
    )
    .unwrap();
    recorder.finish().unwrap();
    ports
}

fn replay(path: &Path, arguments: &[&str]) -> Output {
    let mut verify = posicast();
    verify
        .arg("verify")
        .arg(example("xy-stage.toml"))
        .arg("--stimulus")
        .arg(path);
    verify
        .args(["--simulator", "icarus", "--block", "divider"])
        .args(arguments);
    verify.output().unwrap()
}

fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn cli_replay_of_our_own_lock_step_matches() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    record(&path, |_| true, |_, _| {});
    let output = replay(&path, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let document = json(&output.stdout);
    assert_fits_schema("verify", &document);
    assert_eq!(document["result"], "match");
    assert_eq!(document["stimulus"]["clocks"], CLOCKS);
    assert!(document["stimulus"]["compared"].as_u64().unwrap() > CLOCKS - 10);
    let none = serde_json::json!([]);
    let stimulus = &document["stimulus"];
    for key in ["missing_inputs", "unchanged_inputs", "unchanged_outputs"] {
        assert_eq!(stimulus[key], none, "{key}");
    }
    let rows = document["blocks"].as_array().unwrap();
    assert_eq!(rows.len(), 2, "{rows:?}");
    assert!(
        rows.iter().all(|row| row["cycles"] == CLOCKS && row["mismatches"] == 0),
        "{rows:?}"
    );
}

#[test]
fn cli_replay_names_the_signal_and_the_clock_of_one_flipped_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    let flipped = 1234;
    record(
        &path,
        |_| true,
        |clock, row| {
            if clock == flipped {
                // The first output comes after five inputs: `quotient`.
                row[5] ^= 1 << 9;
            }
        },
    );
    let output = replay(&path, &["--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let document = json(&output.stdout);
    let rows = document["blocks"].as_array().unwrap();
    assert_eq!((&rows[0]["mismatches"], &rows[1]["mismatches"]), (&0.into(), &1.into()));
    let first = &rows[1]["first"];
    assert_eq!(
        (&first["signal"], &first["time"]),
        (&"quotient".into(), &flipped.into())
    );
}

#[test]
fn cli_replay_names_ports_that_are_not_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    record(
        &path,
        |port| !["clear_flags", "busy"].contains(&port.name.as_str()),
        |_, _| {},
    );
    let output = replay(&path, &["--json", "--reset", "rst"]);
    let document = json(&output.stdout);
    assert_eq!(
        document["stimulus"]["missing_inputs"],
        serde_json::json!(["clear_flags"])
    );
    assert_eq!(document["stimulus"]["missing_outputs"], serde_json::json!(["busy"]));
    assert!(said(&output).contains("held at 0: clear_flags"), "{}", said(&output));
    // The RTL agrees with the model whatever is missing.
    assert_eq!(document["blocks"][0]["mismatches"], 0);
}

#[test]
fn cli_replay_of_a_recording_without_data_or_without_outputs_fails_as_empty() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    let only = |direction: Direction| move |port: &Port| port.name == "rst" || port.direction == direction;
    for (kept, lacks) in [
        (Direction::Output, "none of the data inputs"),
        (Direction::Input, "none of the outputs"),
    ] {
        record(&path, only(kept), |_, _| {});
        let output = replay(&path, &["--json"]);
        assert_eq!((output.status.code(), output.stdout.is_empty()), (Some(2), true));
        let said = said(&output);
        assert!(said.contains(lacks) && said.contains("--map"), "{said}");
    }
}

/// Everything is equal where nothing is computed.
#[test]
fn cli_replay_of_a_recording_in_which_no_data_changes_is_no_match() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    for (starts, steps, why) in [
        (false, 5, "none of its data inputs ever changes"),
        (true, 0, "no word at its outputs ever changes"),
    ] {
        let mut constant = Constant {
            clock: 0,
            starts,
            steps,
        };
        record_with(&path, &mut constant, |_| true, |_, _| {});
        let output = replay(&path, &["--json"]);
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        let document = json(&output.stdout);
        assert_eq!(document["result"], "no_verdict");
        let reason = document["reason"].as_str().unwrap();
        assert!(
            reason.contains("the recording has no data") && reason.contains(why),
            "{reason}"
        );
        let rows = document["blocks"].as_array().unwrap();
        assert!(rows.iter().all(|row| row["mismatches"] == 0), "{rows:?}");
        let unchanged: Vec<&str> = document["stimulus"]["unchanged_inputs"]
            .as_array()
            .unwrap()
            .iter()
            .map(|name| name.as_str().unwrap())
            .collect();
        for input in ["steps", "elapsed"] {
            assert!(unchanged.contains(&input), "{unchanged:?}");
        }
        assert_eq!(unchanged.contains(&"start"), !starts, "{unchanged:?}");
        let outputs = document["stimulus"]["unchanged_outputs"].to_string();
        assert!(outputs.contains("quotient"), "{outputs}");
        let missing = document["not_exercised"].to_string();
        assert!(missing.contains("`saturated` = 1"), "{missing}");
    }
    // With data it is a match, which names what it does not reach.
    let mut constant = Constant {
        clock: 0,
        starts: true,
        steps: 7,
    };
    record_with(&path, &mut constant, |_| true, |_, _| {});
    let output = replay(&path, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("inputs that never change: steps, elapsed"), "{text}");
    assert!(
        text.contains("not exercised: divider") && text.contains("not exercised by it (see above)"),
        "{text}"
    );
}

#[test]
fn cli_replay_does_not_compare_unknown_bits_and_counts_their_clocks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    record(&path, |_| true, |_, _| {});
    let text = std::fs::read_to_string(&path).unwrap();
    let declaration = text.lines().find(|line| line.contains(" quotient")).unwrap();
    let code = declaration.split_whitespace().nth(3).unwrap();
    // This makes the lowest bit of every quotient unknown.
    let (known, unknown) = (["0", "1"].map(|bit| format!("{bit} {code}")), format!("x {code}"));
    let lines = text
        .lines()
        .map(|line| match known.iter().find(|end| line.ends_with(*end)) {
            Some(end) => line.replace(end, &unknown),
            None => line.to_owned(),
        });
    std::fs::write(&path, lines.collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let output = replay(&path, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let document = json(&output.stdout);
    assert!(document["stimulus"]["unknown_output_clocks"].as_u64().unwrap() > CLOCKS / 2);
    assert_eq!(document["stimulus"]["unknown_input_clocks"], 0);
}

#[test]
fn cli_replay_refuses_unusable_recordings_and_options() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    record(&path, |_| true, |_, _| {});
    // The file is cut within a line: one that ends at the end of a line is a shorter recording.
    let whole = std::fs::read(&path).unwrap();
    let line_end = whole.len() / 3 + whole[whole.len() / 3..].iter().position(|&byte| byte == b'\n').unwrap();
    let cut_within_a_line = whole[..line_end - 1].to_vec();
    let header = "$timescale 1 ns $end\n$scope module t $end\n";
    let foreign =
        format!("{header}$var wire 1 ! clk $end\n$var wire 1 \" q $end\n$upscope $end\n$enddefinitions $end\n#0\n");
    let narrow =
        format!("{header}$var wire 1 ! clk $end\n$var wire 3 \" steps $end\n$upscope $end\n$enddefinitions $end\n#0\n");
    for (text, expected) in [
        (cut_within_a_line, "recorded.vcd"),
        (foreign.into_bytes(), "no signal in common"),
        (narrow.into_bytes(), "is not a vector of 18 bits"),
        (b"no waveform at all".to_vec(), "recorded.vcd"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let output = replay(&path, &[]);
        assert_eq!(output.status.code(), Some(2), "{expected}: {}", said(&output));
        assert!(said(&output).contains(expected), "{expected}: {}", said(&output));
        assert!(output.stdout.is_empty());
    }
}

/// A testbench that is independent of ours: a reset, then divisions of random numbers.
const FOREIGN_BENCH: &str = r#"
`timescale 1ns / 1ps
module bench;
reg clk = 0, rst = 1, start = 0, clear_flags = 0;
reg signed [17:0] steps = 0;
reg [23:0] elapsed = 0;
wire signed [31:0] quotient;
wire done, busy, saturated, overrun;
posicast_divider_5000 dut (
    .clk(clk), .rst(rst), .start(start), .steps(steps), .elapsed(elapsed), .clear_flags(clear_flags),
    .quotient(quotient), .done(done), .busy(busy), .saturated(saturated), .overrun(overrun)
);
always #10 clk = ~clk;
initial begin
    $dumpfile(`DUMP);
    $dumpvars(0, bench);
    repeat (3) @(negedge clk);
    rst = 0;
    repeat (20) begin
`ifdef HOLE
        $dumpoff;
        repeat (5) @(negedge clk);
        $dumpon;
`endif
        @(negedge clk);
        {start, steps} = {1'b1, $random};
        elapsed = $random;
`ifdef UNKNOWN
        elapsed[3] = 1'bx;
`endif
        @(negedge clk);
        start = 0;
        repeat (150) @(negedge clk);
    end
    $finish;
end
endmodule
"#;

/// Returns Icarus's own recording of the generated divider: VCD or FST, by the name's extension.
fn record_by_icarus(folder: &Path, define: &str, format: &str) -> PathBuf {
    std::fs::write(folder.join("bench.v"), FOREIGN_BENCH).unwrap();
    let rtl = example("generated/xy_stage/rtl/posicast_divider_5000.v");
    let run = |program: &str, arguments: &[&str]| {
        let run = Command::new(program)
            .args(arguments)
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    };
    let (define, dump) = (format!("-D{define}"), format!("-DDUMP=\"recorded.{format}\""));
    let sources = ["bench.v", rtl.to_str().unwrap()];
    run(
        "iverilog",
        &[&["-g2005", &define, &dump, "-s", "bench", "-o", "bench"], &sources[..]].concat(),
    );
    run("vvp", &["-n", "bench", &format!("-{format}")]);
    folder.join(format!("recorded.{format}"))
}

#[test]
fn cli_replay_accepts_recordings_of_another_simulator() {
    let folder = tempfile::tempdir().unwrap();
    let inside = ["--map", "bench.dut=posicast_divider_5000", "--json"];
    for format in ["vcd", "fst"] {
        let path = record_by_icarus(folder.path(), "PLAIN", format);
        let output = replay(&path, &inside);
        assert_eq!(output.status.code(), Some(0), "{format}: {}", said(&output));
        let stimulus = &json(&output.stdout)["stimulus"];
        assert_eq!(
            (&stimulus["missing_inputs"], &stimulus["missing_outputs"]),
            (&serde_json::json!([]), &serde_json::json!([]))
        );
        assert_eq!(stimulus["unknown_input_clocks"], 0);
        assert!(stimulus["compared"].as_u64().unwrap() > 20 * 150, "{stimulus}");
    }
}

#[test]
fn cli_replay_takes_unknown_inputs_as_low_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = record_by_icarus(folder.path(), "UNKNOWN", "vcd");
    let output = replay(&path, &["--map", "bench.dut=posicast_divider_5000", "--json"]);
    let document = json(&output.stdout);
    // Icarus chose a value itself; RTL and model, which have a 0 there, must still agree.
    assert_eq!(document["blocks"][0]["mismatches"], 0);
    assert!(document["stimulus"]["unknown_input_clocks"].as_u64().unwrap() > 20 * 140);
}

#[test]
fn cli_replay_refuses_a_recording_with_a_hole_and_names_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let path = record_by_icarus(folder.path(), "HOLE", "vcd");
    let output = replay(&path, &["--map", "bench.dut=posicast_divider_5000"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let message = said(&output);
    assert!(
        message.contains("$dumpoff") && message.contains("--cycles"),
        "{message}"
    );
}

#[test]
fn cli_replay_of_a_damaged_fst_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = record_by_icarus(folder.path(), "PLAIN", "fst");
    let whole = std::fs::read(&path).unwrap();
    for kept in [0, 1, whole.len() / 10, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..kept]).unwrap();
        let output = replay(&path, &["--map", "bench.dut=posicast_divider_5000"]);
        assert_eq!(output.status.code(), Some(2), "{kept} bytes: {}", said(&output));
        assert!(
            said(&output).contains("recorded.fst"),
            "{kept} bytes: {}",
            said(&output)
        );
        assert!(output.stdout.is_empty());
    }
}
