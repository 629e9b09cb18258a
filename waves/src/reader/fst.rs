//! Reads FST, GTKWave's packed format: what is declared, and then the changes block by block ([`super::fst_blocks`]).
//!
//! Memory is bounded by the size of a block, which the writer chooses, and not by the length of the file; but a file that is
//! packed as a whole, as GHDL writes it, is unpacked in memory first ([`super::fst_file`]).
//!
//! A block of its own says how each signal's values are written, and thereby their kind: bits, a real number or text. If that block is
//! missing because the writer was stopped, the kind follows from the hierarchy.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::path::PathBuf;

use super::fst_blocks::hierarchy::{self, Entry, Signal};
use super::fst_blocks::{self, BLACKOUT, Blocks, Form, GEOMETRY, HEADER, SKIPPED, Stop, port_bits};
use super::fst_file::{self, Bytes, PACKED};
use super::gatherer::Gatherer;
use super::header::{Declarations, Kind, Selection};
use super::section::Ended;
use crate::WaveError;

/// Beginning of a file with a header block: its first byte and the length.
const BEGINNING: [u8; 9] = [0, 0, 0, 0, 0, 0, 0, 1, 0x49];
/// Length of the header.
const HEADER_BYTES: u64 = 329;
/// Position of the unit of time in the header: the exponent of ten of a second.
const TIMESCALE_AT: u64 = 73;

/// Types of variables.
const EVENT: u8 = 0;
const REALS: [u8; 4] = [3, 4, 20, 29];
/// A port of an extended VCD, with its strengths.
const PORT: u8 = 18;
const STRING: u8 = 21;

/// Returns whether the file begins like an FST.
pub(super) fn is_fst(beginning: &[u8]) -> bool {
    beginning.starts_with(&BEGINNING) || beginning.first() == Some(&PACKED)
}

/// The values of an FST.
pub(super) struct FstValues {
    path: PathBuf,
    /// Slot of each handle.
    slots: Vec<Option<u32>>,
    bytes: u64,
    /// Whether the file ends where its writer was stopped.
    is_cut: bool,
    blocks: Blocks,
}

/// Path of the file in which a writer keeps the hierarchy until it appends it: `x.fst.hier`.
fn hierarchy_beside(path: &Path) -> Option<File> {
    let mut name = path.as_os_str().to_owned();
    name.push(".hier");
    let found = File::open(name).or_else(|_| File::open(path.with_extension("hier")));
    found
        .ok()
        .filter(|file| file.metadata().is_ok_and(|data| data.is_file() && data.len() > 0))
}

/// Opens a file and reads its declarations.
pub(super) fn open(path: &Path, selection: Selection) -> Result<(Declarations, FstValues), WaveError> {
    let file = Bytes::open(path)?;
    read(path, file, selection).map_err(|stop| refused(path, stop))
}

