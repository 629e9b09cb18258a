//! Reads FST, GTKWave's packed format, with the crate `fst-reader`.
//!
//! That crate reads block by block and calls back in the order of time, so memory is bounded by the size of a block,
//! which the writer chooses, and not by the length of the file; but a file that is packed as a whole, as GHDL writes
//! it, is unpacked in memory first ([`super::fst_file`]). It is the reader inside `wellen`, by the same author, without what `wellen` keeps
//! in memory; it is pinned to its minor version, since its interface still changes.
//!
//! It does not report the periods of `$dumpoff`. It panics on some damaged files; that is caught here.

use std::fs::File;
use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use fst_reader::{
    FstFilter, FstHierarchyEntry, FstReader, FstSignalHandle, FstSignalValue, FstVarType, ReadSignalsError,
};

use super::batch::NOWHERE;
use super::digits::pack;
use super::fst_blocks::{Blocks, Stop};
use super::fst_file::{self, Bytes, Cut, PACKED};
use super::gatherer::Gatherer;
use super::header::{Declarations, Kind};
use super::section::Ended;
use super::values::pack_text;
use crate::WaveError;

type Source = FstReader<BufReader<Bytes>>;

/// Beginning of a file with a header block: its first byte and the length.
const HEADER: [u8; 9] = [0, 0, 0, 0, 0, 0, 0, 1, 0x49];

/// Returns whether the file begins like an FST.
pub(super) fn is_fst(beginning: &[u8]) -> bool {
    beginning.starts_with(&HEADER) || beginning.first() == Some(&PACKED)
}

