//! Parses the pieces of a stretch in which two files are equal byte for byte ([`super::twin`]).

use std::io;

use memchr::memmem::Finder;

use super::batch::Batch;
use super::digits::{decimal, digit, known_run};
use super::gatherer::Gatherer;
use super::header::Kind;
use super::ids::Ids;
use super::lines::Lines;
use super::put::{put_digits, put_real, put_text, real};
use super::twin::{Twins, read_at};

/// Number of bytes of a piece, and additional bytes per signal, because the fixed work for a piece grows with the
/// number of signals. Less in tests, whose files are short.
const PIECE: u64 = if cfg!(test) { 200 } else { 1 << 18 };
const PER_SIGNAL: u64 = if cfg!(test) { 0 } else { 16 };
const MOST_PIECE: u64 = 1 << 21;
/// Number of bytes after a piece within which its last time usually ends; and the largest such number.
const SLACK: usize = if cfg!(test) { 50 } else { 1 << 14 };
const MOST_SLACK: usize = 1 << 23;
const NO_LINE: u32 = u32::MAX;

/// Contents of a piece.
#[derive(Default)]
pub(super) struct Piece {
    /// Latest values: at its end, or just before its last sample.
    pub(super) values: Batch,
    pub(super) samples: u64,
    pub(super) times: [Option<u64>; 2],
    /// The clock after the first step in which it changes, and that step's time; whether this is an edge depends on the
    /// piece before.
    pub(super) open_edge: Option<(u8, u64)>,
    /// The clock at the end.
    pub(super) clock: u8,
    /// First and last time.
    pub(super) first: u64,
    pub(super) last: u64,
    /// Where to continue, as in [`Stretch`].
    pub(super) place: u64,
}

pub(super) enum Found {
    Piece(Box<Piece>),
    /// No time begins here.
    Nothing,
    /// The files differ, or are not in the plain form.
    End,
}

/// The end of the period whose latest values are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UpTo {
    /// Its end, which is quick.
    End,
    /// Its last sample, at which a stretch ends.
    LastSample,
}

/// Work of a thread that parses pieces.
pub(super) struct Worker<'a> {
    twins: &'a Twins,
    places: [u64; 2],
    /// Width by slot, 0 for a real number, a text or an event; or [`STOP`].
    widths: Vec<u32>,
    common: Lines,
    piece_bytes: u64,
    gatherer: Gatherer,
    time_begins: Finder<'static>,
    buffers: [Vec<u8>; 2],
    /// Beginning of the latest line by slot.
    lines: Vec<u32>,
    /// Changes after the last sample, if values are wanted up to there: slot and line.
    open: Vec<(u32, u32)>,
}

const STOP: u32 = u32::MAX;

impl<'a> Worker<'a> {
    pub(super) fn new(twins: &'a Twins, places: [u64; 2], stop: &[bool]) -> Self {
        let kinds = &twins.files[0].kinds;
        let width = |(kind, stop): (&Kind, &bool)| match kind {
            _ if *stop => STOP,
            Kind::Bits(width) => *width,
            Kind::Real | Kind::Text | Kind::Event | Kind::Any(_) => 0,
        };
        Self {
            twins,
            places,
            widths: kinds.iter().zip(stop).map(width).collect(),
            common: Lines::new(
                &twins.files[0].ids,
                kinds,
                twins.files[0].watch.map(|watch| watch.slot),
                |slot| stop[slot as usize],
            ),
            piece_bytes: (PER_SIGNAL * kinds.len() as u64).clamp(PIECE, MOST_PIECE),
            gatherer: Gatherer::new(kinds.clone(), None),
            time_begins: Finder::new(b"\n#"),
            buffers: Default::default(),
            lines: vec![NO_LINE; kinds.len()],
            open: Vec::new(),
        }
    }

