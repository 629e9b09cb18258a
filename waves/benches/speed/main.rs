//! Speed and memory of `wavecmp` on pairs of large files, compared with a probe on the crate `wellen` that loads them,
//! and with reading the bytes alone, all in one run.
//!
//! ```sh
//! cargo bench -p wavecmp --bench speed                       # pairs of 400 MB
//! cargo bench -p wavecmp --bench speed -- --megabytes 50
//! cargo bench -p wavecmp --bench speed -- --generate DIR 20  # only writes the pairs, of 20 MB each, to DIR
//! cargo bench -p wavecmp --bench speed -- --files A B        # two existing files
//! ```
//!
//! The files of a pair differ in one bit near their end. Each run is a separate process, so that its peak memory
//! (`VmHWM`) and its processor time can be measured; all read files that are in the system's cache. On a machine that
//! does other work, the processor time says more than the elapsed time, which with two free cores is at least half of
//! it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, clippy::panic)] // a bench stops where it fails

mod generator;
mod probe;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use wavecmp::diff::{self, DiffOptions, DiffVerdict};

use self::generator::{Recording, Second, Shape};

const RUNS: usize = 3;
const PAIRS: [(&str, Shape, Second); 10] = [
    ("words, other names", Shape::Words, Second::OtherNames),
    ("words, same bytes", Shape::Words, Second::SameBytes),
    ("flags, other names", Shape::Flags, Second::OtherNames),
    ("flags, same bytes", Shape::Flags, Second::SameBytes),
    ("words with x, other names", Shape::Unknown, Second::OtherNames),
    ("words, FST", Shape::Words, Second::Fst),
    ("flags, FST", Shape::Flags, Second::Fst),
    ("flags, FST, other blocks", Shape::Flags, Second::FstOtherBlocks),
    ("50,000 signals, other names", Shape::Many, Second::OtherNames),
    ("50,000 signals, FST", Shape::Many, Second::Fst),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["--run", how, a, b] => run(how, Path::new(a), Path::new(b)),
        ["--files", a, b] => compare("two files", Path::new(a), Path::new(b)),
        ["--generate", folder, megabytes] => {
            for pair in 0..PAIRS.len() {
                generate(Path::new(folder), pair, number(megabytes));
            }
        }
        ["--megabytes", megabytes] => all(number(megabytes)),
        [] => all(400),
        _ => panic!("--megabytes N, --generate DIR N or --files A B"),
    }
}

fn number(megabytes: &str) -> u64 {
    megabytes.parse().expect("megabytes are a whole number")
}

fn all(megabytes: u64) {
    let folder = tempfile::tempdir().unwrap();
    for (pair, (name, ..)) in PAIRS.iter().enumerate() {
        let [a, b] = generate(folder.path(), pair, megabytes);
        compare(name, &a, &b);
        for path in [a, b] {
            std::fs::remove_file(path).unwrap();
        }
    }
}

fn generate(folder: &Path, pair: usize, megabytes: u64) -> [PathBuf; 2] {
    let (_, shape, second) = PAIRS[pair];
    let extension = match second {
        Second::Fst | Second::FstOtherBlocks => "fst",
        Second::OtherNames | Second::SameBytes => "vcd",
    };
    let paths = ["a", "b"].map(|name| folder.join(format!("{pair}{name}.{extension}")));
    for (path, is_second) in paths.iter().zip([false, true]) {
        let recording = Recording {
            shape,
            reversed: is_second && second == Second::OtherNames,
            flip: is_second,
            // The size that `vcd2fst` writes.
            fst_block: if is_second && second == Second::FstOtherBlocks {
                20 << 20
            } else {
                32 << 20
            },
        };
        let summary = match second {
            // About as many clocks as a VCD of that length has.
            Second::Fst | Second::FstOtherBlocks => {
                let per_clock = if shape == Shape::Words { 370 } else { 120 };
                recording.write_fst(path, megabytes as usize * 1_000_000 / per_clock)
            }
            _ => recording.write(path, megabytes * 1_000_000),
        };
        let summary = summary.unwrap();
        println!("{}: {summary}", path.display());
    }
    paths
}

fn compare(name: &str, a: &Path, b: &Path) {
    let bytes: u64 = [a, b].iter().map(|path| path.metadata().unwrap().len()).sum();
    println!("{name}: {:.0} MB in two files, best of {RUNS} runs", bytes as f64 / 1e6);
    for how in ["reading", "wavecmp", "wellen"] {
        let runs = (0..RUNS).map(|_| {
            let program = std::env::current_exe().unwrap();
            let output = Command::new(program)
                .arg("--run")
                .arg(how)
                .args([a, b])
                .output()
                .unwrap();
            let text = String::from_utf8(output.stdout).unwrap();
            let numbers: Vec<f64> = text.split_whitespace().map(|n| n.parse().expect(&text)).collect();
            [numbers[0], numbers[1], numbers[2]]
        });
        let runs: Vec<[f64; 3]> = runs.collect();
        let least = |at: usize| runs.iter().map(|run| run[at]).fold(f64::INFINITY, f64::min);
        let megabytes = bytes as f64 / 1e6;
        println!(
            "  {how:9} {:6.2} s {:6.0} MB/s   processor {:6.2} s {:6.0} MB/s on 2 cores   peak {:6.1} MB",
            least(0),
            megabytes / least(0),
            least(1),
            2.0 * megabytes / least(1),
            least(2)
        );
    }
}

/// Runs one comparison, and prints its seconds, those of the processor, and its peak memory in MB.
fn run(how: &str, a: &Path, b: &Path) {
    let start = Instant::now();
    let differs = match how {
        "wavecmp" => {
            let result = diff::compare(a, b, &DiffOptions::default(), &mut |_| {}).unwrap();
            result.result == DiffVerdict::Different
        }
        "wellen" => probe::differs(a, b),
        _ => {
            let mut buffer = vec![0; 1 << 18];
            for path in [a, b] {
                let mut file = std::fs::File::open(path).unwrap();
                while std::io::Read::read(&mut file, &mut buffer).unwrap() > 0 {}
            }
            true
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    assert!(differs, "the files differ in one bit");
    println!("{seconds} {} {}", processor_seconds(), peak_megabytes());
}

/// Returns the processor time in seconds that this process has used in all its threads, as Linux reports it in
/// hundredths of a second.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let fields: Vec<f64> = after_name
        .split_whitespace()
        .map(|field| field.parse().unwrap_or(0.0))
        .collect();
    fields
        .get(11)
        .zip(fields.get(12))
        .map_or(f64::NAN, |(user, system)| (user + system) / 100.0)
}

/// Returns the largest resident memory of this process so far, as Linux reports it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes * 1024.0 / 1e6)
}
