//! Parts of a block other than the changes themselves: what is where, the times, and where the chains begin.

use std::io::{self, Read, Seek, SeekFrom};

use super::packing::{signed_varint, unpacked, varint, word};
use super::{Block, CHANGES_ALIAS_2, Form, Stop, damaged};
use crate::reader::fst_file::Bytes;
use crate::reader::header::{MOST_SIGNALS, too_many_signals};

/// Bytes of a block of changes before the values: length, first and last time, memory.
const HEAD: usize = 32;
/// Largest number of bytes of the three numbers after it, and of the number and the letter after the values.
const NUMBERS: usize = 30;
const HANDLES: usize = 11;
/// Bytes at the end: lengths of the times.
const TAIL: u64 = 24;

/// Where the parts of a block are.
pub(super) struct Layout {
    block: Block,
    /// First time.
    pub(super) start: u64,
    /// The values before the first change: place, bytes in the file, and unpacked.
    values: (u64, u64, u64),
    /// Number of signals that have such a value.
    pub(super) values_of: u64,
    /// Number of signals.
    pub(super) handles: u64,
    /// How the chains are packed: `4` is LZ4, `F` is FastLZ, and zlib any other.
    pub(super) packing: u8,
    /// Beginning of the chains, relative to the file.
    pub(super) chains_at: u64,
    chains_from: u64,
}

impl Layout {
    /// Reads the beginning of a block; `None` if it is too short.
    pub(super) fn read(file: &mut Bytes, block: Block) -> io::Result<Option<Self>> {
        let head = bytes_at(file, block, 0, (HEAD + NUMBERS) as u64)?;
        let mut at = HEAD;
        let mut number = || varint(&head, &mut at);
        let (Some(start), Some(unpacked), Some(packed), Some(values_of)) =
            (word(&head, 8), number(), number(), number())
        else {
            return Ok(None);
        };
        let Some(behind) = (at as u64).checked_add(packed).filter(|behind| *behind < block.length) else {
            return Ok(None);
        };
        let head = bytes_at(file, block, behind, HANDLES as u64)?;
        let mut by = 0;
        let (Some(handles), Some(packing)) = (varint(&head, &mut by), head.get(by)) else {
            return Ok(None);
        };
        Ok(Some(Self {
            block,
            start,
            values: (at as u64, packed, unpacked),
            values_of,
            handles,
            packing: *packing,
            chains_at: block.at + behind + by as u64,
            chains_from: behind + by as u64,
        }))
    }

    /// Reads the values before the first change.
    pub(super) fn values(&self, file: &mut Bytes) -> Result<Vec<u8>, Stop> {
        let (at, packed, length) = self.values;
        unpacked(&bytes_at(file, self.block, at, packed)?, length, true)
    }

    /// Reads the times, and where the chains are.
    pub(super) fn times_and_table(&self, file: &mut Bytes) -> Result<(Vec<u64>, Table), Stop> {
        let (tail, times_at) = self.tail(file)?;
        let times = times(
            &bytes_at(file, self.block, times_at, tail.packed)?,
            tail.length,
            tail.count,
        )?;
        Ok((times, self.table(file, times_at)?.0))
    }

    /// Reads where the chains are, and the times as they are packed.
    pub(super) fn parts(&self, file: &mut Bytes) -> Result<Parts, Stop> {
        let (tail, times_at) = self.tail(file)?;
        let (table, chains) = self.table(file, times_at)?;
        Ok(Parts {
            table,
            chains,
            packed_times: bytes_at(file, self.block, times_at, tail.packed)?,
            times: (tail.length, tail.count),
        })
    }

    /// Reads this many bytes of chains.
    pub(super) fn chains(&self, file: &mut Bytes, length: u64) -> io::Result<Vec<u8>> {
        bytes_at(file, self.block, self.chains_from, length)
    }

