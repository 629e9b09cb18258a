//! Reads the value changes of an FST, block by block, directly into words.
//!
//! The crate `fst-reader` returns every value as text, which for a word costs more than everything else; it panics on some
//! damaged files, and does not report periods without recording.
//!
//! ```text
//!  block   kind │ length, first time, last time, memory │ values before │ handles, packing, a chain of changes per signal …
//!               │ … where each chain begins │ the times, as differences
//! ```
//!
//! A chain has the changes of one signal in the block; each begins with the number of times since the previous change.
//! All chains are unpacked, and each waits in the list of the time of its next change.

mod chains;
mod fastlz;
pub(super) mod hierarchy;
mod layout;
mod packing;

use std::collections::VecDeque;
use std::io::{self, Read, Seek, SeekFrom};

use self::chains::Chains;
use self::layout::Layout;
pub(super) use self::layout::{blackouts, forms};
use self::packing::varint;
use super::batch::NOWHERE;
use super::digits::{is_state, pack, state};
use super::fst_file::Bytes;
use super::gatherer::Gatherer;
use super::header::Kind;
use super::values::pack_text;

/// Kinds of blocks.
pub(super) const HEADER: u8 = 0;
const CHANGES: u8 = 1;
pub(super) const BLACKOUT: u8 = 2;
pub(super) const GEOMETRY: u8 = 3;
const CHANGES_ALIAS: u8 = 5;
const CHANGES_ALIAS_2: u8 = 8;
pub(super) const SKIPPED: u8 = 255;

/// Value in the header that shows the byte order of real numbers.
const EULER: f64 = std::f64::consts::E;
/// Its position in the header.
const EULER_AT: u64 = 25;
/// Digits of a signal of one bit other than 0 and 1: `xzhuwl-?`.
const DIGITS: &[u8; 8] = b"xzhuwl-?";

/// A block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub(super) kind: u8,
    /// Byte after its kind, and its length from there on.
    pub(super) at: u64,
    pub(super) length: u64,
}

impl Block {
    /// Whether it has changes.
    pub(super) fn is_changes(&self) -> bool {
        matches!(self.kind, CHANGES | CHANGES_ALIAS | CHANGES_ALIAS_2)
    }
}

/// How a signal's changes are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
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
    /// Times at which recording is switched, and whether it is off then.
    blackouts: VecDeque<(u64, bool)>,
    little_endian: bool,
}

/// Why the blocks could not be read.
pub(super) enum Stop {
    /// The receiver is gone.
    Unheard,
    Damaged(String),
    /// It may be in order, but it is not known, or too large.
    Unknown(String),
    Io(io::Error),
}

