//! Reads a VCD in steps of time, in bounded memory, whatever the file holds.
//!
//! ```text
//! open ─► header ─► read_step ─► (compare `now` with `next`) ─► commit ─► read_step ─► …
//! ```
//!
//! A step is all that happens at one time. Its changes are held back in `next` until [`Reader::commit`], so that whoever
//! samples at a clock's edge sees the values just before it.
//!
//! Limits, so that a hostile file cannot eat the memory: 2^18 signals, 2^24 bits of all signals together, 32 MiB of names,
//! scopes 256 deep, 32 MiB for one command. Beyond them, and for a file that ends in the middle of something, the answer is
//! an error with the place.

mod guard;
mod header;
mod values;

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Chain, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use vcd::{Command, IdCode, ParseError, Parser};

use self::guard::Guard;
pub(crate) use self::header::{Kind, Named};
pub(crate) use self::values::Value;
use self::values::Values;
use crate::Error;

/// The guard lies below the buffer, where it costs nothing per byte.
type Source = Parser<BufReader<Guard<Chain<File, &'static [u8]>>>>;

/// A VCD that is being read.
pub(crate) struct Reader {
    path: PathBuf,
    source: Source,
    names: Vec<Named>,
    slots: HashMap<IdCode, u32>,
    values: Values,
    /// Femtoseconds per unit of the file's time.
    unit_fs: u64,
    /// Time of the step that is read or to be read next.
    time: u64,
    /// A change was read that lies before the first time stamp or after the last one read.
    in_dump: bool,
    ended: bool,
    /// The file ends without a line break: it may have been cut off.
    unterminated: bool,
}

