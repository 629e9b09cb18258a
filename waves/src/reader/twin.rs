//! Reads stretches in which two files are equal byte for byte: one file is parsed, and the other only compared with it.
//!
//! ```text
//!  file     … #10 … 1! … #20 … │ #30 … 1! … #40 … │ #50 …       pieces end where a time begins; each thread takes the next one
//!  piece              values just before its last sample │ those after it │ number of samples, and their times
//! ```
//!
//! A piece is parsed without knowledge of what came before it: whether its first change of the clock is an edge is
//! decided when the pieces are put in order. Only the plainest form of a VCD is read here, with one change per line, as
//! every simulator writes it. A stretch ends before a piece that has anything else in it, in which the files differ,
//! with the end of the file, or with a possible error; from there the two files are read separately again, as in
//! [`super::section`].

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::sync_channel;

use memchr::memmem::Finder;

use super::batch::{Batch, Gatherer, Watch};
use super::counted::Counted;
use super::digits::{decimal, digit, known_run};
use super::feed::Feed;
use super::header::Kind;
use super::ids::Ids;
use super::put::{put_digits, put_real, put_text};
use super::section::Section;
use crate::WaveError;

/// Number of bytes of a piece; fewer in tests, whose files are short.
const PIECE: u64 = if cfg!(test) { 200 } else { 1 << 19 };
/// Number of bytes after a piece within which its last time usually ends; and the largest such number.
const SLACK: usize = if cfg!(test) { 50 } else { 1 << 14 };
const MOST_SLACK: usize = 1 << 23;
/// Number of bytes that are compared before threads are started.
const FIRST_LOOK: usize = if cfg!(test) { 20 } else { 1 << 16 };
const THREADS: usize = 4;
const NO_LINE: u32 = u32::MAX;

/// Everything needed to read a VCD again from a place in its middle.
pub(crate) struct Reopen {
    pub(super) path: PathBuf,
    pub(super) file: File,
    pub(super) ids: Arc<Ids>,
    pub(super) kinds: Vec<Kind>,
    pub(super) watch: Option<Watch>,
    pub(super) allow_truncated: bool,
}

impl Reopen {
    /// Continues at a byte at which a time begins, which is later than the time `before`.
    pub(crate) fn resume(self: &Arc<Self>, place: u64, before: u64) -> Result<Feed, WaveError> {
        let file = self.file.try_clone().map_err(WaveError::file(&self.path, "open"))?;
        let input = Counted {
            input: Box::new(Placed { file, place }),
            bytes: place,
        };
        let mut section = Section::resumed(&self.path, input, Arc::clone(&self.ids));
        section.allow_truncated = self.allow_truncated;
        let gatherer = Gatherer::resumed(self.kinds.clone(), self.watch, before);
        let feed = Feed::start(&self.path, gatherer, move |gatherer, hand_over| {
            section.read(gatherer, hand_over)
        })?;
        Ok(feed.with_reopen(Arc::clone(self)))
    }
}

/// A file from a place on. It keeps its own position, because the system's position is shared by all handles of the
/// file.
struct Placed {
    file: File,
    place: u64,
}

impl Read for Placed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = read_some_at(&self.file, buffer, self.place)?;
        self.place += count as u64;
        Ok(count)
    }
}

/// Two files with equal declarations.
#[derive(Clone)]
pub(crate) struct Twins {
    files: [Arc<Reopen>; 2],
    lengths: Vec<u32>,
}

/// Effect of a stretch on the comparison, piece by piece.
#[derive(Default)]
pub(crate) struct Stretch {
    /// Where to continue in each file: at the time of the last sample; without a clock, after it.
    pub(crate) places: [u64; 2],
    /// A time before that place.
    pub(crate) before: u64,
    /// Number of samples so far.
    pub(crate) samples: u64,
    /// Times of the last sample and of the previous one.
    pub(crate) times: [Option<u64>; 2],
}

