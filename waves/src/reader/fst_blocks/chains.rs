//! The chains of changes of a block, and their changes in the order of time.
//!
//! ```text
//!  chain of a    │ 0 1 │ 5 … ┊ 12 … │        window by window, each chain is read on to the window's end; what it has is
//!  chain of b    │ 3     7 … ┊ 9  … │        sorted by time, and stays in the order of the chains within a time
//!                └─ window ──┘
//! ```
//!
//! To follow all chains at once, time by time, would read each from a new place in memory for every change.

use std::collections::HashMap;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::Arc;

use super::layout::{Layout, Table};
use super::packing::unpack_chain;
use super::written::{self, Written};
use super::{Form, Stop, damaged};
use crate::reader::batch::Change;
use crate::reader::fst_file::Bytes;
use crate::reader::header::Kind;

/// Number of bytes that are read at once; chains are mostly short.
const READ_BYTES: usize = 1 << 16;
/// Number of changes that a window should have: at least these, and some for each chain, because all are visited.
const CHANGES: usize = 1 << 14;
const PER_CHAIN: usize = 2;
/// With more changes than this, and more than one time, a window is made shorter.
const MOST_CHANGES: usize = 1 << 20;
/// Largest number of times in a window.
const MOST_TIMES: usize = 1 << 16;
const NEVER: u32 = u32::MAX;

/// A signal in a block: how far its chain has been read.
#[derive(Debug, Clone, Copy)]
struct Cursor {
    handle: u32,
    at: u32,
    end: u32,
    /// The time of the change before, and of the next one; [`NEVER`] after the last.
    before: u32,
    next: u32,
}

/// A change that is due at a time of the window.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Due {
    time: u32,
    /// With a word if it has one; [`Due::is_other`] tells whether it is one of these.
    pub(super) change: Change,
    /// The word; for any other change, its handle and its place in the bytes.
    pub(super) word: u64,
}

impl Due {
    /// Whether the change is still to be read, at [`Due::place`].
    #[inline]
    pub(super) fn is_other(&self) -> bool {
        self.change.is_words()
    }

    /// Returns the handle and the place of its change.
    pub(super) fn place(&self) -> (usize, usize) {
        ((self.word >> 32) as usize, (self.word & u64::from(u32::MAX)) as usize)
    }
}

/// All chains of a block, unpacked.
pub(super) struct Chains {
    bytes: Vec<u8>,
    cursors: Vec<Cursor>,
    forms: Arc<[Form]>,
    times: usize,
    /// First time that is still to come, and the number of times of the next window.
    from: usize,
    length: usize,
    /// Changes of the window as they were read, and in the order of time; and where those of each time end.
    found: Vec<Due>,
    sorted: Vec<Due>,
    ends: Vec<u32>,
}

impl Chains {
    /// Unpacks the chains of the signals that are `wanted`, one after the other, so that only one is in memory packed.
    pub(super) fn unpack(
        file: &mut Bytes,
        layout: &Layout,
        table: &Table,
        forms: Arc<[Form]>,
        times: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, Stop> {
        let mut chains = Self {
            bytes: Vec::new(),
            cursors: Vec::new(),
            forms,
            times,
            from: 0,
            length: 64,
            found: Vec::new(),
            sorted: Vec::new(),
            ends: Vec::new(),
        };
        file.seek(SeekFrom::Start(layout.chains_at))?;
        let mut reader = BufReader::with_capacity(READ_BYTES, file);
        let mut reader_at = 0;
        let mut packed = Vec::new();
        let mut known: HashMap<usize, [u32; 2]> = HashMap::new();
        for (handle, place) in table.iter().enumerate() {
            let Some((from, to)) = place.filter(|_| wanted(handle)) else {
                continue;
            };
            // Aliases share a chain.
            let [at, end] = match known.get(&from) {
                Some(range) => *range,
                None => {
                    reader.seek_relative(from as i64 - reader_at as i64)?;
                    packed.resize(to - from, 0);
                    reader.read_exact(&mut packed)?;
                    reader_at = to;
                    let at = chains.bytes.len() as u32;
                    unpack_chain(&packed, layout.packing, &mut chains.bytes)?;
                    let range = [at, chains.bytes.len() as u32];
                    known.insert(from, range);
                    range
                }
            };
            let first = written::change(&chains.bytes[at as usize..end as usize], chains.forms[handle]);
            let next = later(0, first.ok_or_else(short)?.step, times)?;
            chains.cursors.push(Cursor {
                handle: handle as u32,
                at,
                end,
                before: 0,
                next,
            });
        }
        Ok(chains)
    }

    /// Reads on to the end of the next window. `slot` returns the slot and the kind of a handle, and `flush` takes changes of a
    /// window of one time that has too many for the memory. Returns the times of the window; `None` at the end of the block.
    pub(super) fn next_window(
        &mut self,
        slot: impl Fn(usize) -> Option<(u32, Kind)>,
        mut flush: impl FnMut(usize, &[u8], &[Due]) -> Result<(), Stop>,
    ) -> Result<Option<Range<usize>>, Stop> {
        if self.from >= self.times {
            return Ok(None);
        }
        let from = self.from;
        let target = (PER_CHAIN * self.cursors.len()).clamp(CHANGES, MOST_CHANGES / 2);
        let mut saved = Vec::new();
        let mut until = (from + self.length).min(self.times);
        if until - from > 1 {
            saved.clone_from(&self.cursors);
        }
        'again: loop {
            self.found.clear();
            for at in 0..self.cursors.len() {
                let cursor = self.cursors[at];
                if cursor.next as usize >= until {
                    continue;
                }
                let handle = cursor.handle as usize;
                let (slot, kind) = slot(handle).ok_or_else(|| damaged("a signal was never declared"))?;
                let mut chain = Chain {
                    bytes: &self.bytes,
                    form: self.forms[handle],
                    cursor,
                    slot,
                    kind,
                    times: self.times,
                };
                while chain.cursor.next < until as u32 {
                    let most = self.found.len() + CHANGES;
                    chain.read(from as u32, until as u32, most, &mut self.found)?;
                    if self.found.len() <= MOST_CHANGES {
                        continue;
                    }
                    if until - from > 1 {
                        self.cursors.clone_from(&saved);
                        until = from + ((until - from) / 8).max(1);
                        continue 'again;
                    }
                    flush(from, &self.bytes, &self.found)?;
                    self.found.clear();
                }
                self.cursors[at] = chain.cursor;
            }
            break;
        }
        let count = until - from;
        let found = self.found.len().max(1);
        self.length = (count * target / found).clamp(1, (4 * count).min(MOST_TIMES));
        self.from = until;
        self.sort(count);
        Ok(Some(from..until))
    }