impl Reader {
    /// Opens a file and reads its header.
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        let mut file = File::open(path).map_err(Error::file(path, "open"))?;
        if file.metadata().is_ok_and(|data| data.is_dir()) {
            let folder = io::Error::from(io::ErrorKind::IsADirectory);
            return Err(Error::file(path, "read")(folder));
        }
        let unterminated = ends_without_line_break(&mut file).map_err(Error::file(path, "read"))?;
        // A last line that is complete but for its line break counts.
        let mut buffered = BufReader::with_capacity(1 << 16, Guard::new(file.chain(&b"\n"[..])));
        let first = buffered.fill_buf().map_err(Error::file(path, "read"))?;
        let mark = if first.starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        buffered.consume(mark);
        let mut reader = Self {
            path: path.to_owned(),
            source: Parser::new(buffered),
            names: Vec::new(),
            slots: HashMap::new(),
            values: Values::default(),
            unit_fs: 1_000_000,
            time: 0,
            in_dump: false,
            ended: false,
            unterminated,
        };
        reader.read_header()?;
        Ok(reader)
    }

    /// The signals in the order of the file.
    pub(crate) fn names(&self) -> &[Named] {
        &self.names
    }

    /// Number of different values: names may share one.
    pub(crate) fn slot_count(&self) -> usize {
        self.values.len()
    }

    pub(crate) fn kind(&self, slot: u32) -> Kind {
        self.values.kind(slot)
    }

    /// Femtoseconds per unit of the file's time.
    pub(crate) fn unit_fs(&self) -> u64 {
        self.unit_fs
    }

    /// What stood before the step that was read last.
    pub(crate) fn now(&self, slot: u32) -> Value<'_> {
        self.values.now(slot)
    }

    /// What the step that was read last makes of it.
    pub(crate) fn next(&self, slot: u32) -> Value<'_> {
        self.values.next(slot)
    }

    /// Puts the step that was read last into effect; `changed` hears of each slot that has another value.
    pub(crate) fn commit(&mut self, changed: impl FnMut(u32)) {
        self.values.commit(changed);
    }

    /// Reads one step in which at least one value changes, and returns its time in the file's units; `None` at the end.
    /// The step before must have been committed.
    pub(crate) fn read_step(&mut self) -> Result<Option<u64>, Error> {
        while !self.ended {
            let Some(command) = self.command()? else {
                self.ended = true;
                if self.in_dump {
                    return Err(self.truncated("inside a $dump block"));
                }
                return Ok(self.values.has_changes().then_some(self.time));
            };
            match command {
                Command::Timestamp(time) if time < self.time => {
                    return Err(self.problem(format!(
                        "time goes back from #{} to #{time}: times must rise; the file is damaged, or two were joined",
                        self.time
                    )));
                }
                Command::Timestamp(time) => {
                    let before = std::mem::replace(&mut self.time, time);
                    if time != before && self.values.has_changes() {
                        return Ok(Some(before));
                    }
                }
                Command::ChangeScalar(id, value) => {
                    let slot = self.slot(id)?;
                    self.bits(slot, 1, std::iter::once(value))?;
                }
                Command::ChangeVector(id, vector) => {
                    let slot = self.slot(id)?;
                    self.bits(slot, vector.len(), vector.iter())?;
                }
                Command::ChangeReal(id, value) => {
                    let slot = self.slot(id)?;
                    if self.values.kind(slot) != Kind::Real {
                        return Err(self.problem(format!("a real value for `{id}`, which is declared as bits")));
                    }
                    self.values.set_real(slot, value);
                }
                Command::ChangeString(id, _) => {
                    self.slot(id)?;
                }
                Command::Begin(_) => self.in_dump = true,
                Command::End(_) => self.in_dump = false,
                Command::Comment(_) => {}
                _ => {
                    return Err(self.problem("a declaration after $enddefinitions: the file is damaged".to_owned()));
                }
            }
        }
        Ok(None)
    }

    /// What is wrong with a file that has nothing more to say while another goes on: nothing, unless its last line is cut.
    pub(crate) fn cut_off(&mut self) -> Result<(), Error> {
        if self.unterminated {
            return Err(self.truncated("before the other, in a line without line break"));
        }
        Ok(())
    }

    fn slot(&self, id: IdCode) -> Result<u32, Error> {
        let slot = self.slots.get(&id).copied();
        slot.ok_or_else(|| {
            self.problem(format!(
                "a change of `{id}`, which was never declared: the file is damaged"
            ))
        })
    }

    fn bits(&mut self, slot: u32, length: usize, bits: impl Iterator<Item = vcd::Value>) -> Result<(), Error> {
        match self.values.kind(slot) {
            Kind::Bits(width) if length > width as usize => Err(self.problem(format!(
                "a value of {length} bits for a signal that is declared with {width}: the file is damaged"
            ))),
            Kind::Bits(_) => {
                self.values.set_bits(slot, length, bits);
                Ok(())
            }
            Kind::Real => Err(self.problem("bits for a signal that is declared as real".to_owned())),
            Kind::Other => Ok(()),
        }
    }

    /// The next command, or `None` where the file ends as it should.
    fn command(&mut self) -> Result<Option<Command>, Error> {
        self.source.reader().get_mut().refill();
        self.source.next().transpose().map_err(|cause| self.damaged(&cause))
    }

    fn problem(&self, problem: String) -> Error {
        Error::Vcd {
            path: self.path.clone(),
            place: format!("line {}", self.source.line()),
            problem,
        }
    }

    fn truncated(&mut self, inside: &str) -> Error {
        Error::Vcd {
            path: self.path.clone(),
            // The line break that was put behind the file is not the file's.
            place: format!("byte {}", self.source.reader().get_ref().bytes().saturating_sub(1)),
            problem: format!(
                "the file ends {inside}: it was cut off, or its writer is still running; write it again \
                 (a complete file ends with a line break)"
            ),
        }
    }

    fn damaged(&mut self, cause: &io::Error) -> Error {
        if cause.kind() == io::ErrorKind::UnexpectedEof {
            return self.truncated("in the middle of a command");
        }
        let parse: Option<&ParseError> = cause.get_ref().and_then(|e| e.downcast_ref());
        match parse {
            Some(parse) => self.problem(format!("{}: this is no VCD, or it is damaged", parse.kind())),
            None => self.problem(cause.to_string()),
        }
    }
}

/// Some writers begin a text file with it.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

fn ends_without_line_break(file: &mut File) -> io::Result<bool> {
    let mut last = [b'\n'];
    // A pipe cannot be looked at from behind: it counts as complete.
    if file.metadata()?.len() > 0 && file.seek(SeekFrom::End(-1)).is_ok() {
        file.read_exact(&mut last)?;
        file.seek(SeekFrom::Start(0))?;
    }
    Ok(last != *b"\n")
}