/// Contents of a piece.
#[derive(Default)]
struct Piece {
    /// Latest values just before the last sample, and the changes after it.
    settled: Batch,
    rest: Batch,
    samples: u64,
    times: [Option<u64>; 2],
    /// The clock after the first step in which it changes, and that step's time; whether this is an edge depends on the
    /// piece before.
    open_edge: Option<([u64; 2], u64)>,
    /// The clock at the end.
    clock: [u64; 2],
    /// First and last time.
    first: u64,
    last: u64,
    /// Where to continue, as in [`Stretch`].
    place: u64,
}

enum Found {
    Piece(Box<Piece>),
    /// No time begins here.
    Nothing,
    /// The files differ, or are not in the plain form.
    End,
}

impl Twins {
    /// Returns both files, if their declarations are equivalent and both can be read at any place.
    pub(crate) fn new(a: &Feed, b: &Feed) -> Option<Self> {
        let (a, b) = (a.reopen()?, b.reopen()?);
        let slots = |reopen: &Reopen| reopen.watch.map(|watch| (watch.slot, watch.falling));
        let same = a.ids == b.ids && a.kinds == b.kinds && slots(&a) == slots(&b);
        let lengths = Gatherer::new(a.kinds.clone(), None).lengths();
        same.then(|| Self { files: [a, b], lengths })
    }

    /// Returns both files, to be read separately from the end of a stretch.
    pub(crate) fn resume(&self, stretch: &Stretch) -> Result<[Feed; 2], WaveError> {
        let [a, b] = &self.files;
        let [place_a, place_b] = stretch.places;
        Ok([a.resume(place_a, stretch.before)?, b.resume(place_b, stretch.before)?])
    }

    /// Follows the two files from these places as long as they are equal. With a clock, the time at each place is that
    /// of an edge that has been sampled. `stop` tells by slot whose next change ends the stretch. `apply` is called
    /// with the latest values before each piece's last sample, and with the progress of the stretch. Returns `None` if
    /// the stretch is too short.
    pub(crate) fn follow(
        &self,
        places: [u64; 2],
        stop: &[bool],
        apply: &mut dyn FnMut(u32, &[u64]),
        progress: &mut dyn FnMut(&Stretch),
    ) -> Option<Stretch> {
        let mut looks = [vec![0; FIRST_LOOK], vec![0; FIRST_LOOK]];
        for ((look, file), place) in looks.iter_mut().zip(&self.files).zip(places) {
            let count = read_at(&file.file, look, place).ok()?;
            look.truncate(count);
        }
        if looks[0] != looks[1] || looks[0].len() < FIRST_LOOK {
            return None;
        }
        let [next, limit] = [AtomicU64::new(0), AtomicU64::new(u64::MAX)];
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(THREADS);
        let (send, receive) = sync_channel(2 * threads);
        std::thread::scope(|scope| {
            for _ in 0..threads {
                let send = send.clone();
                let (next, limit) = (&next, &limit);
                scope.spawn(move || {
                    let mut worker = Worker::new(self, places, stop);
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= limit.load(Ordering::Relaxed) {
                            return;
                        }
                        let found = worker.piece(number).unwrap_or(Found::End);
                        if matches!(found, Found::End) {
                            limit.fetch_min(number, Ordering::Relaxed);
                        }
                        if send.send((number, found)).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(send);
            let mut waiting = BTreeMap::new();
            let mut joined = Joined::new(self, places);
            let mut wanted = 0;
            'pieces: for (number, found) in receive {
                waiting.insert(number, found);
                while let Some(found) = waiting.remove(&wanted) {
                    wanted += 1;
                    let goes_on = match found {
                        Found::Nothing => true,
                        Found::Piece(piece) => joined.join(*piece, apply),
                        Found::End => false,
                    };
                    if !goes_on {
                        limit.store(0, Ordering::Relaxed);
                        break 'pieces;
                    }
                    progress(&joined.stretch);
                }
            }
            joined.pieces.then_some(joined.stretch)
        })
    }
}

/// The pieces so far, in order.
struct Joined<'a> {
    twins: &'a Twins,
    from: [u64; 2],
    stretch: Stretch,
    rest: Batch,
    clock: Option<[u64; 2]>,
    last: Option<u64>,
    pieces: bool,
}

impl<'a> Joined<'a> {
    fn new(twins: &'a Twins, from: [u64; 2]) -> Self {
        Self {
            twins,
            from,
            stretch: Stretch::default(),
            rest: Batch::default(),
            clock: None,
            last: None,
            pieces: false,
        }
    }

