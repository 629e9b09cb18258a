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
//! All chains are unpacked, and their changes are put in the order of time, window by window ([`chains`]).

mod chains;
mod edges;
mod fastlz;
pub(super) mod hierarchy;
mod layout;
mod packing;
mod same;
mod values;
mod written;

use std::collections::{HashSet, VecDeque};
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;

use self::chains::{Chains, Due};
use self::edges::Edges;
use self::layout::{Layout, Table};
pub(super) use self::layout::{blackouts, forms};
pub(super) use self::same::same;
use self::values::put_digits;
use self::written::change;
use super::batch::NOWHERE;
use super::digits::UNKNOWN;
use super::fst_file::Bytes;
use super::gatherer::Gatherer;

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

/// Returns the number of bits of a port; `None` if there can be no port of this length. A value of a port consists of the states of its
/// bits and, each after a space, as many strengths of zero and of one.
pub(super) fn port_bits(length: u32) -> Option<u32> {
    let bits = length.checked_sub(2)?;
    (bits > 0 && bits.is_multiple_of(3)).then_some(bits / 3)
}

impl Form {
    /// Returns the number of bytes of a value before the first change.
    fn bytes_before(self) -> usize {
        match self {
            Self::Bits(width) => width as usize,
            Self::Real => 8,
            Self::Text => 0,
        }
    }
}