    /// Returns the lengths of the times, and their place.
    fn tail(&self, file: &mut Bytes) -> Result<(Tail, u64), Stop> {
        let at = self.block.length.checked_sub(TAIL).ok_or_else(short)?;
        let bytes = bytes_at(file, self.block, at, TAIL)?;
        let [length, packed, count] = [0, 8, 16].map(|by| word(&bytes, by).unwrap_or(0));
        let times_at = at.checked_sub(packed).ok_or_else(short)?;
        Ok((Tail { length, packed, count }, times_at))
    }

    /// Returns where the chains are, and the number of their bytes; its own length is before the times.
    fn table(&self, file: &mut Bytes, times_at: u64) -> Result<(Table, u64), Stop> {
        let end = times_at.checked_sub(8).ok_or_else(short)?;
        let length = word(&bytes_at(file, self.block, end, 8)?, 0).ok_or_else(short)?;
        let at = end.checked_sub(length).ok_or_else(short)?;
        let chains = at.checked_sub(self.chains_from).ok_or_else(short)? as usize;
        let bytes = bytes_at(file, self.block, at, length)?;
        let handles = usize::try_from(self.handles).map_err(|_| short())?;
        let table = match self.block.kind {
            CHANGES_ALIAS_2 => table_2(&bytes, handles, chains),
            _ => table_1(&bytes, handles, chains),
        };
        let table = table.ok_or_else(|| damaged("the table of the changes is damaged"))?;
        Ok((table, chains as u64))
    }
}

/// Parts of a block by which it is compared with another.
pub(super) struct Parts {
    pub(super) table: Table,
    /// Number of bytes of all chains.
    pub(super) chains: u64,
    pub(super) packed_times: Vec<u8>,
    /// Bytes of the times, unpacked, and their number.
    pub(super) times: (u64, u64),
}

impl Parts {
    /// Returns the times, if they can be read.
    pub(super) fn times(&self) -> Option<Vec<u64>> {
        times(&self.packed_times, self.times.0, self.times.1).ok()
    }
}

/// Numbers at the end of a block: bytes of the times, unpacked and packed, and the number of times.
struct Tail {
    length: u64,
    packed: u64,
    count: u64,
}

fn short() -> Stop {
    damaged("a block ends too early")
}