    /// Adds the next piece; returns `false` if it does not continue the previous one.
    fn join(&mut self, piece: Piece, apply: &mut dyn FnMut(u32, &[u64])) -> bool {
        if self.last.is_some_and(|last| piece.first <= last) {
            return false;
        }
        let stretch = &mut self.stretch;
        let mut sampled_before = stretch.times[0];
        if let (Some(watch), Some((after, time))) = (self.twins.files[0].watch, piece.open_edge) {
            // The first edge of all has been sampled before.
            if let Some(before) = self.clock {
                if watch.is_edge(before, after) {
                    stretch.samples += 1;
                    sampled_before = Some(time);
                }
            } else {
                sampled_before = Some(time);
            }
            self.clock = Some(piece.clock);
        }
        for batch in [&self.rest, &piece.settled] {
            batch.each(0, batch.changes.len(), &self.twins.lengths, |slot, changed| {
                apply(slot, changed.words());
            });
        }
        self.rest = piece.rest;
        stretch.samples += piece.samples;
        let [last, before] = [piece.times[0], piece.times[1].or(sampled_before)];
        if last.is_some() {
            stretch.times = [last, before];
        }
        stretch.places = self.from.map(|from| from + piece.place);
        stretch.before = match self.twins.files[0].watch {
            // The time of the last sample is read again.
            Some(_) => piece.times[0].unwrap_or(1).saturating_sub(1),
            None => piece.last,
        };
        self.last = Some(piece.last);
        self.pieces = true;
        true
    }
}

/// Work of a thread that parses pieces.
struct Worker<'a> {
    twins: &'a Twins,
    places: [u64; 2],
    /// Width by slot, 0 for a real number, a text or an event; or [`STOP`].
    widths: Vec<u32>,
    gatherer: Gatherer,
    time_begins: Finder<'static>,
    buffers: [Vec<u8>; 2],
    /// Beginning of the latest line before the last sample, by slot; and the slots that have one.
    lines: Vec<u32>,
    touched: Vec<u32>,
    /// Changes after the last sample: slot and line.
    open: Vec<(u32, u32)>,
}

const STOP: u32 = u32::MAX;

impl<'a> Worker<'a> {
    fn new(twins: &'a Twins, places: [u64; 2], stop: &[bool]) -> Self {
        let kinds = &twins.files[0].kinds;
        let width = |(kind, stop): (&Kind, &bool)| match kind {
            _ if *stop => STOP,
            Kind::Bits(width) => *width,
            Kind::Real | Kind::Text | Kind::Event => 0,
        };
        Self {
            twins,
            places,
            widths: kinds.iter().zip(stop).map(width).collect(),
            gatherer: Gatherer::new(kinds.clone(), None),
            time_begins: Finder::new(b"\n#"),
            buffers: Default::default(),
            lines: vec![NO_LINE; kinds.len()],
            touched: Vec::new(),
            open: Vec::new(),
        }
    }

    /// Reads piece `number`, from the first time that begins at or after its first byte, to the first one at or after
    /// its last.
    fn piece(&mut self, number: u64) -> io::Result<Found> {
        let begin = number * PIECE;
        // The line break before it shows whether a time begins at its first byte.
        let first = begin.saturating_sub(1);
        let length = (begin + PIECE - first) as usize;
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
        let found = self.parse(&buffer, from, end).map(|mut piece| {
            piece.place += first;
            self.settle(&buffer, &mut piece)?;
            Some(piece)
        });
        self.buffers[0] = buffer;
        self.lines_forgotten();
        Ok(found
            .flatten()
            .map_or(Found::End, |piece| Found::Piece(Box::new(piece))))
    }

    fn lines_forgotten(&mut self) {
        for slot in self.touched.drain(..) {
            self.lines[slot as usize] = NO_LINE;
        }
        self.open.clear();
    }

