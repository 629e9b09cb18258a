//! Splits a VCD's value changes into words, and creates the errors for wrong ones.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::digits::known_run;
use super::put::shown;
use crate::WaveError;

/// An error at a place in the buffer.
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) what: String,
}

/// Returns the end of the word at `at`; `None` if the data ends in it.
#[inline]
pub(super) fn word_end(data: &[u8], at: usize) -> Option<usize> {
    let length = data.get(at..)?.iter().position(|byte| *byte <= b' ')?;
    Some(at + length)
}

/// Returns the end of the space at `at`. Control characters are space as in [`word_end`], or a word could be empty
/// for ever.
#[inline]
pub(super) fn skip_space(data: &[u8], mut at: usize) -> usize {
    while let Some(0..=b' ') = data.get(at) {
        at += 1;
    }
    at
}

/// Returns the end of the digits at `at`, and their number if all are known and there are at most 64; `None` if the
/// data ends in them.
#[inline]
pub(super) fn leading_word(data: &[u8], at: usize) -> Option<(Option<u64>, usize)> {
    let (mut word, mut end) = known_run(data, at);
    while let Some(bit @ 0..=1) = data.get(end).map(|byte| byte ^ b'0') {
        word = word << 1 | u64::from(bit);
        end += 1;
    }
    match data.get(end) {
        Some(0..=b' ') if end > at && end - at <= 64 => Some((Some(word), end)),
        _ => Some((None, word_end(data, end)?)),
    }
}

#[cold]
pub(super) fn unknown_id(data: &[u8], at: usize, end: usize) -> Fault {
    let what = if at == end {
        format!(
            "unexpected character `{}`: an id code was expected",
            shown(&data[at..at + 1])
        )
    } else {
        format!(
            "a change of `{}`, which was never declared: the file is damaged",
            shown(&data[at..end])
        )
    };
    Fault { at, what }
}

/// Returns the error of a file that ends too early; `inside` says where.
pub(super) fn truncated(path: &Path, byte: u64, inside: &str) -> WaveError {
    WaveError::Damaged {
        path: path.to_owned(),
        place: format!("byte {byte}"),
        problem: format!(
            "the file ends {inside}: it was cut off, or its writer is still running; write it again \
             (a complete file ends with a line break)"
        ),
    }
}

/// Returns the line of a byte, which is counted only for an error; `None` if the file cannot be read again.
pub(super) fn line_of(path: &Path, byte: u64) -> Option<u64> {
    let file = File::open(path).ok()?;
    if !file.metadata().ok()?.is_file() {
        return None;
    }
    let mut reader = BufReader::new(file.take(byte));
    let mut line = 1;
    loop {
        let buffer = reader.fill_buf().ok()?;
        if buffer.is_empty() {
            return Some(line);
        }
        line += buffer.iter().filter(|b| **b == b'\n').count() as u64;
        let count = buffer.len();
        reader.consume(count);
    }
}