/// Returns up to `length` bytes of a block, fewer where it ends.
pub(super) fn bytes_at(file: &mut Bytes, block: Block, at: u64, length: u64) -> io::Result<Vec<u8>> {
    let length = length.min(block.length.saturating_sub(at));
    let mut bytes = vec![0; usize::try_from(length).map_err(io::Error::other)?];
    file.seek(SeekFrom::Start(block.at + at))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Returns how the changes of each handle are written.
pub(in crate::reader) fn forms(file: &mut Bytes, block: Block) -> Result<Vec<Form>, Stop> {
    let wrong = || damaged("the widths of the signals cannot be read");
    let bytes = bytes_at(file, block, 0, block.length)?;
    let (Some(length), Some(count), Some(packed)) = (word(&bytes, 8), word(&bytes, 16), bytes.get(24..)) else {
        return Err(wrong());
    };
    if count > MOST_SIGNALS {
        return Err(Stop::Unknown(too_many_signals()));
    }
    let bytes = unpacked(packed, length, true)?;
    let mut forms = Vec::new();
    let mut at = 0;
    while (forms.len() as u64) < count {
        let number = varint(&bytes, &mut at).ok_or_else(wrong)?;
        forms.push(match number {
            0 => Form::Real,
            0xffff_ffff => Form::Text,
            bits => Form::Bits(u32::try_from(bits).map_err(|_| wrong())?),
        });
    }
    Ok(forms)
}

/// Returns the times at which recording was switched on or off, in order, and whether it is off then.
pub(in crate::reader) fn blackouts(file: &mut Bytes, block: Block) -> Result<Vec<(u64, bool)>, Stop> {
    let wrong = || damaged("the periods without recording cannot be read");
    let bytes = bytes_at(file, block, 8, block.length)?;
    let (mut at, mut time) = (0, 0u64);
    let count = varint(&bytes, &mut at).ok_or_else(wrong)?;
    let mut blackouts = Vec::new();
    while (blackouts.len() as u64) < count {
        let is_on = *bytes.get(at).ok_or_else(wrong)? != 0;
        at += 1;
        let by = varint(&bytes, &mut at).ok_or_else(wrong)?;
        time = time.checked_add(by).ok_or_else(wrong)?;
        blackouts.push((time, !is_on));
    }
    Ok(blackouts)
}

fn times(packed: &[u8], length: u64, count: u64) -> Result<Vec<u64>, Stop> {
    let bytes = unpacked(packed, length, true)?;
    let mut times = Vec::new();
    let (mut at, mut time) = (0, 0u64);
    while (times.len() as u64) < count {
        let by = varint(&bytes, &mut at).ok_or_else(|| damaged("the times end too early"))?;
        time = time.checked_add(by).ok_or_else(|| damaged("a time is too large"))?;
        times.push(time);
    }
    Ok(times)
}

/// For each handle, the beginning and the end of its chain, counted from the beginning of the chains.
pub(super) type Table = Vec<Option<(usize, usize)>>;

/// A table under construction: a chain ends where the next one begins.
struct Making {
    table: Table,
    aliases: Vec<(usize, usize)>,
    open: Option<(usize, usize)>,
    handle: usize,
}

impl Making {
    fn new(handles: usize) -> Self {
        Self {
            table: vec![None; handles],
            aliases: Vec::new(),
            open: None,
            handle: 0,
        }
    }

    fn begin(&mut self, by: i64) -> Option<()> {
        let before = self.open.map_or(0, |(_, from)| from as i64);
        let from = usize::try_from(before.checked_add(by)?).ok()?;
        self.end(from)?;
        self.open = Some((self.handle, from));
        self.skip(1)
    }

    fn end(&mut self, to: usize) -> Option<()> {
        if let Some((handle, from)) = self.open {
            *self.table.get_mut(handle)? = Some((from, to)).filter(|_| from < to);
        }
        Some(())
    }

    fn alias(&mut self, of: usize) -> Option<()> {
        self.aliases.push((self.handle, of));
        self.skip(1)
    }

    fn skip(&mut self, count: usize) -> Option<()> {
        self.handle = self
            .handle
            .checked_add(count)
            .filter(|handle| *handle <= self.table.len())?;
        Some(())
    }

    fn finish(mut self, chains: usize) -> Option<Table> {
        self.end(chains)?;
        if self.table.iter().flatten().any(|(_, to)| *to > chains) {
            return None;
        }
        for (handle, of) in self.aliases {
            self.table[handle] = *self.table.get(of)?;
        }
        Some(self.table)
    }
}

fn table_1(bytes: &[u8], handles: usize, chains: usize) -> Option<Table> {
    let mut making = Making::new(handles);
    let mut at = 0;
    while at < bytes.len() {
        let number = varint(bytes, &mut at)?;
        match number {
            0 => {
                let of = varint(bytes, &mut at)?.checked_sub(1)?;
                making.alias(usize::try_from(of).ok()?)?;
            }
            _ if number & 1 == 1 => making.begin(i64::try_from(number >> 1).ok()?)?,
            _ => making.skip(usize::try_from(number >> 1).ok()?)?,
        }
    }
    making.finish(chains)
}

fn table_2(bytes: &[u8], handles: usize, chains: usize) -> Option<Table> {
    let mut making = Making::new(handles);
    let (mut at, mut alias) = (0, 0);
    while at < bytes.len() {
        if bytes[at] & 1 == 0 {
            let count = varint(bytes, &mut at)? >> 1;
            making.skip(usize::try_from(count).ok()?)?;
            continue;
        }
        let number = signed_varint(bytes, &mut at)? >> 1;
        match number {
            1.. => making.begin(number)?,
            0 => making.alias(alias)?,
            _ => {
                alias = usize::try_from(-number - 1).ok()?;
                making.alias(alias)?;
            }
        }
    }
    making.finish(chains)
}
