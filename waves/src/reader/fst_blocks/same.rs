//! Finds the signals whose changes are written with the same bytes in two files.
//!
//! Two runs of a simulator write blocks of the same times, in which most chains are equal byte for byte. Such chains are
//! looked through once, so that damage does not stay hidden, and then neither file's are read again.
//!
//! ```text
//!  block of a   times │ chain │ chain │ …      the same times, and for each pair of signals the same chain: in all blocks
//!  block of b   times │ chain │ chain │ …
//! ```

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::layout::{Layout, Parts};
use super::packing::{unpack_chain, varint};
use super::written::{Change, Written, change};
use super::{Block, Blocks, Form};
use crate::reader::digits::digit;

const THREADS: usize = 4;
/// Largest number of packed bytes of a block that are held for each file.
const MOST_BYTES: u64 = 1 << 26;
/// Signals that a thread takes at once.
const GRAIN: usize = 64;

/// What is the same in two files.
pub(in crate::reader) struct Same {
    /// Whether each pair has the same changes in both files.
    pub(in crate::reader) pairs: Vec<bool>,
    /// For each block, a bit for each time at which one of these pairs changes; empty if they were not wanted.
    pub(in crate::reader) times: Vec<Vec<u64>>,
    /// Whether each time is later than the one before, in all blocks.
    pub(in crate::reader) times_rise: bool,
}

/// A block of both files, if they have the same times.
struct Both {
    parts: [Parts; 2],
    chains: [Vec<u8>; 2],
    /// Number of times, the first and the last of them, and whether each is later than the one before.
    times: usize,
    ends: Option<[u64; 2]>,
    times_rise: bool,
    packing: u8,
}

/// Compares the chains of pairs of handles; the result is useful only if all `needed` pairs have the same changes. Returns `None` if one of
/// those, or most of the others, have different changes, or if anything is unusual: the files must then be read as they are.
pub(in crate::reader) fn same(
    [a, b]: [&mut Blocks; 2],
    pairs: &[[usize; 2]],
    needed: &[usize],
    with_times: bool,
) -> Option<Same> {
    let alike = a.blackouts == b.blackouts && a.little_endian == b.little_endian && a.blocks.len() == b.blocks.len();
    let forms = |[of_a, of_b]: &[usize; 2]| a.forms.get(*of_a).is_some() && a.forms.get(*of_a) == b.forms.get(*of_b);
    if !alike || !pairs.iter().all(forms) {
        return None;
    }
    let is_same: Vec<AtomicBool> = pairs.iter().map(|_| AtomicBool::new(true)).collect();
    let mut times = Vec::new();
    let (mut times_rise, mut last) = (true, None);
    for number in 0..a.blocks.len() {
        let blocks = [a.blocks[number], b.blocks[number]];
        if number == 0 {
            compare_first_values([&mut *a, &mut *b], blocks, pairs, &is_same)?;
        }
        let both = Both::read([&mut *a, &mut *b], blocks)?;
        times_rise &= both.times_rise;
        if let Some([first, end]) = both.ends {
            times_rise &= last.is_none_or(|last| last < first);
            last = Some(end);
        }
        let changed = both.compare(&a.forms, pairs, &is_same, with_times);
        times.extend(with_times.then_some(changed));
        let left = is_same.iter().filter(|same| same.load(Ordering::Relaxed)).count();
        let is_needed = |pair: &usize| is_same[*pair].load(Ordering::Relaxed);
        if left < pairs.len() / 4 || !needed.iter().all(is_needed) {
            return None;
        }
    }
    let pairs = is_same.into_iter().map(AtomicBool::into_inner).collect();
    Some(Same {
        pairs,
        times,
        times_rise,
    })
}

/// Compares the values before the first change.
fn compare_first_values(
    files: [&mut Blocks; 2],
    blocks: [Block; 2],
    pairs: &[[usize; 2]],
    is_same: &[AtomicBool],
) -> Option<()> {
    let mut values = Vec::new();
    let mut places = Vec::new();
    for (of, block) in files.into_iter().zip(blocks) {
        let layout = Layout::read(&mut of.file, block).ok()??;
        values.push(layout.values(&mut of.file).ok()?);
        let count = usize::try_from(layout.values_of).ok()?;
        let mut at = 0;
        let place = |form: &Form| {
            let from = at;
            at += form.bytes_before();
            from..at
        };
        places.push(of.forms.iter().take(count).map(place).collect::<Vec<_>>());
    }
    for (pair, same) in pairs.iter().zip(is_same) {
        let value = |at: usize| {
            let place = places[at].get(pair[at]);
            place.map(|place| values[at].get(place.clone()))
        };
        if value(0) != value(1) {
            same.store(false, Ordering::Relaxed);
        }
    }
    Some(())
}