    /// Reads the lines from `from` to `end`, which are places of times. Returns `None` if any is not plain.
    fn parse(&mut self, data: &[u8], from: usize, end: usize) -> Option<Piece> {
        let twins = self.twins;
        let watch = twins.files[0].watch;
        let clock_slot = watch.map_or(u32::MAX, |watch| watch.slot);
        let ids = &*twins.files[0].ids;
        let mut piece = Piece::default();
        let mut time: Option<u64> = None;
        let (mut time_at, mut step_from) = (from, 0);
        // The clock before the current step, if it is known, and now.
        let mut clock: [Option<[u64; 2]>; 2] = [None; 2];
        let mut at = from;
        loop {
            let first = if at < end { data[at] } else { b'#' };
            match first {
                b'#' => {
                    if let (Some(time), true) = (time, self.open.len() > step_from) {
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
                    if watch.is_none() {
                        // Every time is a sample, so the changes so far lie before one.
                        let count = self.open.len();
                        self.settle_lines(count);
                    }
                    step_from = self.open.len();
                    at = next + 1;
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
                    self.open.push((slot, at as u32));
                    at = next;
                }
                b'r' | b's' => {
                    let length = memchr::memchr2(b' ', b'\n', &data[at..])?;
                    let word = &data[at + 1..at + length];
                    let (slot, next) = line_end(ids, data, at + length + 1)?;
                    let right = match self.gatherer.kind(slot) {
                        Kind::Real => first == b'r' && put_real(&mut self.gatherer, slot, word).is_ok(),
                        Kind::Text => first == b's',
                        Kind::Bits(_) | Kind::Event => false,
                    };
                    if !right || data[at + length] != b' ' || self.widths[slot as usize] == STOP {
                        return None;
                    }
                    self.open.push((slot, at as u32));
                    at = next;
                }
                byte => {
                    let digit = digit(byte)?;
                    let (slot, next) = line_end(ids, data, at + 1)?;
                    if self.widths[slot as usize] != 1 {
                        return None;
                    }
                    if slot == clock_slot {
                        clock[1] = Some([u64::from(digit & 1), u64::from(digit >> 1)]);
                    }
                    self.open.push((slot, at as u32));
                    at = next;
                }
            }
        }
        piece.last = time?;
        piece.clock = clock[1].unwrap_or_default();
        match watch {
            None => {
                let count = self.open.len();
                self.settle_lines(count);
                piece.place = end as u64;
            }
            // A piece without an edge does not tell where the samples are.
            Some(_) if piece.samples == 0 => return None,
            Some(_) => {}
        }
        Some(piece)
    }

    /// Settles the first `count` open changes, which lie before a sample.
    fn settle_lines(&mut self, count: usize) {
        for (slot, line) in self.open.drain(..count) {
            let known = &mut self.lines[slot as usize];
            if *known == NO_LINE {
                self.touched.push(slot);
            }
            *known = line;
        }
    }

    /// Returns the values of the lines.
    fn settle(&mut self, data: &[u8], piece: &mut Piece) -> Option<()> {
        self.gatherer.take(Batch::default());
        for slot in &self.touched {
            put_line(&mut self.gatherer, *slot, &data[self.lines[*slot as usize] as usize..])?;
        }
        piece.settled = self.gatherer.take(Batch::default());
        for (slot, line) in &self.open {
            put_line(&mut self.gatherer, *slot, &data[*line as usize..])?;
        }
        piece.rest = self.gatherer.take(Batch::default());
        Some(())
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

/// Reads up to the buffer's length; the position of the file's own reader does not change.
fn read_at(file: &File, buffer: &mut [u8], place: u64) -> io::Result<usize> {
    let mut count = 0;
    while count < buffer.len() {
        match read_some_at(file, &mut buffer[count..], place + count as u64) {
            Ok(0) => break,
            Ok(more) => count += more,
            Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
            Err(cause) => return Err(cause),
        }
    }
    Ok(count)
}

#[cfg(unix)]
fn read_some_at(file: &File, buffer: &mut [u8], place: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, place)
}

#[cfg(windows)]
fn read_some_at(file: &File, buffer: &mut [u8], place: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, place)
}
