//! Reads the value changes of an FST, block by block, directly into words.
//!
//! The crate `fst-reader` returns every value as text, which for a word costs more than everything else. It still reads
//! the hierarchy, and the files that this module does not read: those that are packed as a whole, cut off, or packed by
//! FastLZ.
//!
//! ```text
//!  block   kind │ length, first time, last time, memory │ values before │ handles, packing, a chain of changes per signal …
//!               │ … where each chain begins │ the times, as differences
//! ```
//!
//! A chain has the changes of one signal in the block; each begins with the number of times since the previous change.
//! All chains are unpacked, and each waits in the list of the time of its next change.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use flate2::{Decompress, FlushDecompress};

use super::batch::{Gatherer, NOWHERE};
use super::digits::pack;
use super::header::Kind;
use super::values::pack_text;

/// Kinds of blocks.
const CHANGES: u8 = 1;
const CHANGES_ALIAS: u8 = 5;
const CHANGES_ALIAS_2: u8 = 8;
const GEOMETRY: u8 = 3;

/// Bytes of a block of changes before the values: length, first and last time, memory.
const HEAD: usize = 32;
/// Value in the header that shows the byte order of real numbers.
const EULER: f64 = std::f64::consts::E;
/// Its position in the header.
const EULER_AT: u64 = 25;
/// Digits of a signal of one bit other than 0 and 1: `xzhuwl-?`.
const DIGITS: &[u8; 8] = b"xzhuwl-?";

/// A block that holds changes.
#[derive(Debug, Clone, Copy)]
struct Block {
    kind: u8,
    /// Byte after its kind, and its length from there on.
    at: u64,
    length: u64,
}

/// How a signal's changes are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Bits(u32),
    Real,
    Text,
}

/// The blocks of a file that this module can read.
pub(super) struct Blocks {
    file: File,
    blocks: Vec<Block>,
    /// Indexed by handle.
    forms: Vec<Form>,
    little_endian: bool,
}

/// Why the blocks could not be read.
pub(super) enum Stop {
    /// The receiver is gone.
    Unheard,
    Damaged(String),
    Io(io::Error),
}

impl From<io::Error> for Stop {
    fn from(cause: io::Error) -> Self {
        Self::Io(cause)
    }
}

fn damaged(what: &str) -> Stop {
    Stop::Damaged(what.to_owned())
}

