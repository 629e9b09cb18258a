//! Reads waveforms in steps of time, in bounded memory, whatever the file contains.
//!
//! ```text
//!            ┌─ declarations ───────────────────────► header ─┐          a thread per file         the caller's
//!  x.vcd ────┤                                                  ├─► Wave ─►  section │ fst ─► batches ─► Feed ─► Values
//!  x.fst ────┴─ declarations: blocks of the file ───────────────┘                                       step by step
//! ```
//!
//! [`declarations`] and [`section`] read a VCD. Tests compare them with the crates `vcd` and `wellen` on every fixture.
//!
//! Limits keep a hostile file from using up the memory: 2^22 signals, 2^27 bits of all signals together, 1 GiB of
//! names, scopes 256 deep, 1 MiB for a word of the declarations, 32 MiB for one change. Beyond them, and for a file
//! that ends in the middle of something, the result is an error with the place.

#[cfg(test)]
mod agreement;
mod batch;
mod counted;
mod declarations;
mod digits;
mod feed;
mod fst;
mod fst_blocks;
mod fst_file;
mod gatherer;
mod header;
mod ids;
mod lines;
mod piece;
mod put;
mod section;
mod since_edge;
mod twin;
mod unpack;
mod values;
mod words;

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(crate) use self::batch::{Changed, Changes, NOWHERE, Step};
use self::counted::Counted;
use self::declarations::Stop;
pub(crate) use self::feed::Feed;
use self::fst::FstValues;
use self::gatherer::Gatherer;
pub(crate) use self::gatherer::Watch;
pub(crate) use self::header::{Declarations, Kind, Named, Range, Selection};
use self::ids::Ids;
pub(crate) use self::section::FileEnd;
use self::section::Section;
use self::twin::Reopen;
pub(crate) use self::twin::{Stretch, Twins};
pub(crate) use self::values::{Value, Values, value};
use self::words::truncated;
use crate::WaveError;

/// First bytes of a GHW.
const GHW: &[u8] = b"GHDLwave";

/// Byte order mark with which some writers begin a text file.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

enum Rest {
    Vcd(Box<Section>),
    Fst(Box<FstValues>),
}

/// A waveform file whose declarations have been read.
pub(crate) struct Wave {
    path: PathBuf,
    pub(crate) declarations: Declarations,
    rest: Rest,
    bytes: Option<u64>,
    /// The file and its id codes, to read a VCD again from its middle.
    again: Option<(File, Arc<Ids>)>,
}

impl Wave {
    /// Opens a VCD or an FST, distinguished by its beginning, and reads its declarations.
    pub(crate) fn open(path: &Path) -> Result<Self, WaveError> {
        Self::open_selected(path, Selection::default())
    }