fn read(path: &Path, mut file: Bytes, selection: Selection) -> Result<(Declarations, FstValues), Stop> {
    let (blocks, cut) = fst_file::blocks(&mut file)?;
    if !blocks
        .first()
        .is_some_and(|block| block.kind == HEADER && block.length >= HEADER_BYTES)
    {
        return Err(Stop::Unknown(
            "the file does not begin with a whole header: it was cut off, or is not an FST; write it again".to_owned(),
        ));
    }
    let inside = blocks.iter().find(|block| hierarchy::is_hierarchy(block));
    let hierarchy = match (inside, &cut, hierarchy_beside(path)) {
        (Some(block), None, _) => hierarchy::unpack(&mut file, *block).map_err(|stop| stop.in_block(*block))?,
        (_, _, Some(beside)) => hierarchy::beside(beside)?,
        (_, Some((_, what)), None) => return Err(Stop::Unknown(format!("{what}; write it again"))),
        (None, None, None) => {
            return Err(Stop::Unknown(
                "it has no hierarchy: it was cut off, or its writer is still running, or was killed and its `.hier` file \
                 is not here; write it again"
                    .to_owned(),
            ));
        }
    };
    let is_cut = cut.is_some() || inside.is_none();

    let mut changes = Vec::new();
    let mut blackouts = Vec::new();
    let mut forms = None;
    for block in blocks {
        let at = |stop: Stop| stop.in_block(block);
        match block.kind {
            HEADER | SKIPPED => {}
            GEOMETRY => forms = Some(fst_blocks::forms(&mut file, block).map_err(at)?),
            BLACKOUT => blackouts = fst_blocks::blackouts(&mut file, block).map_err(at)?,
            _ if block.is_changes() => changes.push(block),
            _ if hierarchy::is_hierarchy(&block) => {}
            kind => {
                return Err(at(Stop::Unknown(format!(
                    "found a block of unknown kind {kind}: the file is damaged, or from a newer writer"
                ))));
            }
        }
    }
    file.seek(SeekFrom::Start(TIMESCALE_AT))?;
    let mut exponent = [0];
    file.read_exact(&mut exponent)?;
    let mut declaring = Declaring {
        declarations: Declarations::new(unit_fs(i8::from_be_bytes(exponent))?, selection),
        slots: Vec::new(),
        forms_are_known: forms.is_some(),
        forms: forms.unwrap_or_default(),
    };
    hierarchy::each(&hierarchy, |entry| declaring.declare(entry))?;
    let Declaring {
        mut declarations,
        slots,
        forms,
        ..
    } = declaring;
    declarations.finish_open();
    let bytes = file.length();
    let values = FstValues {
        path: path.to_owned(),
        slots,
        bytes,
        is_cut,
        blocks: Blocks::new(file, changes, forms, blackouts)?,
    };
    Ok((declarations, values))
}

/// What has been declared so far.
struct Declaring {
    declarations: Declarations,
    /// By handle.
    slots: Vec<Option<u32>>,
    forms: Vec<Form>,
    forms_are_known: bool,
}

impl Declaring {
    fn declare(&mut self, entry: Entry<'_>) -> Result<(), Stop> {
        let declarations = &mut self.declarations;
        let declared = match entry {
            Entry::Scope { name } => declarations.enter(&String::from_utf8_lossy(name)),
            Entry::End => {
                if !declarations.leave() {
                    let note = "the end of a scope that never began is ignored".to_owned();
                    declarations.note_once("never began", note);
                }
                Ok(())
            }
            Entry::Signal(signal) => return self.signal(&signal),
        };
        declared.map_err(Stop::Unknown)
    }

    fn signal(&mut self, signal: &Signal<'_>) -> Result<(), Stop> {
        if !self.forms_are_known && !signal.is_alias {
            self.forms.push(match signal.kind {
                kind if REALS.contains(&kind) => Form::Real,
                STRING => Form::Text,
                _ if signal.bits == 0 => Form::Text,
                _ => Form::Bits(signal.bits),
            });
        }
        let handle = signal.handle;
        let form = self.forms.get(handle);
        let form = form.ok_or_else(|| Stop::Damaged("the hierarchy has more signals than the file".to_owned()))?;
        if handle >= self.slots.len() {
            self.slots.resize(handle + 1, None);
        }
        let name = String::from_utf8_lossy(signal.name).replace(" [", "[");
        let kind = match (signal.kind, form) {
            (EVENT, _) => Kind::Event,
            (PORT, Form::Bits(length)) => port_bits(*length).map_or(Kind::Bits(*length), Kind::Bits),
            (_, Form::Bits(bits)) => Kind::Bits(*bits),
            // A signal of no bits has the form of a real number.
            (kind, Form::Real) if signal.bits == 0 && !REALS.contains(&kind) => Kind::Bits(0),
            (_, Form::Real) => Kind::Real,
            (_, Form::Text) => Kind::Text,
        };
        let declarations = &mut self.declarations;
        let known = self.slots[handle];
        let mut add = || {
            let known_kind = known.map(|slot| declarations.kinds[slot as usize]);
            if !declarations.is_wanted(&name, known_kind.unwrap_or(kind))? {
                return Ok(known);
            }
            let slot = match known {
                Some(slot) => slot,
                None => declarations.add_slot(kind)?,
            };
            declarations.add_name(&name, slot)?;
            Ok(Some(slot))
        };
        self.slots[handle] = add().map_err(Stop::Unknown)?;
        Ok(())
    }
}