    /// Reads piece `number`, from the first time that begins at or after its first byte, to the first one at or after
    /// its last.
    pub(super) fn piece(&mut self, number: u64, up_to: UpTo) -> io::Result<Found> {
        let begin = number * self.piece_bytes;
        // The line break before it shows whether a time begins at its first byte.
        let first = begin.saturating_sub(1);
        let length = (begin + self.piece_bytes - first) as usize;
        let mut slack = SLACK;
        let (end, count_b) = loop {
            let wanted = length + slack;
            let mut counts = [0; 2];
            for (at, count) in counts.iter_mut().enumerate() {
                let buffer = &mut self.buffers[at];
                buffer.resize(wanted, 0);
                *count = read_at(&self.twins.files[at].file, buffer, self.places[at] + first)?;
            }
            let behind = self.buffers[0].get(length - 1..counts[0]);
            if let Some(found) = behind.and_then(|behind| self.time_begins.find(behind)) {
                break (length + found, counts[1]);
            }
            if counts != [wanted; 2] || slack >= MOST_SLACK {
                return Ok(Found::End);
            }
            slack *= 8;
        };
        let [a, b] = &self.buffers;
        // After the end of the second file, the buffer has old bytes.
        if count_b <= end || a[..=end] != b[..=end] {
            return Ok(Found::End);
        }
        let from = if begin == 0 {
            0
        } else {
            match self.time_begins.find(&a[..=end]) {
                Some(found) if found + 1 < end => found + 1,
                _ => return Ok(Found::Nothing),
            }
        };
        let buffer = std::mem::take(&mut self.buffers[0]);
        let found = match up_to {
            UpTo::End => self.parse::<false>(&buffer, from, end),
            UpTo::LastSample => self.parse::<true>(&buffer, from, end),
        };
        let found = found.and_then(|mut piece| {
            piece.place += first;
            piece.values = self.values(&buffer)?;
            Some(piece)
        });
        self.buffers[0] = buffer;
        self.lines.fill(NO_LINE);
        self.open.clear();
        Ok(found.map_or(Found::End, |piece| Found::Piece(Box::new(piece))))
    }

    /// Reads the lines from `from` to `end`, which are places of times, and keeps the latest of each signal; with
    /// `UP_TO_SAMPLE`, only those before the last sample. Returns `None` if any is not plain.
    fn parse<const UP_TO_SAMPLE: bool>(&mut self, data: &[u8], from: usize, end: usize) -> Option<Piece> {
        let twins = self.twins;
        let watch = twins.files[0].watch;
        let clock_slot = watch.map_or(u32::MAX, |watch| watch.slot);
        let ids = &*twins.files[0].ids;
        let mut piece = Piece::default();
        let mut time: Option<u64> = None;
        let (mut time_at, mut step_at, mut step_from) = (from, from, 0);
        // The clock before the current step, if it is known, and now.
        let mut clock: [Option<u8>; 2] = [None; 2];
        let mut at = from;
        loop {
            loop {
                // Tried first: if any signal is left out, most are.
                while let Some(next) = self.common.left_out(data, at) {
                    if data[next - 1] != b'\n' {
                        return None;
                    }
                    // A time without changes is not a sample.
                    if at == step_at {
                        step_at = next;
                    }
                    at = next;
                }
                let (slot, end, next) = if let Some(line) = self.common.bit(data, at) {
                    if line.is_clock {
                        clock[1] = Some(line.digit);
                    }
                    (line.slot, line.end, line.next)
                } else if let Some(line) = self.common.word(data, at) {
                    (line.slot, line.end, line.next)
                } else {
                    break;
                };
                if end != b'\n' {
                    return None;
                }
                self.keep::<UP_TO_SAMPLE>(slot, at);
                at = next;
            }
            let first = if at < end { data[at] } else { b'#' };
            match first {
                b'#' => {
                    if let (Some(time), true) = (time, at > step_at) {
                        match watch {
                            None => {
                                piece.samples += 1;
                                piece.times = [Some(time), piece.times[0]];
                            }
                            Some(watch) if clock[1].is_some() && clock[0] != clock[1] => {
                                let now = clock[1]?;
                                match clock[0] {
                                    None => piece.open_edge = Some((now, time)),
                                    Some(before) if watch.is_edge(before, now) => {
                                        piece.samples += 1;
                                        piece.times = [Some(time), piece.times[0]];
                                        piece.place = time_at as u64;
                                        self.settle_lines(step_from);
                                    }
                                    Some(_) => {}
                                }
                                clock[0] = clock[1];
                            }
                            Some(_) => {}
                        }
                    }
                    if at >= end {
                        break;
                    }
                    let (number, next) = decimal(data, at + 1)?;
                    if *data.get(next)? != b'\n' || time.is_some_and(|time| number <= time) {
                        return None;
                    }
                    if time.is_none() {
                        piece.first = number;
                    }
                    time = Some(number);
                    time_at = at;
                    step_from = self.open.len();
                    at = next + 1;
                    step_at = at;
                }
                b'b' => {
                    let (_, mut digits_end) = known_run(data, at + 1);
                    while digit(*data.get(digits_end)?).is_some() {
                        digits_end += 1;
                    }
                    let digits = digits_end - at - 1;
                    if data[digits_end] != b' ' || digits == 0 {
                        return None;
                    }
                    let (slot, next) = line_end(ids, data, digits_end + 1)?;
                    let width = self.widths[slot as usize];
                    if width == STOP || digits > width as usize || slot == clock_slot {
                        return None;
                    }
                    self.keep::<UP_TO_SAMPLE>(slot, at);
                    at = next;
                }
                b'r' | b's' => {
                    let length = memchr::memchr2(b' ', b'\n', &data[at..])?;
                    let word = &data[at + 1..at + length];
                    let (slot, next) = line_end(ids, data, at + length + 1)?;
                    let right = match self.gatherer.kind(slot) {
                        Kind::Real => first == b'r' && real(word).is_some(),
                        Kind::Text => first == b's',
                        Kind::Bits(_) | Kind::Event | Kind::Any(_) => false,
                    };
                    if !right || data[at + length] != b' ' || self.widths[slot as usize] == STOP {
                        return None;
                    }
                    self.keep::<UP_TO_SAMPLE>(slot, at);
                    at = next;
                }
                byte => {
                    let digit = digit(byte)?;
                    let (slot, next) = line_end(ids, data, at + 1)?;
                    if self.widths[slot as usize] != 1 {
                        return None;
                    }
                    if slot == clock_slot {
                        clock[1] = Some(digit);
                    }
                    self.keep::<UP_TO_SAMPLE>(slot, at);
                    at = next;
                }
            }
        }
        piece.last = time?;
        piece.clock = clock[1].unwrap_or_default();
        match watch {
            None => {
                self.settle_lines(self.open.len());
                piece.place = end as u64;
            }
            // The samples of a piece without an edge are not known.
            Some(_) if piece.samples == 0 => return None,
            Some(_) => {}
        }
        Some(piece)
    }