impl Blocks {
    /// Finds the blocks of a file that contains all of them completely; `None` if only `fst-reader` can read it.
    /// `slots` and `kinds` are those of the declarations.
    pub(super) fn find(mut file: File, slots: &[Option<u32>], kinds: &[Kind]) -> io::Result<Option<Self>> {
        let length = file.metadata()?.len();
        let mut blocks = Vec::new();
        let mut geometry = None;
        let mut at = 0;
        while at < length {
            let mut head = [0; 9];
            file.seek(SeekFrom::Start(at))?;
            file.read_exact(&mut head)?;
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&head[1..]);
            let block = Block {
                kind: head[0],
                at: at + 1,
                length: u64::from_be_bytes(bytes),
            };
            match block.kind {
                CHANGES | CHANGES_ALIAS | CHANGES_ALIAS_2 => blocks.push(block),
                GEOMETRY => geometry = Some(block),
                0 | 2 | 4 | 6 | 7 | 255 => {}
                _ => return Ok(None),
            }
            at = match at.checked_add(1).and_then(|at| at.checked_add(block.length)) {
                Some(next) if block.length >= 8 && next <= length => next,
                _ => return Ok(None),
            };
        }
        let mut euler = [0; 8];
        file.seek(SeekFrom::Start(EULER_AT))?;
        file.read_exact(&mut euler)?;
        let little_endian = f64::from_le_bytes(euler) == EULER;
        let Some(geometry) = geometry else { return Ok(None) };
        let Some(forms) = forms(&mut file, geometry)? else {
            return Ok(None);
        };
        let fits = |(at, form): (usize, &Form)| match slots.get(at).copied().flatten() {
            None => true,
            Some(slot) => match (kinds[slot as usize], form) {
                (Kind::Bits(width), Form::Bits(bits)) => width == *bits,
                (Kind::Real, form) => *form == Form::Real,
                (Kind::Text, form) => *form == Form::Text,
                (Kind::Event, _) => true,
                (Kind::Bits(_), _) => false,
            },
        };
        let understood = forms.iter().enumerate().all(fits) && slots.len() <= forms.len();
        if !understood || (!little_endian && f64::from_be_bytes(euler) != EULER) {
            return Ok(None);
        }
        let mut found = Self {
            file,
            blocks,
            forms,
            little_endian,
        };
        for block in found.blocks.clone() {
            if !found.is_packed_as_usual(block)? {
                return Ok(None);
            }
        }
        Ok(Some(found))
    }

    /// Whether the chains are packed by zlib or LZ4.
    fn is_packed_as_usual(&mut self, block: Block) -> io::Result<bool> {
        let mut head = [0; HEAD + 30];
        let room = head.len().min(usize::try_from(block.length).unwrap_or(usize::MAX));
        self.file.seek(SeekFrom::Start(block.at))?;
        self.file.read_exact(&mut head[..room])?;
        let mut at = HEAD;
        let mut numbers = [0; 3];
        for number in &mut numbers {
            match varint(&head[..room], &mut at) {
                Some(found) => *number = found,
                None => return Ok(false),
            }
        }
        let mut tail = [0; 11];
        let behind_values = (at as u64).checked_add(numbers[1]);
        let Some(from) = behind_values.filter(|from| from.saturating_add(11) < block.length) else {
            return Ok(false);
        };
        self.file.seek(SeekFrom::Start(block.at + from))?;
        self.file.read_exact(&mut tail)?;
        let mut at = 0;
        let packing = varint(&tail, &mut at).and_then(|_| tail.get(at));
        Ok(packing.is_some_and(|packing| *packing != b'F'))
    }

    /// Reads all blocks. `hand_over` takes full batches, and returns whether to continue.
    pub(super) fn read(
        &mut self,
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<(), Stop> {
        let mut bytes = Vec::new();
        for (number, block) in self.blocks.clone().into_iter().enumerate() {
            let length = usize::try_from(block.length).map_err(|_| damaged("a block is too long"))?;
            bytes.clear();
            bytes.resize(length, 0);
            self.file.seek(SeekFrom::Start(block.at))?;
            self.file.read_exact(&mut bytes)?;
            gatherer.batch.bytes = block.at + block.length;
            self.block(&bytes, block.kind, number == 0, slots, gatherer, hand_over)?;
        }
        Ok(())
    }

    fn block(
        &self,
        bytes: &[u8],
        kind: u8,
        is_first: bool,
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<(), Stop> {
        let short = || damaged("a block ends too early");
        let start = word(bytes, 8).ok_or_else(short)?;
        let mut at = HEAD;
        let mut number = || varint(bytes, &mut at).ok_or_else(short);
        let (values_length, values_packed, _) = (number()?, number()?, number()?);
        let values = bytes
            .get(at..)
            .and_then(|rest| rest.get(..values_packed as usize))
            .ok_or_else(short)?;
        at += values_packed as usize;
        let handles = varint(bytes, &mut at).ok_or_else(short)?;
        if handles != self.forms.len() as u64 {
            return Err(damaged("a block has another number of signals than the file"));
        }
        let chains_at = at;
        let packing = *bytes.get(at).ok_or_else(short)?;
        // The times and the beginnings of the chains are at the end of the block.
        let tail = bytes.len().checked_sub(24).ok_or_else(short)?;
        let [times_length, times_packed, times_count] = [0, 8, 16].map(|by| word(bytes, tail + by).unwrap_or(0));
        let times_at = (tail as u64).checked_sub(times_packed).ok_or_else(short)? as usize;
        let table_end = times_at.checked_sub(8).ok_or_else(short)?;
        let table_length = word(bytes, table_end).ok_or_else(short)?;
        let table_at = (table_end as u64).checked_sub(table_length).ok_or_else(short)? as usize;
        let chains = bytes.get(chains_at..table_at).ok_or_else(short)?;
        let times = times(&bytes[times_at..tail], times_length, times_count)?;
        let table = match kind {
            CHANGES_ALIAS_2 => table_2(&bytes[table_at..table_end], self.forms.len(), chains.len()),
            _ => table_1(&bytes[table_at..table_end], self.forms.len(), chains.len()),
        };
        let table = table.ok_or_else(|| damaged("where the changes begin is not told"))?;

        if is_first && times.first().is_none_or(|first| *first > start) {
            let values = unpacked(values, values_length, true)?;
            advance(gatherer, start, hand_over)?;
            self.values_before(&values, slots, gatherer)?;
        }
        let mut unpacked_chains: Vec<u8> = Vec::new();
        // For each handle: its next change, the end of its chain, and the next handle in the same list, plus one.
        let mut cursors = vec![Cursor::default(); self.forms.len()];
        let mut known: HashMap<usize, [u32; 2]> = HashMap::new();
        let mut waiting = vec![0u32; times.len()];
        for (handle, place) in table.iter().enumerate() {
            let Some((from, to)) = *place else { continue };
            if slots.get(handle).copied().flatten().is_none() {
                continue;
            }
            // Aliases share a chain.
            let [begin, end] = match known.get(&from) {
                Some(range) => *range,
                None => {
                    let begin = unpacked_chains.len() as u32;
                    let chain = chains.get(from..to).ok_or_else(short)?;
                    unpack_chain(chain, packing, &mut unpacked_chains)?;
                    let range = [begin, unpacked_chains.len() as u32];
                    known.insert(from, range);
                    range
                }
            };
            cursors[handle] = Cursor {
                at: begin,
                end,
                next: 0,
            };
            enqueue(
                &unpacked_chains,
                self.forms[handle],
                handle,
                0,
                &mut cursors,
                &mut waiting,
            )?;
        }
        for (time_at, time) in times.iter().enumerate() {
            if waiting[time_at] == 0 {
                continue;
            }
            advance(gatherer, *time, hand_over)?;
            while let Some(handle) = waiting[time_at].checked_sub(1) {
                let handle = handle as usize;
                waiting[time_at] = cursors[handle].next;
                let cursor = &mut cursors[handle];
                let chain = &unpacked_chains[cursor.at as usize..cursor.end as usize];
                let slot = slots[handle].ok_or_else(short)?;
                let length = self.change(chain, self.forms[handle], slot, gatherer)?;
                cursor.at += length as u32;
                if cursor.at < cursor.end {
                    enqueue(
                        &unpacked_chains,
                        self.forms[handle],
                        handle,
                        time_at,
                        &mut cursors,
                        &mut waiting,
                    )?;
                }
            }
        }
        Ok(())
    }

    /// Reads the values before the first change, as text.
    fn values_before(&self, values: &[u8], slots: &[Option<u32>], gatherer: &mut Gatherer) -> Result<(), Stop> {
        let mut at = 0;
        for (handle, form) in self.forms.iter().enumerate() {
            let length = match form {
                Form::Bits(width) => *width as usize,
                Form::Real => 8,
                Form::Text => 0,
            };
            let value = values
                .get(at..at + length)
                .ok_or_else(|| damaged("the first values end too early"))?;
            at += length;
            let Some(slot) = slots.get(handle).copied().flatten() else {
                continue;
            };
            match form {
                Form::Bits(width) => put_digits(gatherer, slot, *width, value)?,
                Form::Real => self.put_real(gatherer, slot, value),
                Form::Text => {}
            }
        }
        Ok(())
    }

    /// Takes the change at the beginning of a chain; returns its bytes.
    #[inline]
    fn change(&self, chain: &[u8], form: Form, slot: u32, gatherer: &mut Gatherer) -> Result<usize, Stop> {
        let short = || damaged("the changes of a signal end too early");
        let mut at = 0;
        let head = varint(chain, &mut at).ok_or_else(short)?;
        match form {
            Form::Bits(1) => {
                let digit = match head & 1 {
                    0 => b'0' + (head >> 1 & 1) as u8,
                    _ => DIGITS[(head >> 1 & 7) as usize],
                };
                if gatherer.kind(slot) == Kind::Bits(1) {
                    let digit = super::digits::digit(digit).ok_or_else(|| damaged("a bit is not a digit"))?;
                    gatherer.put_digit(slot, digit);
                }
            }
            Form::Bits(width) if head & 1 == 0 => {
                let length = width.div_ceil(8) as usize;
                let value = chain.get(at..at + length).ok_or_else(short)?;
                at += length;
                if gatherer.kind(slot) != Kind::Bits(width) {
                    // It is an event, which has no value.
                } else if width <= 64 {
                    let word = value.iter().fold(0u64, |word, byte| word << 8 | u64::from(*byte));
                    gatherer.put_word(slot, word >> (8 * length as u32 - width), 0);
                } else {
                    let bit = |at: usize| b'0' + (value[at / 8] >> (7 - at % 8) & 1);
                    let digits: Vec<u8> = (0..width as usize).map(bit).collect();
                    put_digits(gatherer, slot, width, &digits)?;
                }
            }
            Form::Bits(width) => {
                let value = chain.get(at..at + width as usize).ok_or_else(short)?;
                at += width as usize;
                put_digits(gatherer, slot, width, value)?;
            }
            Form::Real => {
                let value = chain.get(at..at + 8).ok_or_else(short)?;
                if head & 1 == 0 {
                    return Err(damaged("a real number is written as bits"));
                }
                at += 8;
                self.put_real(gatherer, slot, value);
            }
            Form::Text => {
                let length = varint(chain, &mut at).ok_or_else(short)? as usize;
                let value = chain.get(at..).and_then(|rest| rest.get(..length)).ok_or_else(short)?;
                at += length;
                if gatherer.kind(slot) == Kind::Text {
                    pack_text(value, gatherer.put_words(slot));
                }
            }
        }
        Ok(at)
    }

    fn put_real(&self, gatherer: &mut Gatherer, slot: u32, value: &[u8]) {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(value);
        let bits = match self.little_endian {
            true => u64::from_le_bytes(bytes),
            false => u64::from_be_bytes(bytes),
        };
        if gatherer.kind(slot) == Kind::Real {
            gatherer.put_word(slot, bits, 0);
        }
    }
}

/// A signal in a block.
#[derive(Debug, Clone, Copy, Default)]
struct Cursor {
    at: u32,
    end: u32,
    next: u32,
}

/// Puts a handle into the list of the time of its next change, which is stored relative to `time_at`.
#[inline]
fn enqueue(
    chains: &[u8],
    form: Form,
    handle: usize,
    time_at: usize,
    cursors: &mut [Cursor],
    waiting: &mut [u32],
) -> Result<(), Stop> {
    let cursor = &mut cursors[handle];
    let mut at = 0;
    let head = varint(&chains[cursor.at as usize..cursor.end as usize], &mut at);
    let head = head.ok_or_else(|| damaged("the changes of a signal end too early"))?;
    let by = match form {
        Form::Bits(1) => head >> (2 << (head & 1)),
        _ => head >> 1,
    };
    let list = usize::try_from(by)
        .ok()
        .and_then(|by| waiting.get_mut(time_at.checked_add(by)?));
    let list = list.ok_or_else(|| damaged("a change is later than the last time"))?;
    cursor.next = std::mem::replace(list, handle as u32 + 1);
    Ok(())
}

fn advance(gatherer: &mut Gatherer, time: u64, hand_over: &mut dyn FnMut(&mut Gatherer) -> bool) -> Result<(), Stop> {
    if time < gatherer.time() {
        return Err(Stop::Damaged(format!("time goes back to {time}")));
    }
    let bytes = gatherer.batch.bytes;
    if gatherer.advance(time, NOWHERE) {
        if !hand_over(gatherer) {
            return Err(Stop::Unheard);
        }
        gatherer.batch.bytes = bytes;
    }
    Ok(())
}

fn put_digits(gatherer: &mut Gatherer, slot: u32, width: u32, digits: &[u8]) -> Result<(), Stop> {
    if gatherer.kind(slot) != Kind::Bits(width) {
        return Ok(());
    }
    let words = gatherer.put_words(slot);
    let (bits, unknown) = words.split_at_mut(words.len() / 2);
    pack(digits, width, bits, unknown).map_err(|byte| Stop::Damaged(format!("byte {byte} is not a digit")))?;
    gatherer.watch_last(slot);
    Ok(())
}

/// Returns how the changes of each handle are written.
fn forms(file: &mut File, block: Block) -> io::Result<Option<Vec<Form>>> {
    let Some(packed) = block
        .length
        .checked_sub(24)
        .and_then(|length| usize::try_from(length).ok())
    else {
        return Ok(None);
    };
    let mut head = [0; 24];
    file.seek(SeekFrom::Start(block.at))?;
    file.read_exact(&mut head)?;
    let mut bytes = vec![0; packed];
    file.read_exact(&mut bytes)?;
    let (Some(length), Some(count)) = (word(&head, 8), word(&head, 16)) else {
        return Ok(None);
    };
    let Ok(bytes) = unpacked(&bytes, length, true) else {
        return Ok(None);
    };
    let mut forms = Vec::new();
    let mut at = 0;
    while (forms.len() as u64) < count {
        let Some(number) = varint(&bytes, &mut at) else {
            return Ok(None);
        };
        forms.push(match number {
            0 => Form::Real,
            0xffff_ffff => Form::Text,
            bits => match u32::try_from(bits) {
                Ok(bits) => Form::Bits(bits),
                Err(_) => return Ok(None),
            },
        });
    }
    Ok(Some(forms))
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
type Table = Vec<Option<(usize, usize)>>;

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

/// Unpacks a chain and appends it.
fn unpack_chain(chain: &[u8], packing: u8, out: &mut Vec<u8>) -> Result<(), Stop> {
    let mut at = 0;
    let length = varint(chain, &mut at).ok_or_else(|| damaged("a chain of changes is empty"))?;
    if length == 0 {
        out.extend_from_slice(&chain[at..]);
    } else if packing == b'4' {
        let from = out.len();
        let to = from as u64 + length;
        if to > u64::from(u32::MAX) || length > 256 * (chain.len() as u64 + 64) {
            return Err(damaged("a chain of changes is longer than its packing can be"));
        }
        out.resize(to as usize, 0);
        let count = lz4_flex::block::decompress_into(&chain[at..], &mut out[from..]);
        if count.ok() != Some(length as usize) {
            return Err(damaged("a chain of changes cannot be unpacked"));
        }
    } else {
        // The length of a chain includes this number, but its packed bytes begin after it.
        out.extend(unpacked(&chain[at..], length, false)?);
    }
    if u32::try_from(out.len()).is_err() {
        return Err(damaged("a block unpacks to more than 4 GiB"));
    }
    Ok(())
}

/// Unpacks `length` bytes that zlib packed; where allowed, they may also be stored without packing.
fn unpacked(bytes: &[u8], length: u64, may_be_plain: bool) -> Result<Vec<u8>, Stop> {
    if may_be_plain && length == bytes.len() as u64 {
        return Ok(bytes.to_vec());
    }
    // zlib packs by a factor of 1000 at most.
    let room = usize::try_from(length)
        .ok()
        .filter(|room| *room <= 1100 * (bytes.len() + 64));
    let room = room.ok_or_else(|| damaged("something is longer than its packing can be"))?;
    let mut out = Vec::with_capacity(room);
    let unpacked = Decompress::new(true).decompress_vec(bytes, &mut out, FlushDecompress::Finish);
    match unpacked {
        Ok(_) if out.len() == room => Ok(out),
        _ => Err(damaged("something cannot be unpacked")),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u64> {
    let mut word = [0; 8];
    word.copy_from_slice(bytes.get(at..at.checked_add(8)?)?);
    Some(u64::from_be_bytes(word))
}

/// A number in seven bits a byte, the lowest first.
#[inline]
fn varint(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let first = *bytes.get(*at)?;
    *at += 1;
    let mut number = u64::from(first & 0x7f);
    let (mut byte, mut shift) = (first, 7);
    while byte & 0x80 != 0 {
        if shift > 63 {
            return None;
        }
        byte = *bytes.get(*at)?;
        *at += 1;
        number |= u64::from(byte & 0x7f) << shift;
        shift += 7;
    }
    Some(number)
}

fn signed_varint(bytes: &[u8], at: &mut usize) -> Option<i64> {
    let from = *at;
    let number = varint(bytes, at)?;
    let bits = 7 * (*at - from) as u32;
    let negative = bytes[*at - 1] & 0x40 != 0;
    let sign = if negative { u64::MAX.unbounded_shl(bits) } else { 0 };
    Some((number | sign) as i64)
}
