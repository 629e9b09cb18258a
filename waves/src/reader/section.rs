//! Reads the value changes of a VCD, byte by byte; this part takes almost all of the time.
//!
//! ```text
//!  #25              time                          1!   0"   x#      one digit and an id code
//!  b1010 $          digits and an id code         r2.5 %  sword &   a real number, a text
//!  $dumpoff … $end  blocks around changes         $comment … $end   nothing
//!  pDU 60 06 <1     states and strengths of a port, in an extended VCD
//! ```
//!
//! A block that no `$end` closes ends at the next time, as Treadle and `fst2vcd` write it.
//!
//! Nothing is allocated per change: digits are packed into words eight at a time, and id codes are numbers that index
//! a table. The buffer is refilled when it does not contain a whole command, and grows only for a command that is
//! longer than the buffer.

use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::counted::Counted;
use super::digits::{decimal, digit, is_state, state};
use super::gatherer::Gatherer;
use super::header::Kind;
use super::ids::Ids;
use super::lines::Lines;
use super::put::{put_digits, put_port, put_real, put_text, shown};
use super::words::{Fault, leading_word, line_of, skip_space, truncated, unknown_id, word_end};
use crate::WaveError;

const BUFFER_BYTES: usize = 1 << 18;
/// Largest number of bytes of a command: a vector of 2^24 bits, twice over.
const COMMAND_BYTES: usize = 1 << 25;

/// How a file is treated that ends in the middle of something.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum FileEnd {
    /// It is refused.
    #[default]
    Refuse,
    /// It is read up to its last complete time.
    UpToLastTime,
    /// It was read before, perhaps not to its end: it is read as far as it can be.
    AsFarAsPossible,
}

/// How the reading ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// The file is at its end; if its last line lacks the line break, it may have been cut off.
    File { unterminated: bool },
    /// The file was cut off after this many bytes, and was read up to its last complete time.
    Cut { byte: u64 },
    /// The receiver is gone.
    Unheard,
}

enum Pause {
    /// A command continues after the buffer.
    More,
    Stop,
}

/// The value changes of a file.
pub(super) struct Section {
    path: PathBuf,
    input: Counted,
    ids: Arc<Ids>,
    buffer: Vec<u8>,
    /// The unread part of the buffer, and the position of the buffer in the file.
    from: usize,
    to: usize,
    start: u64,
    last_byte: u8,
    at_end: bool,
    /// Whether a packed file ends in the middle of its packed data.
    broken: bool,
    /// Whether the bytes are those of the file itself, so that its lines can be counted.
    is_plain: bool,
    in_dump: bool,
    in_comment: bool,
    pub(super) file_end: FileEnd,
    /// Number of bytes after which it was cut off, once that is known; and whether the cut is in a time, so that the
    /// time before it is complete.
    cut: Option<u64>,
    cut_in_time: bool,
}

impl Section {
    /// Continues after the declarations.
    pub(super) fn new(path: &Path, input: BufReader<Counted>, ids: Arc<Ids>, is_plain: bool) -> Self {
        let mut buffer = input.buffer().to_vec();
        let to = buffer.len();
        let start = input.get_ref().bytes - to as u64;
        let last_byte = buffer.last().copied().unwrap_or(b'\n');
        buffer.resize(to.max(BUFFER_BYTES), 0);
        Self {
            path: path.to_owned(),
            input: input.into_inner(),
            ids,
            buffer,
            from: 0,
            to,
            start,
            last_byte,
            at_end: false,
            broken: false,
            is_plain,
            in_dump: false,
            in_comment: false,
            file_end: FileEnd::Refuse,
            cut: None,
            cut_in_time: false,
        }
    }

    /// Continues in the middle of the file, at a byte at which a time begins.
    pub(super) fn resumed(path: &Path, input: Counted, ids: Arc<Ids>) -> Self {
        Self {
            path: path.to_owned(),
            start: input.bytes,
            input,
            ids,
            buffer: vec![0; BUFFER_BYTES],
            from: 0,
            to: 0,
            last_byte: b'\n',
            at_end: false,
            broken: false,
            is_plain: true,
            in_dump: false,
            in_comment: false,
            file_end: FileEnd::Refuse,
            cut: None,
            cut_in_time: false,
        }
    }

