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

mod chains;
mod layout;
mod lengths;
mod packing;

use std::io::{self, Read, Seek, SeekFrom};

use self::chains::Chains;
use self::layout::{Layout, forms};
pub(super) use self::lengths::problem;
use self::packing::varint;
use super::batch::NOWHERE;
use super::digits::pack;
use super::fst_file::Bytes;
use super::gatherer::Gatherer;
use super::header::Kind;
use super::values::pack_text;

/// Kinds of blocks.
const CHANGES: u8 = 1;
const CHANGES_ALIAS: u8 = 5;
const CHANGES_ALIAS_2: u8 = 8;
const GEOMETRY: u8 = 3;

/// Value in the header that shows the byte order of real numbers.
const EULER: f64 = std::f64::consts::E;
/// Its position in the header.
const EULER_AT: u64 = 25;
/// Digits of a signal of one bit other than 0 and 1: `xzhuwl-?`.
const DIGITS: &[u8; 8] = b"xzhuwl-?";

/// A block that holds changes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) kind: u8,
    /// Byte after its kind, and its length from there on.
    pub(super) at: u64,
    pub(super) length: u64,
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
    file: Bytes,
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
    pub(super) fn find(mut file: Bytes, slots: &[Option<u32>], kinds: &[Kind]) -> io::Result<Option<Self>> {
        let length = file.length();
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
        let layout = Layout::read(&mut self.file, block)?;
        Ok(layout.is_some_and(|layout| layout.packing != b'F'))
    }

    /// Reads all blocks. `hand_over` takes full batches, and returns whether to continue.
    pub(super) fn read(
        &mut self,
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<(), Stop> {
        for (number, block) in self.blocks.clone().into_iter().enumerate() {
            gatherer.batch.bytes = block.at + block.length;
            self.block(block, number == 0, slots, gatherer, hand_over)?;
        }
        Ok(())
    }

    fn block(
        &mut self,
        block: Block,
        is_first: bool,
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<(), Stop> {
        let layout = Layout::read(&mut self.file, block)?.ok_or_else(|| damaged("a block ends too early"))?;
        if layout.handles != self.forms.len() as u64 {
            return Err(damaged("a block has another number of signals than the file"));
        }
        let (times, table) = layout.times_and_table(&mut self.file)?;
        if is_first && times.first().is_none_or(|first| *first > layout.start) {
            let values = layout.values(&mut self.file)?;
            advance(gatherer, layout.start, hand_over)?;
            self.values_before(&values, slots, gatherer)?;
        }
        let wanted = |handle: usize| slots.get(handle).copied().flatten().is_some();
        let mut chains = Chains::unpack(&mut self.file, &layout, &table, &self.forms, times.len(), wanted)?;
        drop(table);
        for (time_at, time) in times.iter().enumerate() {
            if !chains.has_change(time_at) {
                continue;
            }
            advance(gatherer, *time, hand_over)?;
            while let Some(handle) = chains.next(time_at) {
                let slot = slots[handle].ok_or_else(|| damaged("a signal was never declared"))?;
                let form = self.forms[handle];
                let length = self.change(chains.rest(handle), form, slot, gatherer)?;
                chains.advance(handle, length, form, time_at)?;
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