    /// Sorts the changes of a window by their times, of which it has this many.
    fn sort(&mut self, times: usize) {
        self.ends.clear();
        self.ends.resize(times + 1, 0);
        for due in &self.found {
            self.ends[due.time as usize + 1] += 1;
        }
        for at in 0..times {
            self.ends[at + 1] += self.ends[at];
        }
        self.sorted.resize(self.found.len(), Due::default());
        // The beginning of each time moves on to its end.
        for due in &self.found {
            let place = &mut self.ends[due.time as usize];
            self.sorted[*place as usize] = *due;
            *place += 1;
        }
    }

    /// Returns the changes at a time of the window, counted from its beginning.
    #[inline]
    pub(super) fn due(&self, at: usize) -> &[Due] {
        let from = at.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.sorted[from as usize..self.ends[at] as usize]
    }

    /// Returns the bytes in which [`Due::place`] is.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

fn short() -> Stop {
    damaged("the changes of a signal end too early")
}

/// Returns the time that is so much later, of so many times.
#[inline]
fn later(before: u32, step: u64, times: usize) -> Result<u32, Stop> {
    match u32::try_from(u64::from(before).saturating_add(step)) {
        Ok(time) if (time as usize) < times => Ok(time),
        _ => Err(damaged("a change is later than the last time")),
    }
}

/// A chain while it is read.
struct Chain<'a> {
    bytes: &'a [u8],
    form: Form,
    cursor: Cursor,
    slot: u32,
    kind: Kind,
    times: usize,
}

impl Chain<'_> {
    /// Appends its changes from the time `from` of the window up to the time `until`, until there are `most`.
    fn read(&mut self, from: u32, until: u32, most: usize, found: &mut Vec<Due>) -> Result<(), Stop> {
        let chain = self.bytes.get(..self.cursor.end as usize).ok_or_else(short)?;
        let Cursor {
            handle,
            mut at,
            mut before,
            ..
        } = self.cursor;
        let next = loop {
            let place = at as usize;
            if place >= chain.len() {
                break NEVER;
            }
            let written::Change { step, value, length } =
                written::change(&chain[place..], self.form).ok_or_else(short)?;
            let time = later(before, step, self.times)?;
            if time >= until || found.len() >= most {
                break time;
            }
            let (change, word) = match (value, self.kind) {
                (Written::Digit(digit @ 0..=3), Kind::Bits(1)) => (Change::digit(self.slot, digit), 0),
                (Written::Known(bytes), Kind::Bits(width @ 1..=64)) if self.form == Form::Bits(width) => {
                    let word = bytes.iter().fold(0u64, |word, byte| word << 8 | u64::from(*byte));
                    (Change::known(self.slot), word >> (8 * bytes.len() as u32 - width))
                }
                _ => (Change::words(self.slot), u64::from(handle) << 32 | place as u64),
            };
            found.push(Due {
                time: time - from,
                change,
                word,
            });
            at += length as u32;
            before = time;
        };
        self.cursor = Cursor {
            at,
            before,
            next,
            ..self.cursor
        };
        Ok(())
    }
}
