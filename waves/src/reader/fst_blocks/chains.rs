//! The chains of changes of a block, and which signals change at which time.

use std::collections::HashMap;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::layout::{Layout, Table};
use super::packing::{unpack_chain, varint};
use super::{Form, Stop, damaged};
use crate::reader::fst_file::Bytes;

/// Number of bytes that are read at once; chains are mostly short.
const READ_BYTES: usize = 1 << 16;

/// A signal in a block: its next change and the end of its chain, and the next signal in the same list, plus one.
#[derive(Debug, Clone, Copy, Default)]
struct Cursor {
    at: u32,
    end: u32,
    next: u32,
}

/// All chains of a block, unpacked.
pub(super) struct Chains {
    bytes: Vec<u8>,
    cursors: Vec<Cursor>,
    /// For each time, the first signal that changes then, plus one.
    waiting: Vec<u32>,
}

impl Chains {
    /// Unpacks the chains of the signals that are `wanted`, one after the other, so that only one is in memory packed.
    pub(super) fn unpack(
        file: &mut Bytes,
        layout: &Layout,
        table: &Table,
        forms: &[Form],
        times: usize,
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Self, Stop> {
        let mut chains = Self {
            bytes: Vec::new(),
            cursors: vec![Cursor::default(); forms.len()],
            waiting: vec![0; times],
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
            chains.cursors[handle] = Cursor { at, end, next: 0 };
            chains.enqueue(handle, forms[handle], 0)?;
        }
        Ok(chains)
    }

    /// Whether a signal changes at this time.
    #[inline]
    pub(super) fn has_change(&self, time_at: usize) -> bool {
        self.waiting[time_at] != 0
    }

    /// Takes the next signal that changes at this time.
    #[inline]
    pub(super) fn next(&mut self, time_at: usize) -> Option<usize> {
        let handle = self.waiting[time_at].checked_sub(1)? as usize;
        self.waiting[time_at] = self.cursors[handle].next;
        Some(handle)
    }

    /// Returns the chain from the next change on.
    #[inline]
    pub(super) fn rest(&self, handle: usize) -> &[u8] {
        let cursor = self.cursors[handle];
        &self.bytes[cursor.at as usize..cursor.end as usize]
    }

    /// Goes on by a change of `length` bytes, which was at the time `time_at`.
    #[inline]
    pub(super) fn advance(&mut self, handle: usize, length: usize, form: Form, time_at: usize) -> Result<(), Stop> {
        let cursor = &mut self.cursors[handle];
        cursor.at += length as u32;
        if cursor.at < cursor.end {
            self.enqueue(handle, form, time_at)?;
        }
        Ok(())
    }

    /// Puts a signal into the list of the time of its next change, which is stored relative to `time_at`.
    #[inline]
    fn enqueue(&mut self, handle: usize, form: Form, time_at: usize) -> Result<(), Stop> {
        let head = varint(self.rest(handle), &mut 0);
        let head = head.ok_or_else(|| damaged("the changes of a signal end too early"))?;
        let by = match form {
            Form::Bits(1) => head >> (2 << (head & 1)),
            _ => head >> 1,
        };
        let list = usize::try_from(by)
            .ok()
            .and_then(|by| self.waiting.get_mut(time_at.checked_add(by)?));
        let list = list.ok_or_else(|| damaged("a change is later than the last time"))?;
        self.cursors[handle].next = std::mem::replace(list, handle as u32 + 1);
        Ok(())
    }
}