    /// Keeps a line that changes a slot.
    #[inline]
    fn keep<const UP_TO_SAMPLE: bool>(&mut self, slot: u32, line: usize) {
        if UP_TO_SAMPLE {
            self.open.push((slot, line as u32));
        } else {
            self.lines[slot as usize] = line as u32;
        }
    }

    /// Settles the first `count` open changes, which lie before a sample.
    fn settle_lines(&mut self, count: usize) {
        for (slot, line) in self.open.drain(..count) {
            self.lines[slot as usize] = line;
        }
    }

    /// Returns the values of the lines that were kept.
    fn values(&mut self, data: &[u8]) -> Option<Batch> {
        self.gatherer.take(Batch::default());
        for (slot, line) in (0..).zip(&self.lines) {
            if *line != NO_LINE {
                put_line(&mut self.gatherer, slot, &data[*line as usize..])?;
            }
        }
        Some(self.gatherer.take(Batch::default()))
    }
}

/// Returns the value of a plain line.
fn put_line(gatherer: &mut Gatherer, slot: u32, line: &[u8]) -> Option<()> {
    let word = |line: &[u8]| memchr::memchr(b' ', line);
    match *line.first()? {
        b'b' => put_digits(gatherer, slot, &line[1..word(line)?]),
        b'r' => put_real(gatherer, slot, &line[1..word(line)?]),
        b's' => put_text(gatherer, slot, &line[1..word(line)?]),
        _ => put_digits(gatherer, slot, &line[..1]),
    }
    .ok()
}

/// Returns the slot of the id code at `at`, which ends the line, and the position after the line.
#[inline]
fn line_end(ids: &Ids, data: &[u8], at: usize) -> Option<(u32, usize)> {
    let (slot, end) = ids.slot_at(data, at);
    (*data.get(end)? == b'\n').then_some((slot?, end + 1))
}