    /// Reads to the end. `hand_over` takes full batches, and returns whether to continue.
    pub(super) fn read(
        &mut self,
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<Ended, WaveError> {
        let lines = Lines::new(&self.ids, gatherer.kinds(), gatherer.watched(), |_| false);
        loop {
            let pause = self.parse(&lines, gatherer, hand_over);
            let pause = match pause {
                Err(_) if self.file_end == FileEnd::AsFarAsPossible => return Ok(self.cut_before_step(gatherer)),
                other => other.map_err(|fault| self.problem(&fault))?,
            };
            gatherer.batch.bytes = self.start + self.from as u64;
            match pause {
                Pause::Stop => return Ok(Ended::Unheard),
                Pause::More if self.at_end => break,
                Pause::More => self.fill()?,
            }
        }
        if self.in_dump && gatherer.has_all_values() {
            // `fst2vcd` closes no `$dumpvars`, and there may be no other time.
            self.in_dump = false;
        }
        let whole =
            self.from == self.to && !self.in_dump && !self.in_comment && !self.broken && self.last_byte == b'\n';
        if self.file_end == FileEnd::UpToLastTime && !whole {
            if self.cut_in_time {
                gatherer.end_step();
            } else {
                gatherer.drop_step();
            }
            // If no place was counted so far, the appended line break does not belong to the file.
            let byte = self.cut.unwrap_or(self.start + self.to as u64 - 1);
            return Ok(Ended::Cut { byte });
        }
        let inside = if self.broken {
            "in the middle of its packed data"
        } else if self.from < self.to {
            "in the middle of a command"
        } else if self.in_dump {
            "inside a $dump block"
        } else if self.in_comment {
            "inside a $comment"
        } else {
            ""
        };
        if !inside.is_empty() {
            return match self.file_end {
                FileEnd::AsFarAsPossible => Ok(self.cut_before_step(gatherer)),
                _ => Err(self.truncated(inside)),
            };
        }
        gatherer.end_step();
        let unterminated = self.last_byte != b'\n';
        Ok(Ended::File { unterminated })
    }

    /// Ends the reading before the current step.
    fn cut_before_step(&self, gatherer: &mut Gatherer) -> Ended {
        gatherer.drop_step();
        Ended::Cut {
            byte: self.start + self.from as u64,
        }
    }

    fn fill(&mut self) -> Result<(), WaveError> {
        self.buffer.copy_within(self.from..self.to, 0);
        self.start += self.from as u64;
        self.to -= self.from;
        self.from = 0;
        if self.to == self.buffer.len() {
            if self.to >= COMMAND_BYTES {
                return Err(self.problem(&Fault {
                    at: 0,
                    what: format!(
                        "one command is longer than {COMMAND_BYTES} bytes: the file is damaged, or a signal is too wide \
                         to compare; leave it out when dumping"
                    ),
                }));
            }
            self.buffer.resize(2 * self.to, 0);
        }
        let count = loop {
            match self.input.read(&mut self.buffer[self.to..]) {
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Err(cause) if cause.kind() == io::ErrorKind::UnexpectedEof && !self.is_plain => {
                    self.broken = true;
                    break 0;
                }
                other => break other.map_err(WaveError::file(&self.path, "read"))?,
            }
        };
        self.to += count;
        if count > 0 {
            self.last_byte = self.buffer[self.to - 1];
            return Ok(());
        }
        self.at_end = true;
        let ends_within = self.broken || self.in_dump || self.in_comment || self.last_byte != b'\n';
        if self.file_end == FileEnd::UpToLastTime && ends_within {
            // Half a line could be taken for another time, value or id code.
            self.cut = Some(self.start + self.to as u64);
            let unread = &self.buffer[self.from..self.to];
            self.cut_in_time = !self.in_comment && unread.first() == Some(&b'#');
            self.to = self.from + memchr::memrchr(b'\n', unread).map_or(0, |at| at + 1);
            return Ok(());
        }
        // A last line that lacks only its line break counts.
        self.buffer[self.to] = b'\n';
        self.to += 1;
        Ok(())
    }

    /// Handles all commands that are completely in the buffer.
    fn parse(
        &mut self,
        lines: &Lines,
        gatherer: &mut Gatherer,
        hand_over: &mut dyn FnMut(&mut Gatherer) -> bool,
    ) -> Result<Pause, Fault> {
        let data = &self.buffer[..self.to];
        let ids = &*self.ids;
        loop {
            let mut at = skip_space(data, self.from);
            if !self.in_comment {
                at = skip_space(data, gatherer.put_lines(lines, data, at));
            }
            self.from = at;
            let Some(first) = data.get(at).copied() else {
                return Ok(Pause::More);
            };
            if self.in_comment {
                let Some(end) = word_end(data, at) else {
                    return Ok(Pause::More);
                };
                self.in_comment = !data[at..end].ends_with(b"$end");
                self.from = end;
                continue;
            }
            match first {
                b'b' | b'B' => {
                    let Some((word, digits_end)) = leading_word(data, at + 1) else {
                        return Ok(Pause::More);
                    };
                    let id_at = skip_space(data, digits_end);
                    let (slot, end) = ids.slot_at(data, id_at);
                    if end >= data.len() {
                        return Ok(Pause::More);
                    }
                    let Some(slot) = slot else {
                        return Err(unknown_id(data, id_at, end));
                    };
                    let digits = &data[at + 1..digits_end];
                    match (word, gatherer.kind(slot)) {
                        (Some(word), Kind::Bits(width)) if digits.len() as u32 <= width && width <= 64 => {
                            gatherer.put_word(slot, word, 0);
                        }
                        _ => put_digits(gatherer, slot, digits).map_err(|what| Fault { at, what })?,
                    }
                    self.from = end;
                }
                b'#' => {
                    let (time, end) = match decimal(data, at + 1) {
                        Some((time, end)) if matches!(data.get(end), Some(0..=b' ')) => (time, end),
                        _ => {
                            let Some(end) = word_end(data, at + 1) else {
                                return Ok(Pause::More);
                            };
                            let what = format!("`{}` is not a time, which is a whole number", shown(&data[at..end]));
                            return Err(Fault { at, what });
                        }
                    };
                    if time < gatherer.time() {
                        let before = gatherer.time();
                        return Err(Fault {
                            at,
                            what: format!(
                                "time goes back from #{before} to #{time}: times must rise; the file is damaged, or two \
                                 were joined"
                            ),
                        });
                    }
                    self.from = end;
                    self.in_dump = false;
                    gatherer.in_dump = false;
                    let place = self.start + at as u64;
                    if gatherer.advance(time, place) && !hand_over(gatherer) {
                        return Ok(Pause::Stop);
                    }
                }
                b'r' | b'R' | b's' | b'S' => {
                    let Some(word_to) = word_end(data, at + 1) else {
                        return Ok(Pause::More);
                    };
                    let id_at = skip_space(data, word_to);
                    let (slot, end) = ids.slot_at(data, id_at);
                    if end >= data.len() {
                        return Ok(Pause::More);
                    }
                    let is_real = first.eq_ignore_ascii_case(&b'r');
                    let (word, slot, end) = match slot {
                        // A text with spaces, which are escaped by those who follow the format.
                        None if !is_real => {
                            let Some(length) = memchr::memchr(b'\n', &data[at..]) else {
                                return Ok(Pause::More);
                            };
                            let line = data[at + 1..at + length].trim_ascii_end();
                            let last = line.iter().rposition(|byte| *byte <= b' ').map_or(0, |space| space + 1);
                            let Some(slot) = ids.find(&line[last..]) else {
                                return Err(unknown_id(data, id_at, end));
                            };
                            (line[..last].trim_ascii_end(), slot, at + length)
                        }
                        None => return Err(unknown_id(data, id_at, end)),
                        Some(slot) => (&data[at + 1..word_to], slot, end),
                    };
                    let put = if is_real { put_real } else { put_text };
                    put(gatherer, slot, word).map_err(|what| Fault { at, what })?;
                    self.from = end;
                }
                b'p' | b'P' => {
                    let mut words = [(at + 1, at + 1); 3];
                    let mut end = at + 1;
                    for word in &mut words {
                        let begin = skip_space(data, end);
                        let Some(word_to) = word_end(data, begin) else {
                            return Ok(Pause::More);
                        };
                        *word = (begin, word_to);
                        end = word_to;
                    }
                    let id_at = skip_space(data, end);
                    let (slot, end) = ids.slot_at(data, id_at);
                    if end >= data.len() {
                        return Ok(Pause::More);
                    }
                    let Some(slot) = slot else {
                        return Err(unknown_id(data, id_at, end));
                    };
                    let [states, weak, strong] = words.map(|(from, to)| &data[from..to]);
                    put_port(gatherer, slot, states, [weak, strong]).map_err(|what| Fault { at, what })?;
                    gatherer.note_once("EVCD", || {
                        "an extended VCD (EVCD): states of ports are read as 0, 1, x and z".to_owned()
                    });
                    self.from = end;
                }
                b'$' => {
                    let Some(end) = word_end(data, at) else {
                        return Ok(Pause::More);
                    };
                    match &data[at..end] {
                        b"$comment" => self.in_comment = true,
                        b"$end" => self.in_dump = false,
                        b"$dumpvars" | b"$dumpall" | b"$dumpports" | b"$dumpportsall" => self.in_dump = true,
                        b"$dumpon" | b"$dumpportson" => {
                            self.in_dump = true;
                            gatherer.off(false);
                        }
                        b"$dumpoff" | b"$dumpportsoff" => {
                            self.in_dump = true;
                            gatherer.off(true);
                        }
                        word @ (b"$var" | b"$scope" | b"$upscope" | b"$timescale" | b"$enddefinitions") => {
                            let what = format!(
                                "`{}`, a declaration after $enddefinitions: two files were joined, or the file is damaged",
                                shown(word)
                            );
                            return Err(Fault { at, what });
                        }
                        word => {
                            let place = self.start + at as u64;
                            let word = shown(word);
                            gatherer.note_once("unknown command", || {
                                let line = self.line(place);
                                format!("{line}: `{word}` is not known, and is skipped up to its $end")
                            });
                            self.in_comment = true;
                        }
                    }
                    gatherer.in_dump = self.in_dump;
                    self.from = end;
                }
                byte => {
                    let Some(digit) = digit(byte) else {
                        let what = format!(
                            "unexpected character `{}`, which cannot begin a change: this is not a VCD, or it is damaged",
                            shown(&[byte])
                        );
                        return Err(Fault { at, what });
                    };
                    // IEEE 1364 has no space between the digit and the id code, but some writers do.
                    let id_at = skip_space(data, at + 1);
                    let (slot, end) = ids.slot_at(data, id_at);
                    if end >= data.len() {
                        return Ok(Pause::More);
                    }
                    let Some(slot) = slot else {
                        return Err(unknown_id(data, id_at, end));
                    };
                    if gatherer.kind(slot) == Kind::Bits(1) {
                        gatherer.put_digit(slot, digit);
                        if is_state(byte) {
                            gatherer.note_state(state(&[byte]));
                        }
                    } else {
                        put_digits(gatherer, slot, &[byte]).map_err(|what| Fault { at, what })?;
                    }
                    self.from = end;
                }
            }
        }
    }

    fn problem(&self, fault: &Fault) -> WaveError {
        let unread = self.buffer.get(fault.at..self.to.saturating_sub(1)).unwrap_or_default();
        if self.at_end && self.cut.is_none() && self.last_byte != b'\n' && memchr::memchr(b'\n', unread).is_none() {
            return self.truncated("in the middle of a line");
        }
        WaveError::Damaged {
            path: self.path.clone(),
            place: self.line(self.start + fault.at as u64),
            problem: fault.what.clone(),
        }
    }

    /// Names the line of a byte, or the byte if its line is not known.
    fn line(&self, byte: u64) -> String {
        let line = if self.is_plain { line_of(&self.path, byte) } else { None };
        line.map_or_else(|| format!("byte {byte}"), |line| format!("line {line}"))
    }

    fn truncated(&self, inside: &str) -> WaveError {
        // The line break that was appended to the file does not belong to it.
        truncated(&self.path, self.start + self.to as u64 - u64::from(self.at_end), inside)
    }
}
