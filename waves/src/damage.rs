//! Recordings damaged at random, by a seed: what the reader and the comparison must survive.
//!
//! Bytes are replaced, words of the format are inserted at wrong places, or the end of another recording is appended. Reading the result
//! must give an error or a comparison: the comparison never panics; it never finds that a file differs from itself; and it finds the same
//! for *a* and *b* as for *b* and *a*, signal by signal: equal numbers of differences, and the values of each first difference in the other
//! order.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::WaveError;
use crate::diff::{self, Comparison, DiffOptions, DiffVerdict};

/// Words with a meaning for a parser of VCD, inserted at wrong places.
const WORDS: [&[u8]; 16] = [
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
    b"$var wire 1 abcdefghij y $end ",
    b"1abcdefghij\n",
    b"bxz !\n",
    b"r1e999 !\n",
    b"rnan !\n",
    b"\n",
];
/// Digits of a vector or a single bit.
const DIGITS: [u8; 4] = *b"01xz";
/// Largest number of bytes that one damage removes or inserts.
const MOST_REMOVED: usize = 20;
const MOST_INSERTED: usize = 5;
/// Largest number of damages of a file, and of changed digits.
const MOST_DAMAGES: usize = 5;
/// Largest width that a declaration may get.
const MOST_WIDTH: u32 = 130;

/// How the program handled a damaged recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Survival {
    /// It still has a result in a comparison.
    Read,
    /// It is refused with an error.
    Refused,
}

/// Damages one of `recordings`, which `seed` chooses too. Returns the original and the damaged bytes; equal seeds give equal bytes.
pub fn damaged(recordings: &[Vec<u8>], seed: u64) -> (Vec<u8>, Vec<u8>) {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let original = recordings.choose(&mut rng).cloned().unwrap_or_default();
    let mut content = original.clone();
    if rng.random() {
        (0..MOST_DAMAGES).for_each(|_| change(&mut content, &mut rng));
        if rng.random() {
            return (original, content);
        }
    }
    if rng.random_ratio(1, 4) {
        // Join the beginning of one file and the end of another.
        let other = recordings.choose(&mut rng).map_or(&[][..], Vec::as_slice);
        content.truncate(rng.random_range(0..=content.len()));
        content.extend(&other[rng.random_range(0..=other.len())..]);
    }
    for _ in 0..rng.random_range(1..=MOST_DAMAGES) {
        damage(&mut content, &mut rng);
    }
    (original, content)
}

/// Damages a content once: anywhere, or at the beginning of a line, where a parser expects a word.
fn damage(content: &mut Vec<u8>, rng: &mut Xoshiro256PlusPlus) {
    let from = rng.random_range(0..=content.len());
    let to = (from + rng.random_range(0..MOST_REMOVED)).min(content.len());
    let word = WORDS[rng.random_range(0..WORDS.len())];
    match rng.random_range(0..3) {
        0 => {
            let count = rng.random_range(0..=MOST_INSERTED);
            let bytes: Vec<u8> = (0..count).map(|_| rng.random()).collect();
            content.splice(from..to, bytes);
        }
        1 => {
            content.splice(from..to, word.iter().copied());
        }
        _ => {
            let at = content[..from].iter().rposition(|byte| *byte == b'\n');
            let at = at.map_or(0, |end| end + 1);
            content.splice(at..at, word.iter().copied());
        }
    }
}

/// Changes a value or a declaration of a VCD. Most such recordings can still be read.
fn change(content: &mut Vec<u8>, rng: &mut Xoshiro256PlusPlus) {
    match rng.random_range(0..6) {
        0 => redeclare(content, rng),
        1 => change_number(content, rng),
        _ => change_digit(content, rng),
    }
}

/// Places where lines begin, from a random one on.
fn lines(content: &[u8], rng: &mut Xoshiro256PlusPlus) -> impl Iterator<Item = usize> {
    let from = rng.random_range(0..=content.len());
    (from..content.len()).filter(|at| *at == 0 || content[at - 1] == b'\n')
}

