//! Recordings damaged at random, by a seed: what the reader and the comparison must survive.
//!
//! A recording with bytes replaced, words of the format at wrong places, or the end of another one, is an error or has a result. The
//! comparison never panics on it; it does not find that a file differs from itself; and it finds the same for *a* and *b* as for *b* and *a*.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::WaveError;
use crate::diff::{self, DiffOptions, DiffVerdict};

/// Words with a meaning for a parser of VCD, inserted at wrong places.
const WORDS: [&[u8]; 12] = [
    b"$end ",
    b"$scope module x $end ",
    b"$upscope $end ",
    b"$var wire 99999999 ! y $end ",
    b"$enddefinitions $end\n",
    b"$dumpoff\n",
    b"$comment ",
    b"\n#18446744073709551615\n",
    b"\n#18446744073709551616\n",
    b"b",
    b"r1e999 !\n",
    b"\n",
];
/// Number of bytes that a damage removes or inserts, at most.
const MOST_REMOVED: usize = 20;
const MOST_INSERTED: usize = 5;
/// Number of damages of a file, at most.
const MOST_DAMAGES: usize = 5;

/// What became of a damaged recording that was survived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Survival {
    /// It still has a result in a comparison.
    Read,
    /// It is refused with an error.
    Refused,
}

/// Damages one of `recordings`, which is chosen by `seed` too, and returns it as it was and as it is now. Equal seeds give equal bytes.
pub fn damaged(recordings: &[Vec<u8>], seed: u64) -> (Vec<u8>, Vec<u8>) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let original = recordings.choose(&mut rng).cloned().unwrap_or_default();
    let mut content = original.clone();
    if rng.random_ratio(3, 10) {
        // The beginning of one file with the end of another.
        let other = recordings.choose(&mut rng).map_or(&[][..], Vec::as_slice);
        content.truncate(rng.random_range(0..=content.len()));
        content.extend(&other[rng.random_range(0..=other.len())..]);
    }
    for _ in 0..rng.random_range(1..=MOST_DAMAGES) {
        let from = rng.random_range(0..=content.len());
        let to = (from + rng.random_range(0..MOST_REMOVED)).min(content.len());
        let bytes: Vec<u8> = if rng.random() {
            WORDS[rng.random_range(0..WORDS.len())].to_vec()
        } else {
            let count = rng.random_range(0..=MOST_INSERTED);
            (0..count).map(|_| rng.random()).collect()
        };
        content.splice(from..to, bytes);
    }
    (original, content)
}

/// Damages a recording as [`damaged`] does, and compares it with itself and with what it was, both ways. The files are written into `folder`
/// and stay there.
///
/// # Errors
/// A sentence that says what the comparison did wrong, or why a file could not be written.
pub fn trial(recordings: &[Vec<u8>], seed: u64, folder: &Path) -> Result<Survival, String> {
    let (original, content) = damaged(recordings, seed);
    let paths = [("original", original), ("damaged", content)].map(|(name, content)| {
        let path = folder.join(name);
        std::fs::write(&path, content)
            .map(|()| path.clone())
            .map_err(|cause| format!("{}: {cause}", path.display()))
    });
    let [original, damaged] = paths;
    let (original, damaged) = (original?, damaged?);
    let raw = seed % 2 == 1;
    let options = DiffOptions {
        raw,
        glitch_fs: u128::from(raw) * 3_000_000,
        ..DiffOptions::default()
    };
    let survival = match verdict(&damaged, &damaged, &options)? {
        Ok(DiffVerdict::Different) => return Err("a damaged recording differs from itself".to_owned()),
        Ok(_) => Survival::Read,
        Err(_) => Survival::Refused,
    };
    let one_way = verdict(&original, &damaged, &options)?;
    let other_way = verdict(&damaged, &original, &options)?;
    if one_way.as_ref().ok() != other_way.as_ref().ok() {
        return Err(format!("one way it is {one_way:?}, the other way {other_way:?}"));
    }
    Ok(survival)
}

/// Verdict or error of a comparison; the outer error is a panic.
fn verdict(a: &Path, b: &Path, options: &DiffOptions) -> Result<Result<DiffVerdict, WaveError>, String> {
    let compare = || diff::compare(a, b, options, &mut |_| {}).map(|report| report.result);
    catch_unwind(AssertUnwindSafe(compare)).map_err(|cause| {
        let said = cause.downcast_ref::<String>().map(String::as_str);
        let said = said
            .or_else(|| cause.downcast_ref::<&str>().copied())
            .unwrap_or("no message");
        format!("the comparison panicked: {said}")
    })
}