impl Both {
    fn read(files: [&mut Blocks; 2], blocks: [Block; 2]) -> Option<Self> {
        let mut layouts = Vec::new();
        let mut parts = Vec::new();
        let mut chains = Vec::new();
        for (of, block) in files.into_iter().zip(blocks) {
            let layout = Layout::read(&mut of.file, block).ok()??;
            if layout.handles > of.forms.len() as u64 {
                return None;
            }
            let found = layout.parts(&mut of.file).ok()?;
            if found.chains > MOST_BYTES {
                return None;
            }
            chains.push(layout.chains(&mut of.file, found.chains).ok()?);
            parts.push(found);
            layouts.push(layout);
        }
        let same = layouts[0].start == layouts[1].start
            && layouts[0].packing == layouts[1].packing
            && parts[0].packed_times == parts[1].packed_times
            && parts[0].times == parts[1].times;
        if !same {
            return None;
        }
        let times = parts[0].times()?;
        Some(Self {
            packing: layouts[0].packing,
            times: times.len(),
            times_rise: times.windows(2).all(|pair| pair[0] < pair[1]),
            ends: times.first().zip(times.last()).map(|(first, last)| [*first, *last]),
            parts: parts.try_into().ok()?,
            chains: chains.try_into().ok()?,
        })
    }

    /// Compares the chains of the pairs that were the same so far. Returns a bit for each time at which one of them changes.
    fn compare(&self, forms: &[Form], pairs: &[[usize; 2]], is_same: &[AtomicBool], with_times: bool) -> Vec<u64> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(THREADS);
        let next = AtomicUsize::new(0);
        let words = if with_times { self.times.div_ceil(64) } else { 0 };
        let all = Mutex::new(vec![0; words]);
        let work = || {
            let mut changed = vec![0; words];
            let mut unpacked = Vec::new();
            loop {
                let from = next.fetch_add(GRAIN, Ordering::Relaxed);
                let Some(some) = pairs.get(from..) else { break };
                for (pair, same) in some.iter().zip(&is_same[from..]).take(GRAIN) {
                    if same.load(Ordering::Relaxed) && self.chain(forms, *pair, &mut unpacked, &mut changed).is_none() {
                        same.store(false, Ordering::Relaxed);
                    }
                }
            }
            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
            for (all, changed) in all.iter_mut().zip(&changed) {
                *all |= changed;
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(work);
            }
            work();
        });
        all.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Compares the chains of a pair; `None` if they are not the same, or cannot be read.
    fn chain(&self, forms: &[Form], pair: [usize; 2], unpacked: &mut Vec<u8>, changed: &mut [u64]) -> Option<()> {
        let [a, b] = [0, 1].map(|at| {
            let place = self.parts[at].table.get(pair[at]).copied().flatten();
            place.map(|(from, to)| self.chains[at].get(from..to))
        });
        if a != b {
            return None;
        }
        let Some(chain) = a else { return Some(()) };
        unpacked.clear();
        unpack_chain(chain?, self.packing, unpacked).ok()?;
        if changed.is_empty() && forms.get(pair[0]) == Some(&Form::Bits(1)) {
            return last_time_of_bits(unpacked)
                .filter(|last| *last < self.times as u64)
                .map(drop);
        }
        look_through(unpacked, *forms.get(pair[0])?, self.times, changed)
    }
}

/// Returns the time of the last change of a chain of single bits, all of which are digits; `None` if it cannot be read.
fn last_time_of_bits(chain: &[u8]) -> Option<u64> {
    const SOME: usize = 32;
    // A change of one byte, below 0x80, has its digit in the lower bits: two, or four if it is neither 0 nor 1.
    let step = |byte: &u8| if byte & 1 == 0 { byte >> 2 } else { byte >> 4 };
    let (mut at, mut time) = (0, 0u64);
    while at < chain.len() {
        while let Some(some) = chain.get(at..at + SOME)
            && some.iter().fold(0, |all, byte| all | byte) < 0x80
        {
            let steps = some.iter().map(|byte| u16::from(step(byte))).sum::<u16>();
            time = time.checked_add(u64::from(steps))?;
            at += SOME;
        }
        let until = chain.len().min(at + SOME);
        while at < until {
            let head = varint(chain, &mut at)?;
            time = time.checked_add(head >> (2 << (head & 1)))?;
        }
    }
    (!chain.is_empty()).then_some(time)
}

/// Looks through a chain, and sets the bit of each time at which it has a change; `None` if it cannot be read.
fn look_through(chain: &[u8], form: Form, times: usize, changed: &mut [u64]) -> Option<()> {
    let mut rest = chain;
    let mut time = 0u64;
    loop {
        let Change { step, value, length } = change(rest, form)?;
        time = time.checked_add(step)?;
        if time >= times as u64 {
            return None;
        }
        if let Some(word) = changed.get_mut(time as usize / 64) {
            *word |= 1 << (time % 64);
        }
        if let Written::Digits(digits) = value
            && !digits.iter().all(|byte| digit(*byte).is_some())
        {
            return None;
        }
        rest = &rest[length..];
        if rest.is_empty() {
            return Some(());
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn prop_last_time_of_single_bits_matches_reading_each_change(
            chain in prop::collection::vec(prop_oneof![30 => 0u8..0x80, 1 => any::<u8>()], 0..300),
            times in 0u64..4000,
        ) {
            let by_change = look_through(&chain, Form::Bits(1), times as usize, &mut []);
            let last = last_time_of_bits(&chain).filter(|last| *last < times);
            prop_assert_eq!(last.is_some(), by_change.is_some());
        }
    }
}
