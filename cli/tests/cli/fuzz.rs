//! Damaged and hostile machine files and command files: an exit status of the contract, a message, bounded time and
//! memory, and no half-written files.
//!
//! The files are those of the examples, changed so that many are still valid: a file that the parser refuses tests
//! nothing after it. Every run of the tests has a few dozen cases; `PROPTEST_CASES` sets their number.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::example;
use proptest::prelude::*;
use proptest::sample::Index;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

const MACHINES: [&str; 8] = [
    "xy-stage.toml",
    "xy-stage-torque.toml",
    "contouring-stage.toml",
    "gantry.toml",
    "robot-joint.toml",
    "custom-shaper.toml",
    "telescope-arm.toml",
    "ball-screw.toml",
];
const COMMAND: &str = "time_s,position\n0,0\n0.01,0.001\n0.02,0.002\n0.05,0\n";
/// Replacements of values: the ends of every type, values just too large, and words of other kinds.
const VALUES: [&str; 28] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "3",
    "16",
    "32",
    "0.5",
    "1e-9",
    "1e6",
    "1e9",
    "1e12",
    "1e300",
    "5e-324",
    "nan",
    "-inf",
    "65536",
    "4294967296",
    "18446744073709551616",
    "true",
    "[]",
    "[[0, 1]]",
    "{}",
    "\"zvd\"",
    "\"periodic\"",
    "\"simultaneous\"",
    "\"vibrationless\"",
];
/// Factors of numbers: some keep them valid, some take them to an end of their range.
const FACTORS: [f64; 10] = [-1.0, 1e-6, 1e-3, 0.1, 0.5, 1.0001, 2.0, 10.0, 1e3, 1e6];
/// Memory limit of a run; the debug program needs a tenth of it.
const MEMORY_KIB: u64 = 2 << 20;
/// Longest time of a run. `design --compare` proves for its optimal shapers that none is shorter; at a tenth of the damping that the
/// robot's joint has, this takes 8 s of one processor, and a test shares its two with others.
const TIME: Duration = Duration::from_secs(120);
/// Longest search for a smaller example of a failure, in ms: slow ones would otherwise end in the test's own time limit, unnamed.
const SHRINK_MS: u32 = 200_000;

/// Returns the configuration for this number of cases, or `PROPTEST_CASES`.
fn config(ordinary: u32) -> ProptestConfig {
    let wanted = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    ProptestConfig {
        cases: wanted.unwrap_or(ordinary),
        failure_persistence: None,
        max_shrink_iters: 60,
        max_shrink_time: SHRINK_MS,
        ..ProptestConfig::default()
    }
}

/// A change of a text.
#[derive(Debug, Clone)]
enum Damage {
    /// Replaces the value after a `=`, or a field of a CSV line.
    Value(Index, &'static str),
    /// Multiplies a number by this factor.
    Number(Index, f64),
    /// Inserts lines of another file.
    Splice(Index, usize, Index, usize),
    Remove(Index),
    Double(Index),
    /// Replaces bytes by others.
    Bytes(Index, usize, Vec<u8>),
    Cut(Index),
    /// Repeats the same opening bracket this many times.
    Nest(Index, usize),
}

fn damage() -> impl Strategy<Value = Vec<Damage>> {
    let index = any::<Index>;
    let one = prop_oneof![
        4 => (index(), prop::sample::select(&VALUES[..])).prop_map(|(at, value)| Damage::Value(at, value)),
        6 => (index(), prop::sample::select(&FACTORS[..])).prop_map(|(at, factor)| Damage::Number(at, factor)),
        1 => (index(), 0..MACHINES.len(), index(), 1..12usize).prop_map(|(at, file, from, n)| Damage::Splice(at, file, from, n)),
        1 => index().prop_map(Damage::Remove),
        1 => index().prop_map(Damage::Double),
        1 => (index(), 0..8usize, prop::collection::vec(any::<u8>(), 0..6)).prop_map(|(at, n, b)| Damage::Bytes(at, n, b)),
        1 => index().prop_map(Damage::Cut),
        1 => (index(), 1..20_000usize).prop_map(|(at, n)| Damage::Nest(at, n)),
    ];
    prop::collection::vec(one, 1..5)
}

/// Returns the ranges of the numbers in a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let is_digit = |c: u8| c.is_ascii_digit() || b"._".contains(&c);
    let bytes = text.as_bytes();
    let starts = (0..bytes.len()).filter(|at| {
        let before = at.checked_sub(1).map_or(b' ', |at| bytes[at]);
        bytes[*at].is_ascii_digit() && !is_digit(before) && !before.is_ascii_alphabetic()
    });
    starts
        .map(|start| {
            start
                ..bytes[start..]
                    .iter()
                    .position(|c| !is_digit(*c))
                    .map_or(bytes.len(), |n| start + n)
        })
        .collect()
}

