//! Finds the edges of a clock whose other changes are not needed.
//!
//! A clock that has the same changes in two FST is equal in both at every sample. It changes more often than all other signals, so
//! its chain is read by itself, into a bit for each time.

use std::io::{Read, Seek, SeekFrom};

use super::layout::{Layout, Table};
use super::packing::{unpack_chain, varint};
use super::written::digit_byte;
use super::{Stop, damaged};
use crate::reader::digits::digit;
use crate::reader::fst_file::Bytes;
use crate::reader::gatherer::Watch;

/// The edges of a clock in a block.
pub(super) struct Edges {
    /// A bit for each time.
    bits: Vec<u64>,
    /// The first time at which the clock changes.
    pub(super) first: Option<usize>,
    /// The digit after the last change.
    pub(super) last: u8,
}

impl Edges {
    /// Reads the chain of `handle`, a signal of one bit. `before` are its digits before the block's first time and before its second.
    pub(super) fn read(
        file: &mut Bytes,
        layout: &Layout,
        table: &Table,
        handle: usize,
        times: usize,
        watch: Watch,
        before: [u8; 2],
    ) -> Result<Self, Stop> {
        let mut chain = Vec::new();
        if let Some((from, to)) = table.get(handle).copied().flatten() {
            let mut packed = vec![0; to - from];
            file.seek(SeekFrom::Start(layout.chains_at + from as u64))?;
            file.read_exact(&mut packed)?;
            unpack_chain(&packed, layout.packing, &mut chain)?;
        }
        Self::from_chain(&chain, times, watch, before).ok_or_else(|| damaged("the changes of the clock cannot be read"))
    }

    /// As [`Edges::read`], from an unpacked chain; `None` if it cannot be read.
    fn from_chain(chain: &[u8], times: usize, watch: Watch, before: [u8; 2]) -> Option<Self> {
        let mut bits = vec![0u64; times.div_ceil(64)];
        let (mut at, mut time) = (0, 0u64);
        let [mut before, mut now] = before;
        let mut first = None;
        while at < chain.len() {
            let head = varint(chain, &mut at)?;
            let step = head >> (2 << (head & 1));
            time = time.checked_add(step)?;
            if time >= times as u64 {
                return None;
            }
            first = first.or(Some(time as usize));
            if step > 0 {
                before = now;
            }
            now = match head & 1 {
                0 => (head >> 1 & 1) as u8,
                _ => digit(digit_byte((head >> 1 & 7) as u8 + 2))?,
            };
            // The last digit at a time counts.
            let word = &mut bits[time as usize / 64];
            *word = *word & !(1 << (time % 64)) | u64::from(watch.is_edge(before, now)) << (time % 64);
        }
        Some(Self { bits, first, last: now })
    }

    /// Returns whether the clock has an edge at a time of the block.
    #[inline]
    pub(super) fn is_edge(&self, time: usize) -> bool {
        self.bits[time / 64] >> (time % 64) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::reader::digits::UNKNOWN;

    proptest! {
        #[test]
        fn prop_edges_compare_the_last_digit_of_each_time_with_the_one_before(
            changes in prop::collection::vec((prop_oneof![8 => Just(0u64), 8 => 1u64..4, 1 => 4u64..40_000], 0u8..10), 0..80),
            before in [0u8..4, 0u8..4],
            falling: bool,
        ) {
            let watch = Watch { slot: 0, falling };
            let times = 1 + changes.iter().map(|(step, _)| *step as usize).sum::<usize>();
            let mut chain = Vec::new();
            let mut digits: Vec<Option<u8>> = vec![None; times];
            let mut time = 0;
            for (step, digit) in &changes {
                let mut head = match digit {
                    0 | 1 => step << 2 | u64::from(digit << 1),
                    other => step << 4 | u64::from(other - 2) << 1 | 1,
                };
                while head >= 0x80 {
                    chain.push(head as u8 | 0x80);
                    head >>= 7;
                }
                chain.push(head as u8);
                time += *step as usize;
                digits[time] = crate::reader::digits::digit(digit_byte(*digit));
            }
            let edges = Edges::from_chain(&chain, times, watch, before).unwrap();
            // The first time may continue one at which the clock has changed already.
            let [mut last, mut now] = before;
            for (time, digit) in digits.iter().enumerate() {
                if time > 0 {
                    last = now;
                }
                now = digit.unwrap_or(now);
                prop_assert_eq!(edges.is_edge(time), digit.is_some() && watch.is_edge(last, now), "{}", time);
            }
            prop_assert_eq!(edges.first, digits.iter().position(Option::is_some));
            prop_assert_eq!(edges.last, now);
            // A change after the last time, or one that is cut off, is damage.
            prop_assert!(changes.is_empty() || Edges::from_chain(&chain, times - 1, watch, [UNKNOWN; 2]).is_none());
            chain.push(0x80);
            prop_assert!(Edges::from_chain(&chain, times, watch, before).is_none());
        }
    }
}