impl Stop {
    /// Adds where it was found.
    pub(super) fn in_block(self, block: Block) -> Self {
        let place = |what: String| format!("{what}, in the block at byte {}", block.at.saturating_sub(1));
        match self {
            Self::Damaged(what) => Self::Damaged(place(what)),
            Self::Unknown(what) => Self::Unknown(place(what)),
            other => other,
        }
    }
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
    /// `changes` are the blocks with changes, and `forms` has how those of each handle are written.
    pub(super) fn new(
        file: Bytes,
        changes: Vec<Block>,
        forms: Vec<Form>,
        blackouts: Vec<(u64, bool)>,
    ) -> Result<Self, Stop> {
        let mut found = Self {
            file,
            blocks: changes,
            forms,
            blackouts: blackouts.into(),
            little_endian: true,
        };
        let mut euler = [0; 8];
        found.file.seek(SeekFrom::Start(EULER_AT))?;
        found.file.read_exact(&mut euler)?;
        found.little_endian = f64::from_le_bytes(euler) == EULER;
        if !found.little_endian && f64::from_be_bytes(euler) != EULER && found.forms.contains(&Form::Real) {
            return Err(Stop::Unknown(
                "its real numbers are written in a way that is not known".to_owned(),
            ));
        }
        Ok(found)
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
            let read = self.block(block, number == 0, slots, gatherer, hand_over);
            read.map_err(|stop| stop.in_block(block))?;
        }
        self.switch_up_to(u64::MAX, gatherer, hand_over)
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
        if layout.handles > self.forms.len() as u64 {
            return Err(damaged("it has more signals than the file"));
        }
        let (times, table) = layout.times_and_table(&mut self.file)?;
        let is_before = |first: &u64| *first >= layout.start;
        if is_first && times.first().is_none_or(is_before) {
            let values = layout.values(&mut self.file)?;
            self.switch_up_to(layout.start, gatherer, hand_over)?;
            advance(gatherer, layout.start, hand_over)?;
            // At the time of the first changes, the values are those that were written before any time, as parameters are in
            // a VCD; what has none is unknown anyway.
            let all = times.first() != Some(&layout.start);
            self.values_before(&values, layout.values_of, all, slots, gatherer)?;
        }
        let wanted = |handle: usize| slots.get(handle).copied().flatten().is_some();
        let mut chains = Chains::unpack(&mut self.file, &layout, &table, &self.forms, times.len(), wanted)?;
        drop(table);
        for (time_at, time) in times.iter().enumerate() {
            if !chains.has_change(time_at) {
                continue;
            }
            self.switch_up_to(*time, gatherer, hand_over)?;
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

    /// Switches recording on and off as it was up to a time.
    fn switch_up_to(
        &mut self,
        time: u64,
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<(), Stop> {
        while let Some((at, is_off)) = self.blackouts.front().copied()
            && at <= time
        {
            self.blackouts.pop_front();
            advance(gatherer, at.max(gatherer.time()), hand_over)?;
            gatherer.off(is_off);
        }
        Ok(())
    }

    /// Reads the values of the first handles before the first change, as text; unless `all`, only those that are known.
    fn values_before(
        &self,
        values: &[u8],
        count: u64,
        all: bool,
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
    ) -> Result<(), Stop> {
        let mut at = 0;
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        for (handle, form) in self.forms.iter().enumerate().take(count) {
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
                Form::Bits(_) if !all && value.iter().all(|digit| matches!(digit, b'x' | b'X')) => {}
                Form::Bits(width) => put_digits(gatherer, slot, *width, value)?,
                // Writers have no other number for one that has had no value yet.
                Form::Real if self.real(value).is_nan() => {}
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
                    let value = super::digits::digit(digit).ok_or_else(|| damaged("a bit is not a digit"))?;
                    gatherer.put_digit(slot, value);
                    if head & 1 != 0 && is_state(digit) {
                        gatherer.note_state(state(&[digit]));
                    }
                } else if digit == b'1' && gatherer.kind(slot) == Kind::Event {
                    gatherer.put_event(slot);
                }
            }
            Form::Bits(width) if head & 1 == 0 => {
                let length = width.div_ceil(8) as usize;
                let value = chain.get(at..at + length).ok_or_else(short)?;
                at += length;
                if gatherer.kind(slot) == Kind::Event {
                    // It has no value.
                } else if width <= 64 && gatherer.kind(slot) == Kind::Bits(width) {
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

    fn real(&self, value: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(value);
        match self.little_endian {
            true => f64::from_le_bytes(bytes),
            false => f64::from_be_bytes(bytes),
        }
    }

    fn put_real(&self, gatherer: &mut Gatherer, slot: u32, value: &[u8]) {
        if gatherer.kind(slot) == Kind::Real {
            gatherer.put_word(slot, self.real(value).to_bits(), 0);
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
    match gatherer.kind(slot) {
        Kind::Bits(declared) if declared == width => {}
        // The states of a port, with their strengths.
        Kind::Text => {
            pack_text(digits, gatherer.put_words(slot));
            return Ok(());
        }
        _ => return Ok(()),
    }
    let words = gatherer.put_words(slot);
    let (bits, unknown) = words.split_at_mut(words.len() / 2);
    let packed = pack(digits, width, bits, unknown);
    let has_states = packed.map_err(|byte| Stop::Damaged(format!("byte {byte} is not a digit")))?;
    gatherer.watch_last(slot);
    if has_states {
        gatherer.note_state(state(digits));
    }
    Ok(())
}