fn damaged(text: &str, damage: &[Damage]) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for damage in damage {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        if lines.is_empty() {
            break;
        }
        bytes = match damage {
            Damage::Value(at, value) => {
                let line = at.index(lines.len());
                let changed = match lines[line].split_once('=') {
                    Some((key, _)) => format!("{key}= {value}"),
                    None => lines[line]
                        .rsplit_once(',')
                        .map_or(String::new(), |(rest, _)| format!("{rest},{value}")),
                };
                lines[line] = changed;
                lines.join("\n").into_bytes()
            }
            Damage::Number(at, factor) => match numbers(&text) {
                places if places.is_empty() => bytes,
                places => {
                    let place = places[at.index(places.len())].clone();
                    let value = text[place.clone()].replace('_', "").parse::<f64>().unwrap_or(1.0) * factor;
                    format!("{}{value}{}", &text[..place.start], &text[place.end..]).into_bytes()
                }
            },
            Damage::Splice(at, file, from, count) => {
                let other = std::fs::read_to_string(example(MACHINES[*file])).unwrap();
                let other: Vec<&str> = other.lines().collect();
                let piece = other.iter().skip(from.index(other.len())).take(*count);
                let at = at.index(lines.len());
                lines.splice(at..at, piece.map(|line| (*line).to_owned()));
                lines.join("\n").into_bytes()
            }
            Damage::Remove(at) => {
                lines.remove(at.index(lines.len()));
                lines.join("\n").into_bytes()
            }
            Damage::Double(at) => {
                let at = at.index(lines.len());
                lines.insert(at, lines[at].clone());
                lines.join("\n").into_bytes()
            }
            Damage::Bytes(at, count, new) => {
                let from = at.index(bytes.len() + 1);
                let to = (from + count).min(bytes.len());
                bytes.splice(from..to, new.iter().copied());
                bytes
            }
            Damage::Cut(at) => {
                bytes.truncate(at.index(bytes.len() + 1));
                bytes
            }
            Damage::Nest(at, count) => {
                let line = at.index(lines.len());
                let key = lines[line].split('=').next().unwrap_or("").to_owned();
                lines[line] = format!("{key}= {}", "[".repeat(*count));
                lines.join("\n").into_bytes()
            }
        };
    }
    bytes
}

/// Runs the program with little memory, and checks what holds for every input.
fn survives(folder: &Path, arguments: &[&str]) -> Result<Output, TestCaseError> {
    let began = Instant::now();
    let output = Command::new("sh")
        .args([
            "-c",
            &format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\""),
            env!("CARGO_BIN_EXE_posicast"),
        ])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    // An abort, a stack overflow and a signal have no exit status; a panic has 101.
    let status = output.status.code();
    prop_assert!(
        matches!(status, Some(0..=2)),
        "{arguments:?}: {:?}\n{said}",
        output.status
    );
    prop_assert!(!said.contains("panicked"), "{said}");
    prop_assert!(
        began.elapsed() < TIME,
        "{arguments:?} took {:?}\n{said}",
        began.elapsed()
    );
    if status == Some(2) {
        prop_assert!(!said.is_empty() && output.stdout.is_empty(), "{arguments:?}: {said}");
        let inputs = ["machine.toml", "command.csv"];
        let left = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name());
        let left: Vec<_> = left.filter(|name| inputs.iter().all(|input| name != input)).collect();
        prop_assert!(left.is_empty(), "{arguments:?} left {left:?}");
    }
    Ok(output)
}

