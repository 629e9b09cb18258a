//! `verify --stimulus`: a recording replayed, and what is wrong or missing in it.

#![cfg(test)] // lets clippy see that this is test code

use crate::support::{example, json, posicast};
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::{Direction, Port};
use posicast_testbench::blocks::{Block, DividerBlock};
use posicast_testbench::lockstep::{self, Instance, Options, TwoValued};
use posicast_testbench::wave::{Recorder, Signal};
use std::path::Path;
use std::process::Output;

const CLOCKS: u64 = 2000;
const SEED: u64 = 7;

/// Records the divider of the XY stage in our own lock step. `change` may change a row of values, clock by clock; ports for
/// which `keep` is false are left out.
fn record(path: &Path, keep: impl Fn(&Port) -> bool, mut change: impl FnMut(u64, &mut [u64])) -> Vec<Port> {
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
        block.stimuli(CLOCKS, SEED).as_mut(),
        &[Instance::whole("divider", "", &ports)],
        &Options::cycles(CLOCKS),
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
    assert_eq!(document["result"], "match");
    assert_eq!(document["stimulus"]["clocks"], CLOCKS);
    assert!(document["stimulus"]["compared"].as_u64().unwrap() > CLOCKS - 10);
    assert_eq!(document["stimulus"]["missing_inputs"], serde_json::json!([]));
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
                // The first output, behind five inputs: `quotient`.
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
fn cli_replay_says_what_is_not_in_the_file() {
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
fn cli_replay_refuses_what_it_cannot_use() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recorded.vcd");
    record(&path, |_| true, |_, _| {});
    let whole = std::fs::read(&path).unwrap();
    let header = "$timescale 1 ns $end\n$scope module t $end\n";
    let foreign =
        format!("{header}$var wire 1 ! clk $end\n$var wire 1 \" q $end\n$upscope $end\n$enddefinitions $end\n#0\n");
    let narrow =
        format!("{header}$var wire 1 ! clk $end\n$var wire 3 \" steps $end\n$upscope $end\n$enddefinitions $end\n#0\n");
    for (text, expected) in [
        (whole[..whole.len() / 3].to_vec(), "recorded.vcd"),
        (foreign.into_bytes(), "no signal in common"),
        (narrow.into_bytes(), "no vector of 18 bits"),
        (b"no waveform at all".to_vec(), "recorded.vcd"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let output = replay(&path, &[]);
        // What a file that was cut at the end of a line holds is whole; it is then a shorter recording.
        let cut_at_a_line = text.len() == whole.len() / 3 && text.last() == Some(&b'\n');
        assert!(
            output.status.code() == Some(2) || cut_at_a_line,
            "{expected}: {}",
            said(&output)
        );
        assert!(
            said(&output).contains(expected) || cut_at_a_line,
            "{expected}: {}",
            said(&output)
        );
        assert!(output.stdout.is_empty() || cut_at_a_line);
    }
}
