//! Reads waveforms in steps of time, in bounded memory, whatever the file contains.
//!
//! ```text
//!            ┌─ declarations: dialect ─► crate `vcd` ─► header ─┐          a thread per file         the caller's
//!  x.vcd ────┤                                                  ├─► Wave ─►  section │ fst ─► batches ─► Feed ─► Values
//!  x.fst ────┴─ declarations: blocks of the file ───────────────┘                                       step by step
//! ```
//!
//! The crate `vcd` reads the declarations, [`section`] the value changes, because the crate makes a string of each
//! and is four times as slow. Tests compare the two, and `wellen`, on every fixture.
//!
//! Limits keep a hostile file from using up the memory: 2^22 signals, 2^27 bits of all signals together, 1 GiB of
//! names, scopes 256 deep, 1 MiB for a word of the declarations, 32 MiB for one change. Beyond them, and for a file
//! that ends in the middle of something, the result is an error with the place.

#[cfg(test)]
mod agreement;
mod batch;
mod counted;
mod dialect;
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
mod twin;
mod unpack;
mod values;
mod words;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use vcd::{Command, IdCode, ParseError, Parser, VarType};

pub(crate) use self::batch::{Changed, Changes, NOWHERE, Step};
use self::counted::Counted;
use self::dialect::Dialect;
pub(crate) use self::feed::Feed;
use self::fst::FstValues;
use self::gatherer::Gatherer;
pub(crate) use self::gatherer::Watch;
pub(crate) use self::header::{Declarations, Kind, Named};
use self::ids::Ids;
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
            let (declarations, values) = fst::open(path)?;
            (declarations, Rest::Fst(Box::new(values)), None)
        } else {
            let (declarations, ids) = read_declarations(path, &mut input)?;
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

    /// Returns the length of the file; `None` for a pipe.
    pub(crate) fn bytes(&self) -> Option<u64> {
        self.bytes
    }

    /// Starts to read the values in a separate thread, and marks the edges of a clock. A file that is cut off in the
    /// middle of a line is an error, or with `allow_truncated` is read up to its last complete time.
    pub(crate) fn play(self, watch: Option<Watch>, allow_truncated: bool) -> Result<(Declarations, Feed), WaveError> {
        let kinds = self.declarations.kinds.clone();
        let gatherer = Gatherer::new(kinds.clone(), watch);
        let feed = match self.rest {
            Rest::Vcd(mut section) => {
                section.allow_truncated = allow_truncated;
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
                allow_truncated,
            }));
        }
        Ok((self.declarations, feed))
    }
}

/// Reads a VCD up to the value changes.
fn read_declarations(path: &Path, input: &mut BufReader<Counted>) -> Result<(Declarations, Ids), WaveError> {
    if input.buffer().starts_with(BYTE_ORDER_MARK) {
        input.consume(BYTE_ORDER_MARK.len());
    }
    let mut parser = Parser::new(Dialect::new(input));
    let read = declarations(&mut parser);
    let line = parser.line();
    read.map_err(|stop| match stop {
        Stop::Cut(inside) => truncated(path, input.get_ref().bytes, inside),
        Stop::Wrong(problem) => WaveError::Damaged {
            path: path.to_owned(),
            place: format!("line {line}"),
            problem,
        },
    })
}

/// Why the declarations could not be read.
enum Stop {
    Wrong(String),
    Cut(&'static str),
}

impl From<String> for Stop {
    fn from(what: String) -> Self {
        Self::Wrong(what)
    }
}

fn declarations<R: BufRead>(parser: &mut Parser<R>) -> Result<(Declarations, Ids), Stop> {
    let mut declarations = Declarations::new(1_000_000);
    declarations.unit_is_assumed = true;
    let mut ids = Ids::default();
    loop {
        let command = match parser.next() {
            None => return Err(Stop::Cut("before $enddefinitions")),
            Some(Ok(command)) => command,
            Some(Err(cause)) if cause.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(Stop::Cut("in the middle of a command"));
            }
            Some(Err(cause)) => {
                let parse: Option<&ParseError> = cause.get_ref().and_then(|e| e.downcast_ref());
                return Err(Stop::Wrong(match parse {
                    Some(parse) => format!("{}: this is not a VCD, or it is damaged", parse.kind()),
                    None => cause.to_string(),
                }));
            }
        };
        match command {
            Command::Enddefinitions => break,
            Command::Timescale(number, unit) => {
                let exponent = match unit {
                    vcd::TimescaleUnit::S => 15,
                    vcd::TimescaleUnit::MS => 12,
                    vcd::TimescaleUnit::US => 9,
                    vcd::TimescaleUnit::NS => 6,
                    vcd::TimescaleUnit::PS => 3,
                    vcd::TimescaleUnit::FS => 0,
                };
                if ![1, 10, 100].contains(&number) {
                    return Err(format!("timescale {number} {unit}: the number is 1, 10 or 100").into());
                }
                declarations.unit_fs = u64::from(number) * 10u64.pow(exponent);
                declarations.unit_is_assumed = false;
            }
            Command::ScopeDef(_, name) => declarations.enter(&name)?,
            Command::Upscope => declarations.leave()?,
            Command::VarDef(var_type, width, id, name, _) => {
                declare(&mut declarations, &mut ids, var_type, width, id, &name)?;
            }
            _ => return Err("a value before $enddefinitions: the file is damaged".to_owned().into()),
        }
    }
    declarations.finish()?;
    Ok((declarations, ids))
}

fn declare(
    declarations: &mut Declarations,
    ids: &mut Ids,
    var_type: VarType,
    width: u32,
    id: IdCode,
    name: &str,
) -> Result<(), String> {
    let kind = match var_type {
        VarType::Real => Kind::Real,
        VarType::String => Kind::Text,
        VarType::Event => Kind::Event,
        _ => Kind::Bits(width),
    };
    let id = id.to_string();
    let number = Ids::number(&id).ok_or_else(|| format!("`{id}` is too long for an id code: 9 characters at most"))?;
    let slot = match ids.get(number) {
        Some(slot) if declarations.kinds[slot as usize] == kind => slot,
        Some(_) => return Err(format!("`{id}` is declared twice, with different widths or types")),
        None => {
            let slot = declarations.add_slot(kind, name)?;
            ids.insert(number, slot);
            slot
        }
    };
    declarations.add_name(name, slot)
}