const COMMANDS: [&[&str]; 4] = [
    &["design", "machine.toml", "--json"],
    &["design", "machine.toml", "--compare"],
    &["generate", "machine.toml", "-o", "out"],
    &["simulate", "machine.toml", "-o", "wave.vcd"],
];

proptest! {
    #![proptest_config(config(25))]

    #[test]
    fn prop_damaged_machine_files_are_survived(
        file in 0..MACHINES.len(),
        damage in damage(),
        command in prop::sample::select(&COMMANDS[..]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let text = std::fs::read_to_string(example(MACHINES[file])).unwrap();
        std::fs::write(folder.path().join("machine.toml"), damaged(&text, &damage)).unwrap();
        survives(folder.path(), command)?;
    }

    #[test]
    fn prop_damaged_command_files_are_survived(file in 0..MACHINES.len(), damage in damage()) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::copy(example(MACHINES[file]), folder.path().join("machine.toml")).unwrap();
        std::fs::write(folder.path().join("command.csv"), damaged(COMMAND, &damage)).unwrap();
        survives(folder.path(), &["simulate", "machine.toml", "--command", "command.csv", "-o", "wave.vcd"])?;
    }
}

/// Runs on the XY stage with this text replaced, and expects an error with these words.
#[track_caller]
fn refused(from: &str, to: &str, words: &str) {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    assert!(
        text.contains(from),
        "the example no longer has `{from}`: adapt the test"
    );
    std::fs::write(folder.path().join("machine.toml"), text.replacen(from, to, 1)).unwrap();
    let output = survives(folder.path(), COMMANDS[2]).unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && said.contains(words), "{said}");
}

#[test]
fn cli_sizes_beyond_all_bounds_are_refused_at_once() {
    refused(
        "[[axis]]",
        "[[axis]]\ntrace = { samples = 1_000_000_000_000 }",
        "axis.trace.samples",
    );
    let order = "[axis.shaper]\nkind = \"vibrationless\"\norder = 1_000_000_000";
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let shaper = text.find("[axis.shaper]").unwrap();
    let kind = &text[shaper..][..text[shaper..].find("\n\n").unwrap()];
    refused(kind, order, "order");
    refused("frequency_hz = 50_000_000", "frequency_hz = 1e300", "frequency_hz");
}

#[test]
fn cli_a_table_of_a_hundred_thousand_impulses_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let impulses: String = (0..100_000).map(|n| format!("[{n}, 1],")).collect();
    let text = std::fs::read_to_string(example("custom-shaper.toml")).unwrap();
    let at = text.find("impulses").unwrap();
    // The text is also longer than the largest file, so it is cut to what is read.
    let text = format!("{}impulses = [{impulses}]\n", &text[..at]);
    std::fs::write(folder.path().join("machine.toml"), &text[..(1 << 20) - 1]).unwrap();
    assert_eq!(survives(folder.path(), COMMANDS[0]).unwrap().status.code(), Some(2));
}

/// An endless file, as a machine and as a command; both once took all memory.
#[test]
#[cfg(target_os = "linux")]
fn cli_files_without_an_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(example("xy-stage.toml"), folder.path().join("machine.toml")).unwrap();
    for (arguments, words) in [
        (&["design", "/dev/zero"][..], "goes on after 1048576 bytes"),
        (
            &["simulate", "machine.toml", "--command", "/dev/zero"],
            "a line of more than 65536 bytes",
        ),
    ] {
        let output = survives(folder.path(), arguments).unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(words), "{said}");
    }
}

/// A command of some 10^14 samples, and one of positions whose distance is not a number.
#[test]
fn cli_commands_beyond_all_bounds_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(example("xy-stage.toml"), folder.path().join("machine.toml")).unwrap();
    for points in [
        "0,0\n1e10,1\n",
        "0,-1e308\n1,1e308\n",
        "-1e308,0\n1e308,0\n",
        "0,0\n5e-324,1\n1,1e30\n",
    ] {
        std::fs::write(folder.path().join("command.csv"), format!("time_s,position\n{points}")).unwrap();
        let arguments = ["simulate", "machine.toml", "--command", "command.csv"];
        assert_eq!(
            survives(folder.path(), &arguments).unwrap().status.code(),
            Some(2),
            "{points}"
        );
    }
}
