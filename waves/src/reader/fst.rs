//! Reads FST, GTKWave's packed format, with the crate `fst-reader`.
//!
//! That crate reads block by block and calls back in the order of time, so memory is bounded by the size of a block,
//! which the writer chooses, and not by the length of the file; but a file that is packed as a whole, as GHDL writes
//! it, is unpacked in memory first. It is the reader inside `wellen`, by the same author, without what `wellen` keeps
//! in memory; it is pinned to its minor version, since its interface still changes.
//!
//! It does not report the periods of `$dumpoff`. It panics on some damaged files; that is caught here.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use fst_reader::{
    FstFilter, FstHierarchyEntry, FstReader, FstSignalHandle, FstSignalValue, FstVarType, ReadSignalsError,
};

use super::batch::{Gatherer, NOWHERE};
use super::digits::pack;
use super::fst_blocks::{Blocks, Stop};
use super::header::{Declarations, Kind};
use super::section::Ended;
use super::values::pack_text;
use crate::WaveError;

type Source = FstReader<BufReader<Whole>>;

/// Beginning of a file with a header block: its first byte and the length.
const HEADER: [u8; 9] = [0, 0, 0, 0, 0, 0, 0, 1, 0x49];
/// First byte of a file that is packed as a whole.
const PACKED: u8 = 254;
/// Largest length of such a file after unpacking, which the crate does in memory.
const PACKED_BYTES: u64 = 1 << 28;
/// Number of bytes of a block header: kind and length.
const BLOCK_BYTES: u64 = 9;

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

/// The file up to the end of its last complete block.
struct Whole {
    file: File,
    at: u64,
    end: u64,
}

impl Whole {
    fn new(file: File, end: u64) -> Self {
        Self { file, at: 0, end }
    }
}

impl Read for Whole {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let room = left.min(buffer.len());
        let count = self.file.read(&mut buffer[..room])?;
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Whole {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.file.seek(match to {
            SeekFrom::End(by) => SeekFrom::Start(self.end.checked_add_signed(by).ok_or(io::ErrorKind::InvalidInput)?),
            other => other,
        })?;
        Ok(self.at)
    }
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
    let mut file = File::open(path).map_err(WaveError::file(path, "open"))?;
    let (bytes, cut) = check_blocks(path, &mut file)?;
    let up_to = |end| {
        let file = File::open(path).map_err(WaveError::file(path, "open"))?;
        Ok::<_, WaveError>(BufReader::new(Whole::new(file, end)))
    };
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
    let blocks = match File::open(path) {
        Ok(file) if !is_cut => Blocks::find(file, &slots, &declarations.kinds).unwrap_or(None),
        _ => None,
    };
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

/// Byte of a block that does not lie within its file, and the reason.
type Cut = (u64, String);

/// Returns the file's length, and the first block that does not lie within it.
fn check_blocks(path: &Path, file: &mut File) -> Result<(u64, Option<Cut>), WaveError> {
    let read = WaveError::file(path, "read");
    let mut walk = || -> io::Result<Result<(u64, Option<Cut>), String>> {
        let length = file.metadata()?.len();
        let mut at = 0;
        while at < length {
            file.seek(SeekFrom::Start(at))?;
            let mut head = [0; BLOCK_BYTES as usize];
            if length - at < BLOCK_BYTES {
                let what = format!("the file ends inside a block at byte {at}: it was cut off");
                return Ok(Ok((length, Some((at, what)))));
            }
            file.read_exact(&mut head)?;
            if head[0] == PACKED {
                let mut length = [0; 8];
                file.read_exact(&mut length)?;
                let unpacked = u64::from_be_bytes(length);
                if unpacked > PACKED_BYTES {
                    return Ok(Err(format!(
                        "the file is packed as a whole, {unpacked} bytes, and at most {PACKED_BYTES} are unpacked in memory"
                    )));
                }
                break;
            }
            let section = u64::from_be_bytes([head[1], head[2], head[3], head[4], head[5], head[6], head[7], head[8]]);
            let next = at.checked_add(1).and_then(|at| at.checked_add(section));
            at = match next {
                // A block that is still being written is marked to be skipped.
                Some(next) if section >= 8 && next <= length => next,
                _ => {
                    let what =
                        format!("a block of {section} bytes at byte {at} does not end in the file: it was cut off");
                    return Ok(Ok((length, Some((at, what)))));
                }
            };
        }
        Ok(Ok((length, None)))
    };
    let walked = walk();
    let back = file.seek(SeekFrom::Start(0));
    let found = walked.and_then(|found| back.map(|_| found)).map_err(read)?;
    found.map_err(|what| damaged(path, &what))
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

fn damaged(path: &Path, what: &str) -> WaveError {
    WaveError::Damaged {
        path: path.to_owned(),
        place: "FST".to_owned(),
        problem: format!("{what}: the file is damaged, or of a kind that cannot be read; write it again"),
    }
}