/// The blocks of a file that this module can read.
pub(super) struct Blocks {
    file: Bytes,
    blocks: Vec<Block>,
    /// Indexed by handle.
    forms: Arc<[Form]>,
    /// Times at which recording is switched, and whether it is off then.
    blackouts: VecDeque<(u64, bool)>,
    little_endian: bool,
    /// For each block, a bit for each time at which a signal changes that is not read here ([`same`]); or empty.
    more_times: Vec<Vec<u64>>,
    /// The signals that change at these times.
    left_out: HashSet<usize>,
    /// The watched clock, if only its edges are wanted, and its digit after the blocks that were read.
    clock: Option<(usize, u8)>,
    /// Whether it has changed in these.
    clock_began: bool,
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
            forms: forms.into(),
            blackouts: blackouts.into(),
            little_endian: true,
            more_times: Vec::new(),
            left_out: HashSet::new(),
            clock: None,
            clock_began: false,
        };
        let mut euler = [0; 8];
        found.file.seek(SeekFrom::Start(EULER_AT))?;
        found.file.read_exact(&mut euler)?;
        found.little_endian = f64::from_le_bytes(euler) == EULER;
        if !found.little_endian && f64::from_be_bytes(euler) != EULER && found.forms.contains(&Form::Real) {
            return Err(Stop::Unknown("its real numbers have an unknown format".to_owned()));
        }
        Ok(found)
    }

    /// Makes a step also at each time whose bit is set, block by block; the signals that change there are left out.
    pub(super) fn stop_at(&mut self, more_times: Vec<Vec<u64>>, left_out: HashSet<usize>) {
        (self.more_times, self.left_out) = (more_times, left_out);
    }

    /// Takes only the edges of the watched clock, which has this handle, if it is a single bit; each time is later than the one
    /// before.
    pub(super) fn take_only_edges(&mut self, clock: usize) {
        let is_bit = self.forms.get(clock) == Some(&Form::Bits(1));
        self.clock = is_bit.then_some((clock, UNKNOWN));
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
            let read = self.block(block, number, slots, gatherer, hand_over);
            read.map_err(|stop| stop.in_block(block))?;
        }
        self.switch_up_to(u64::MAX, gatherer, hand_over)
    }

    fn block(
        &mut self,
        block: Block,
        number: usize,
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
        if number == 0 && times.first().is_none_or(is_before) {
            let values = layout.values(&mut self.file)?;
            self.switch_up_to(layout.start, gatherer, hand_over)?;
            advance(gatherer, layout.start, hand_over)?;
            // At the time of the first changes, the values are those that were written before any time, as parameters are in
            // a VCD; what has none is unknown anyway.
            let all = times.first() != Some(&layout.start);
            self.values_before(&values, layout.values_of, all, slots, gatherer)?;
        }
        let edges = self.edges(&layout, &table, &times, number, gatherer)?;
        let clock = self.clock.filter(|_| edges.is_some()).map(|(handle, _)| handle);
        let wanted = |handle: usize| Some(handle) != clock && slots.get(handle).copied().flatten().is_some();
        let mut chains = Chains::unpack(
            &mut self.file,
            &layout,
            &table,
            Arc::clone(&self.forms),
            times.len(),
            wanted,
        )?;
        drop(table);
        // The file has a change from there on.
        let first_of_clock = edges.as_ref().and_then(|edges| edges.first);
        let first_of_clock = first_of_clock.filter(|_| !std::mem::replace(&mut self.clock_began, true));
        let kinds = gatherer.kinds_shared();
        let slot = |handle: usize| {
            let slot = slots.get(handle).copied().flatten()?;
            Some((slot, kinds[slot as usize]))
        };
        loop {
            let window = chains.next_window(slot, |time_at, bytes, due| {
                self.switch_up_to(times[time_at], gatherer, hand_over)?;
                advance(gatherer, times[time_at], hand_over)?;
                self.put_due(due, bytes, slots, gatherer)
            })?;
            let Some(window) = window else { return Ok(()) };
            for (at, time_at) in window.enumerate() {
                let due = chains.due(at);
                let more = self.more_times.get(number).and_then(|bits| bits.get(time_at / 64));
                let is_more = more.is_some_and(|bits| bits >> (time_at % 64) & 1 == 1);
                let is_edge = edges.as_ref().is_some_and(|edges| edges.is_edge(time_at));
                let is_first = first_of_clock == Some(time_at);
                if due.is_empty() && !is_more && !is_edge && !is_first {
                    continue;
                }
                let time = times[time_at];
                self.switch_up_to(time, gatherer, hand_over)?;
                advance(gatherer, time, hand_over)?;
                if is_more || is_edge || is_first {
                    gatherer.keep_step();
                }
                if edges.is_some() {
                    gatherer.set_edge(is_edge);
                }
                if !due.is_empty() {
                    self.put_due(due, chains.bytes(), slots, gatherer)?;
                }
            }
        }
    }

    /// Returns the edges of the watched clock in a block, if only its edges are wanted. The values before the first block must have been
    /// taken.
    fn edges(
        &mut self,
        layout: &Layout,
        table: &Table,
        times: &[u64],
        number: usize,
        gatherer: &Gatherer,
    ) -> Result<Option<Edges>, Stop> {
        let (Some((handle, last)), Some(watch)) = (self.clock, gatherer.watch()) else {
            return Ok(None);
        };
        let before = match number {
            // What happens at the time of the first values belongs to their step.
            0 if times.first() == Some(&gatherer.time()) => gatherer.clock(),
            0 => [gatherer.clock()[1]; 2],
            _ => [last; 2],
        };
        let edges = Edges::read(&mut self.file, layout, table, handle, times.len(), watch, before)?;
        self.clock = Some((handle, edges.last));
        Ok(Some(edges))
    }

    /// Takes the changes of a time.
    #[inline]
    fn put_due(
        &self,
        mut due: &[Due],
        bytes: &[u8],
        slots: &[Option<u32>],
        gatherer: &mut Gatherer,
    ) -> Result<(), Stop> {
        loop {
            let simple = due.iter().position(Due::is_other).unwrap_or(due.len());
            gatherer.put_changes(due[..simple].iter().map(|due| (due.change, due.word)));
            let Some((other, rest)) = due[simple..].split_first() else {
                return Ok(());
            };
            due = rest;
            let (handle, place) = other.place();
            let slot = slots.get(handle).copied().flatten();
            let slot = slot.ok_or_else(|| damaged("a signal was never declared"))?;
            let form = self.forms[handle];
            let found = bytes.get(place..).and_then(|chain| change(chain, form));
            let found = found.ok_or_else(|| damaged("the changes of a signal end too early"))?;
            self.put(found.value, form, slot, gatherer)?;
        }
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
            let length = form.bytes_before();
            let value = values
                .get(at..at + length)
                .ok_or_else(|| damaged("the first values end too early"))?;
            at += length;
            let is_told = match form {
                Form::Bits(_) => all || !value.iter().all(|digit| matches!(digit, b'x' | b'X')),
                // Writers have no other number for one that has had no value yet.
                Form::Real => !self.real(value).is_nan(),
                Form::Text => false,
            };
            if !is_told {
                continue;
            }
            match (slots.get(handle).copied().flatten(), form) {
                (None, _) if !self.more_times.is_empty() && self.left_out.contains(&handle) => gatherer.keep_step(),
                (None, _) | (_, Form::Text) => {}
                (Some(slot), Form::Bits(width)) => put_digits(gatherer, slot, *width, value)?,
                (Some(slot), Form::Real) => self.put_real(gatherer, slot, value),
            }
        }
        Ok(())
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