    /// As [`Wave::open`], with the names that are wanted.
    pub(crate) fn open_selected(path: &Path, selection: Selection) -> Result<Self, WaveError> {
        let source = unpack::open(path)?;
        let counted = Counted {
            input: source.input,
            bytes: 0,
        };
        let mut input = BufReader::with_capacity(1 << 16, counted);
        let beginning: &[u8] = match input.fill_buf() {
            // The declarations will say that they are missing.
            Err(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => &[],
            other => other.map_err(WaveError::file(path, "read"))?,
        };
        if beginning.starts_with(GHW) {
            return Err(WaveError::Damaged {
                path: path.to_owned(),
                place: "GHW".to_owned(),
                problem:
                    "this format is not read; let GHDL write FST (`--fst=wave.fst`) or VCD (`--vcd=wave.vcd`) instead"
                        .to_owned(),
            });
        }
        let (declarations, rest, again) = if fst::is_fst(beginning) {
            if source.bytes.is_none() {
                return Err(WaveError::Damaged {
                    path: path.to_owned(),
                    place: "FST".to_owned(),
                    problem: "an FST is read from a plain file only: unpack it, or save it, first".to_owned(),
                });
            }
            let (declarations, values) = fst::open(path, selection)?;
            (declarations, Rest::Fst(Box::new(values)), None)
        } else {
            let (declarations, ids) = read_declarations(path, &mut input, selection)?;
            let ids = Arc::new(ids);
            let section = Section::new(path, input, Arc::clone(&ids), source.file.is_some());
            let again = source.file.map(|file| (file, ids));
            (declarations, Rest::Vcd(Box::new(section)), again)
        };
        Ok(Self {
            path: path.to_owned(),
            declarations,
            rest,
            bytes: source.bytes,
            again,
        })
    }

    /// Lets these slots hold values of any kind.
    pub(crate) fn hold_any(&mut self, slots: &BTreeSet<u32>) {
        for slot in slots {
            if let Some(kind) = self.declarations.kinds.get_mut(*slot as usize) {
                *kind = kind.any();
            }
        }
    }

    pub(crate) fn is_fst(&self) -> bool {
        matches!(self.rest, Rest::Fst(_))
    }

    /// Leaves out of an FST the slots that are not wanted.
    pub(crate) fn leave_out(&mut self, is_wanted: impl Fn(u32) -> bool) {
        if let Rest::Fst(values) = &mut self.rest {
            values.leave_out(is_wanted);
        }
    }

    /// Leaves out of two FST the pairs of slots whose changes are the same in both ([`fst::leave_out_same`]).
    pub(crate) fn leave_out_same(
        [a, b]: [&mut Self; 2],
        pairs: &[[u32; 2]],
        needed: &[[u32; 2]],
        every_time: bool,
        only_edges: bool,
    ) {
        if let (Rest::Fst(a), Rest::Fst(b)) = (&mut a.rest, &mut b.rest) {
            fst::leave_out_same([a, b], pairs, needed, every_time, only_edges);
        }
    }

    /// Returns the length of the file; `None` for a pipe.
    pub(crate) fn bytes(&self) -> Option<u64> {
        self.bytes
    }

    /// Starts to read the values in a separate thread, and marks the edges of a clock.
    pub(crate) fn play(self, watch: Option<Watch>, file_end: FileEnd) -> Result<(Declarations, Feed), WaveError> {
        let kinds = self.declarations.kinds.clone();
        let gatherer = Gatherer::new(kinds.clone(), watch);
        let feed = match self.rest {
            Rest::Vcd(mut section) => {
                section.file_end = file_end;
                Feed::start(&self.path, gatherer, move |gatherer, hand_over| {
                    section.read(gatherer, hand_over)
                })
            }
            Rest::Fst(values) => Feed::start(&self.path, gatherer, move |gatherer, hand_over| {
                values.read(gatherer, hand_over)
            }),
        };
        let mut feed = feed?;
        if let Some((file, ids)) = self.again {
            feed = feed.with_reopen(Arc::new(Reopen {
                path: self.path,
                file,
                ids,
                kinds,
                watch,
                file_end,
            }));
        }
        Ok((self.declarations, feed))
    }
}

/// Returns whether a file can be opened again: a pipe cannot.
pub(crate) fn can_be_read_again(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|data| data.is_file())
}

/// Reads a VCD up to the value changes.
fn read_declarations(
    path: &Path,
    input: &mut BufReader<Counted>,
    selection: Selection,
) -> Result<(Declarations, Ids), WaveError> {
    if input.buffer().starts_with(BYTE_ORDER_MARK) {
        input.consume(BYTE_ORDER_MARK.len());
    }
    let mut line = 1;
    let read = declarations::read(input, &mut line, selection);
    read.map_err(|stop| match stop {
        Stop::Cut(inside) => truncated(path, input.get_ref().bytes, inside),
        Stop::Wrong(problem) => WaveError::Damaged {
            path: path.to_owned(),
            place: format!("line {line}"),
            problem,
        },
    })
}
