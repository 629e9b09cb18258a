//! Mutated recordings through all readers: no panic of ours, no file that takes long, and little memory.
//!
//! ```sh
//! cargo run --release -p wavecmp --example mutated_files -- 1000000        # so many files
//! cargo run --release -p wavecmp --example mutated_files -- 1000000 7      # beginning with this seed
//! ```
//!
//! Each file is one of the fixtures (VCD of each producer, FST, packed, cut off) with up to eight edits, and is compared with
//! itself, at a clock or at every change: it must be an error, or not differ. a panic is
//! counted and ends the run with exit status 1.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::panic, clippy::exit)] // it stops where it fails

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use wavecmp::diff::{self, DiffOptions, DiffVerdict};

const FOLDERS: [&str; 3] = ["waves", "packed", "cut"];
const WORDS: [&[u8]; 10] = [
    b"$end ",
    b"$scope module x $end ",
    b"$var wire 99999999 ! y $end ",
    b"$dumpoff\n",
    b"$comment ",
    b"\n#18446744073709551615\n",
    b"\n#",
    b"b",
    b"r1e999 !\n",
    b"\n",
];
const LONGEST: Duration = Duration::from_secs(10);

static PANICS: AtomicU64 = AtomicU64::new(0);

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % end.max(1)
    }
}

fn recordings() -> Vec<(PathBuf, Vec<u8>)> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let files = FOLDERS
        .iter()
        .flat_map(|folder| std::fs::read_dir(fixtures.join(folder)).unwrap());
    let mut paths: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|end| ["vcd", "fst", "gz", "xz", "zst"].contains(&end.to_str().unwrap()))
    });
    paths.sort();
    let read = |path: PathBuf| {
        let content = std::fs::read(&path).unwrap();
        (path, content)
    };
    paths.into_iter().map(read).collect()
}

fn mutate(content: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(8) {
        let at = random.below(content.len() + 1);
        let to = (at + random.below(16)).min(content.len());
        match random.below(6) {
            0 if at < content.len() => content[at] ^= 1 << random.below(8),
            1 if at < content.len() => content[at] = random.below(256) as u8,
            2 => drop(content.drain(at..to)),
            3 => {
                let word = WORDS[random.below(WORDS.len())];
                content.splice(at..at, word.iter().copied());
            }
            4 => {
                let piece = content[at..to].to_vec();
                content.splice(at..at, piece);
            }
            _ => {
                if random.below(8) == 0 {
                    content.truncate(at);
                }
            }
        }
    }
}

fn main() {
    let numbers: Vec<u64> = std::env::args().skip(1).map(|word| word.parse().unwrap()).collect();
    let count = numbers.first().copied().unwrap_or(10_000);
    let seed = numbers.get(1).copied().unwrap_or(1);
    std::panic::set_hook(Box::new(|panic| {
        PANICS.fetch_add(1, Ordering::Relaxed);
        println!("{panic}");
    }));
    let recordings = recordings();
    let folder = tempfile::tempdir().unwrap();
    let mut longest = Duration::ZERO;
    let [mut read, mut refused] = [0u64; 2];
    for number in 0..count {
        let mut random = Random((seed + number).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        random.below(2);
        let (source, content) = &recordings[random.below(recordings.len())];
        let mut content = content.clone();
        mutate(&mut content, &mut random);
        let path = folder.path().join(source.file_name().unwrap());
        std::fs::write(&path, &content).unwrap();
        if source.ends_with("killed.fst") {
            std::fs::copy(source.with_extension("fst.hier"), path.with_extension("fst.hier")).unwrap();
        }
        let raw = random.below(2) == 0;
        let options = DiffOptions {
            raw,
            allow_truncated: random.below(2) == 0,
            glitch_fs: if raw { 1_000_000 * random.below(3) as u128 } else { 0 },
            ..DiffOptions::default()
        };
        let start = Instant::now();
        match diff::compare(&path, &path, &options, &mut |_| {}) {
            Ok(result) => {
                read += 1;
                assert_ne!(
                    result.result,
                    DiffVerdict::Different,
                    "file {number} differs from itself: {result}"
                );
            }
            Err(_) => refused += 1,
        }
        longest = longest.max(start.elapsed());
        assert!(longest < LONGEST, "file {number} took {longest:?}");
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status
        .lines()
        .find(|line| line.starts_with("VmHWM"))
        .unwrap_or("VmHWM: unknown");
    let panics = PANICS.load(Ordering::Relaxed);
    println!(
        "{count} files from seed {seed}: {read} read, {refused} refused, {panics} panics; longest {longest:?}; {peak}"
    );
    if panics > 0 {
        std::process::exit(1);
    }
}