/// Changes a digit of a vector or a single bit.
fn change_digit(content: &mut [u8], rng: &mut Xoshiro256PlusPlus) {
    let digit = lines(content, rng).find_map(|at| {
        let at = at + usize::from(content[at] == b'b');
        content.get(at).is_some_and(|byte| DIGITS.contains(byte)).then_some(at)
    });
    if let Some(at) = digit {
        content[at] = DIGITS[rng.random_range(0..DIGITS.len())];
    }
}

/// Makes a real value not a number.
fn change_number(content: &mut Vec<u8>, rng: &mut Xoshiro256PlusPlus) {
    let line = lines(content, rng).find(|at| content[*at] == b'r');
    let value = line.and_then(|at| Some((at + 1, at + content[at..].iter().position(|byte| *byte == b' ')?)));
    if let Some((from, to)) = value {
        content.splice(from..to, *b"nan");
    }
}

/// Declares a signal with another width, or under an id code that is too long: `$var TYPE WIDTH ID …`.
fn redeclare(content: &mut Vec<u8>, rng: &mut Xoshiro256PlusPlus) {
    let declarations = (0..content.len()).filter(|at| content[*at..].starts_with(b"$var "));
    let Some(declaration) = declarations.collect::<Vec<_>>().choose(rng).copied() else {
        return;
    };
    let spaces: Vec<usize> = (declaration..content.len())
        .filter(|at| content[*at] == b' ')
        .take(4)
        .collect();
    let [_, before_width, before_id, after_id] = spaces[..] else {
        return;
    };
    if rng.random() {
        content.splice(before_id + 1..after_id, *b"abcdefghi!");
    } else {
        let width = rng.random_range(1..=MOST_WIDTH).to_string();
        content.splice(before_width + 1..before_id, width.into_bytes());
    }
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
    let survival = match findings(&damaged, &damaged, &options)? {
        Ok(found) if found.result == DiffVerdict::Different => {
            return Err("a damaged recording differs from itself".to_owned());
        }
        Ok(_) => Survival::Read,
        Err(_) => Survival::Refused,
    };
    let one_way = findings(&original, &damaged, &options)?.ok();
    let other_way = findings(&damaged, &original, &options)?.ok().map(Findings::turned);
    if one_way != other_way {
        return Err(format!(
            "one way it is {one_way:?}, the other way, turned round, {other_way:?}"
        ));
    }
    Ok(survival)
}

/// What a comparison found, without names and times, which are those of the first file.
#[derive(Debug, PartialEq)]
struct Findings {
    result: DiffVerdict,
    signals: u64,
    samples: u64,
    /// Number of signals without a partner, of each file.
    alone: [usize; 2],
    /// Of each signal that differs: number of samples, whether they differ at the end, and the first two values, in no order.
    /// Values are text, so that an invalid number is equal to itself.
    differences: Vec<(u64, bool, [String; 2])>,
}

impl Findings {
    fn from_comparison(found: &Comparison) -> Self {
        let differences = found.differences.iter();
        let mut differences: Vec<_> = differences
            .map(|of| (of.count, of.persistent, [format!("{:?}", of.a), format!("{:?}", of.b)]))
            .collect();
        differences.sort_unstable();
        Self {
            result: found.result,
            signals: found.signals,
            samples: found.samples,
            alone: [found.only_in_a.len(), found.only_in_b.len()],
            differences,
        }
    }

    /// The same with both files exchanged.
    fn turned(mut self) -> Self {
        self.alone.reverse();
        self.differences.iter_mut().for_each(|(_, _, values)| values.reverse());
        self.differences.sort_unstable();
        self
    }
}

/// Result or error of a comparison; the outer error is a panic.
fn findings(a: &Path, b: &Path, options: &DiffOptions) -> Result<Result<Findings, WaveError>, String> {
    let compare = || diff::compare(a, b, options, &mut |_| {}).map(|found| Findings::from_comparison(&found));
    catch_unwind(AssertUnwindSafe(compare)).map_err(|cause| {
        let said = cause.downcast_ref::<String>().map(String::as_str);
        let said = said
            .or_else(|| cause.downcast_ref::<&str>().copied())
            .unwrap_or("no message");
        format!("the comparison panicked: {said}")
    })
}