/// The values of an FST.
pub(super) struct FstValues {
    path: PathBuf,
    source: Source,
    /// Slot of each handle.
    slots: Vec<Option<u32>>,
    bytes: u64,
    /// Whether the file ends where its writer was stopped.
    is_cut: bool,
    /// The blocks, if they can be read directly.
    blocks: Option<Blocks>,
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
pub(super) fn open(path: &Path) -> Result<(Declarations, FstValues), WaveError> {
    let mut file = Bytes::open(path)?;
    let cut = check(path, &mut file, false)?;
    let bytes = file.length();
    let up_to = |end| Ok::<_, WaveError>(BufReader::new(file.again(path, end)?));
    let opened = match &cut {
        None => {
            let whole = up_to(bytes)?;
            let source = guarded(path, || FstReader::open(whole))?;
            source.map_err(|cause| damaged(path, &cause.to_string()))
        }
        Some((_, what)) => Err(damaged(path, what)),
    };
    // Its writer was stopped before it appended the hierarchy.
    let (mut source, is_cut) = match (opened, hierarchy_beside(path)) {
        (Ok(source), _) => (source, false),
        (Err(why), None) => return Err(why),
        (Err(_), Some(hierarchy)) => {
            let whole = up_to(cut.map_or(bytes, |(at, _)| at))?;
            let source = guarded(path, || FstReader::open_incomplete(whole, BufReader::new(hierarchy)))?;
            (source.map_err(|cause| damaged(path, &cause.to_string()))?, true)
        }
    };
    let unit_fs = unit_fs(source.get_header().timescale_exponent).map_err(|what| damaged(path, &what))?;
    let mut declarations = Declarations::new(unit_fs);
    let mut slots: Vec<Option<u32>> = Vec::new();
    let mut problem = None;
    let entries = guarded(path, || {
        source.read_hierarchy(|entry| {
            if problem.is_none()
                && let Err(what) = declare(&mut declarations, &mut slots, entry)
            {
                problem = Some(what);
            }
        })
    })?;
    entries.map_err(|cause| damaged(path, &cause.to_string()))?;
    match problem {
        Some(what) => Err(damaged(path, &what)),
        None => declarations.finish().map_err(|what| damaged(path, &what)),
    }?;
    let blocks = if is_cut {
        None
    } else {
        let again = file.again(path, bytes)?;
        Blocks::find(again, &slots, &declarations.kinds).unwrap_or(None)
    };
    if blocks.is_none() {
        check(path, &mut file, true)?;
    }
    let path = path.to_owned();
    let values = FstValues {
        path,
        source,
        slots,
        bytes,
        is_cut,
        blocks,
    };
    Ok((declarations, values))
}

fn check(path: &Path, file: &mut Bytes, chains: bool) -> Result<Option<Cut>, WaveError> {
    let checked = fst_file::check(file, chains).map_err(WaveError::file(path, "read"))?;
    checked.map_err(|what| damaged(path, &what))
}

fn declare(
    declarations: &mut Declarations,
    slots: &mut Vec<Option<u32>>,
    entry: FstHierarchyEntry,
) -> Result<(), String> {
    match entry {
        FstHierarchyEntry::Scope { name, .. } => declarations.enter(&name),
        FstHierarchyEntry::UpScope => declarations.leave(),
        FstHierarchyEntry::Var {
            tpe,
            name,
            length,
            handle,
            ..
        } => {
            let kind = match tpe {
                FstVarType::Real | FstVarType::RealParameter | FstVarType::RealTime | FstVarType::ShortReal => {
                    Kind::Real
                }
                FstVarType::GenericString => Kind::Text,
                FstVarType::Event => Kind::Event,
                // GHDL and nvc write VHDL's strings as variables without a length.
                _ if length == 0 => Kind::Text,
                _ => Kind::Bits(length),
            };
            let at = handle.get_index();
            if at >= slots.len() {
                slots.resize(at + 1, None);
            }
            let slot = match slots[at] {
                Some(slot) => slot,
                None => declarations.add_slot(kind, &name)?,
            };
            slots[at] = Some(slot);
            declarations.add_name(&name.replace(" [", "["), slot)
        }
        _ => Ok(()),
    }
}

impl FstValues {
    /// Reads to the end. `hand_over` takes full batches, and returns whether to continue.
    pub(super) fn read(
        mut self,
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<Ended, WaveError> {
        if let Some(mut blocks) = self.blocks.take() {
            match blocks.read(&self.slots, gatherer, hand_over) {
                Ok(()) => {}
                Err(Stop::Unheard) => return Ok(Ended::Unheard),
                Err(Stop::Damaged(what)) => return Err(damaged(&self.path, &what)),
                Err(Stop::Io(cause)) => return Err(WaveError::file(&self.path, "read")(cause)),
            }
            gatherer.end_step();
            return Ok(Ended::File { unterminated: false });
        }
        let wanted = (0..self.slots.len()).filter(|at| self.slots[*at].is_some());
        let filter = FstFilter::filter_signals(wanted.map(FstSignalHandle::from_index).collect());
        let (slots, path, bytes) = (&self.slots, &self.path, self.bytes);
        gatherer.batch.bytes = bytes;
        let source = &mut self.source;
        let read = guarded(path, || {
            source.read_signals(&filter, |time, handle, value| {
                if time < gatherer.time() {
                    return Err(Some(format!("time goes back to {time}")));
                }
                if gatherer.advance(time, NOWHERE) {
                    if !hand_over(gatherer) {
                        return Err(None);
                    }
                    gatherer.batch.bytes = bytes;
                }
                match slots.get(handle.get_index()).copied().flatten() {
                    Some(slot) => put(gatherer, slot, &value).map_err(Some),
                    None => Ok(()),
                }
            })
        })?;
        match read {
            Ok(()) => {}
            Err(ReadSignalsError::CallbackError(None)) => return Ok(Ended::Unheard),
            Err(ReadSignalsError::CallbackError(Some(what))) => return Err(damaged(path, &what)),
            Err(ReadSignalsError::ReadError(cause)) => return Err(damaged(path, &cause.to_string())),
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

fn put(gatherer: &mut Gatherer, slot: u32, value: &FstSignalValue<'_>) -> Result<(), String> {
    match (gatherer.kind(slot), value) {
        (Kind::Real, FstSignalValue::Real(real)) => gatherer.put_word(slot, real.to_bits(), 0),
        (Kind::Bits(width), FstSignalValue::String(digits)) => {
            if digits.is_empty() || digits.len() > width as usize {
                return Err(format!("{} digits for a signal of {width} bits", digits.len()));
            }
            let words = gatherer.put_words(slot);
            let (bits, unknown) = words.split_at_mut(words.len() / 2);
            pack(digits, width, bits, unknown).map_err(|byte| format!("byte {byte} is not a digit"))?;
            gatherer.watch_last(slot);
        }
        (Kind::Text, FstSignalValue::String(text)) => pack_text(text, gatherer.put_words(slot)),
        (Kind::Event, _) => {}
        _ => return Err("a value of another type than declared".to_owned()),
    }
    Ok(())
}

fn unit_fs(exponent: i8) -> Result<u64, String> {
    let zeros = u32::try_from(i32::from(exponent) + 15).ok();
    let unit = zeros.and_then(|zeros| 10u64.checked_pow(zeros));
    unit.filter(|unit| *unit <= 100_000_000_000_000_000)
        .ok_or_else(|| format!("a timescale of 10^{exponent} s: 1 fs to 100 s are allowed"))
}

/// Runs a call into the crate; if that panics, the file is damaged.
fn guarded<T>(path: &Path, call: impl FnOnce() -> T) -> Result<T, WaveError> {
    catch_unwind(AssertUnwindSafe(call)).map_err(|_| damaged(path, "its reader gave up"))
}

pub(super) fn damaged(path: &Path, what: &str) -> WaveError {
    WaveError::Damaged {
        path: path.to_owned(),
        place: "FST".to_owned(),
        problem: format!("{what}: the file is damaged, or of a kind that cannot be read; write it again"),
    }
}