/// Leaves out of both files the pairs of slots that have the same changes in both, because a comparison would find them equal. Does nothing
/// unless all `needed` pairs are among them. With `every_time`, the first file still has a step at each time at which anything changes.
/// With `only_edges`, the first needed pair is the watched clock, and only its edges are wanted.
pub(super) fn leave_out_same(
    [a, b]: [&mut FstValues; 2],
    pairs: &[[u32; 2]],
    needed: &[[u32; 2]],
    every_time: bool,
    only_edges: bool,
) {
    if a.is_cut || b.is_cut {
        return;
    }
    let [handles_a, handles_b] = [&*a, &*b].map(FstValues::handles);
    let handle = |[slot_a, slot_b]: &[u32; 2]| {
        let of = |handles: &[Option<usize>], slot: u32| handles.get(slot as usize).copied().flatten();
        Some([of(&handles_a, *slot_a)?, of(&handles_b, *slot_b)?])
    };
    let found: Option<Vec<[usize; 2]>> = needed.iter().chain(pairs).map(handle).collect();
    let Some(found) = found else { return };
    let needed: Vec<usize> = (0..needed.len()).collect();
    let Some(same) = fst_blocks::same([&mut a.blocks, &mut b.blocks], &found, &needed, every_time) else {
        return;
    };
    for (pair, same) in found.iter().zip(same.pairs).skip(needed.len()) {
        if same {
            (a.slots[pair[0]], b.slots[pair[1]]) = (None, None);
        }
    }
    let left_out = found
        .iter()
        .map(|pair| pair[0])
        .filter(|handle| every_time && a.slots[*handle].is_none());
    a.blocks.stop_at(same.times, left_out.collect());
    if let Some([of_a, of_b]) = found.first()
        && only_edges
        && same.times_rise
    {
        a.blocks.take_only_edges(*of_a);
        b.blocks.take_only_edges(*of_b);
    }
}

impl FstValues {
    /// Returns the handle of each slot.
    fn handles(&self) -> Vec<Option<usize>> {
        let mut handles = Vec::new();
        for (handle, slot) in self.slots.iter().enumerate() {
            let Some(slot) = slot else { continue };
            let slot = *slot as usize;
            handles.resize(handles.len().max(slot + 1), None);
            handles[slot] = Some(handle);
        }
        handles
    }

    /// Leaves out the slots that are not wanted.
    pub(super) fn leave_out(&mut self, is_wanted: impl Fn(u32) -> bool) {
        for slot in &mut self.slots {
            *slot = slot.filter(|slot| is_wanted(*slot));
        }
    }

    /// Reads to the end. `hand_over` takes full batches, and returns whether to continue.
    pub(super) fn read(
        mut self,
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<Ended, WaveError> {
        match self.blocks.read(&self.slots, gatherer, hand_over) {
            Ok(()) => {}
            Err(Stop::Unheard) => return Ok(Ended::Unheard),
            Err(stop) => return Err(refused(&self.path, stop)),
        }
        if self.is_cut {
            // More may have happened at the last time.
            gatherer.drop_step();
            return Ok(Ended::Cut { byte: self.bytes });
        }
        gatherer.end_step();
        Ok(Ended::File { unterminated: false })
    }
}

fn unit_fs(exponent: i8) -> Result<u64, Stop> {
    let zeros = u32::try_from(i32::from(exponent) + 15).ok();
    let unit = zeros.and_then(|zeros| 10u64.checked_pow(zeros));
    unit.filter(|unit| *unit <= 100_000_000_000_000_000)
        .ok_or_else(|| Stop::Unknown(format!("a timescale of 10^{exponent} s: 1 fs to 100 s are read")))
}

/// Returns the error of a file that is not read further.
pub(super) fn refused(path: &Path, stop: Stop) -> WaveError {
    let problem = match stop {
        Stop::Io(cause) => return WaveError::file(path, "read")(cause),
        Stop::Damaged(what) => format!("{what}: the file is damaged; write it again"),
        Stop::Unknown(what) => what,
        Stop::Unheard => String::new(),
    };
    WaveError::Damaged {
        path: path.to_owned(),
        place: "FST".to_owned(),
        problem,
    }
}
