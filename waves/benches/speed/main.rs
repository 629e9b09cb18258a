//! Speed and memory of `wavecmp` on two large files, compared with a probe on the crate `wellen` that loads them.
//!
//! ```sh
//! cargo bench -p wavecmp --bench speed                       # two files of 500 MB
//! cargo bench -p wavecmp --bench speed -- --megabytes 50
//! cargo bench -p wavecmp --bench speed -- --generate DIR     # only writes a.vcd and b.vcd there
//! cargo bench -p wavecmp --bench speed -- --files A B        # two files that are there
//! ```
//!
//! The files differ in one bit near their end. Each run is a separate process, so that its peak memory (`VmHWM`) can
//! be measured; both read files that are in the system's cache.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, clippy::panic)] // a bench stops where it fails

mod generator;
mod probe;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use wavecmp::diff::{self, DiffOptions, DiffVerdict};

const RUNS: usize = 3;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["--run", how, a, b] => run(how, Path::new(a), Path::new(b)),
        ["--files", a, b] => compare(Path::new(a), Path::new(b)),
        ["--generate", folder] => drop(generate(Path::new(folder), 500)),
        ["--megabytes", megabytes] => in_scratch(megabytes.parse().expect("--megabytes takes a whole number")),
        [] => in_scratch(500),
        _ => panic!("--megabytes N, --generate DIR or --files A B"),
    }
}

fn in_scratch(megabytes: u64) {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = generate(folder.path(), megabytes);
    compare(&a, &b);
}

fn generate(folder: &Path, megabytes: u64) -> [PathBuf; 2] {
    let paths = ["a.vcd", "b.vcd"].map(|name| folder.join(name));
    for (path, flip) in paths.iter().zip([false, true]) {
        let summary = generator::write(path, megabytes * 1_000_000, flip).unwrap();
        println!("{}: {summary}", path.display());
    }
    paths
}

fn compare(a: &Path, b: &Path) {
    let bytes: u64 = [a, b].iter().map(|path| path.metadata().unwrap().len()).sum();
    println!("{:.0} MB in two files, best of {RUNS} runs", bytes as f64 / 1e6);
    for how in ["wavecmp", "wellen"] {
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
            (numbers[0], numbers[1])
        });
        let best = runs.min_by(|x, y| x.0.total_cmp(&y.0)).unwrap();
        println!(
            "{how:9} {:6.2} s  {:6.0} MB/s  peak {:6.1} MB",
            best.0,
            bytes as f64 / 1e6 / best.0,
            best.1
        );
    }
}

/// Runs one comparison, and prints its seconds and its peak memory in MB.
fn run(how: &str, a: &Path, b: &Path) {
    let start = Instant::now();
    let differs = match how {
        "wavecmp" => {
            let result = diff::compare(a, b, &DiffOptions::default(), &mut |_| {}).unwrap();
            result.result == DiffVerdict::Different
        }
        _ => probe::differs(a, b),
    };
    let seconds = start.elapsed().as_secs_f64();
    assert!(differs, "the files differ in one bit");
    println!("{seconds} {}", peak_megabytes());
}

/// Returns the largest resident memory of this process so far, as Linux reports it.
fn peak_megabytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes * 1024.0 / 1e6)
}
