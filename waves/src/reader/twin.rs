//! Reads stretches in which two files are equal byte for byte: one file is parsed, and the other only compared with it.
//!
//! ```text
//!  file     … #10 … 1! … #20 … │ #30 … 1! … #40 … │ #50 …       pieces end where a time begins; each thread takes the next one
//!  piece              values at its end │ number of samples, and their times
//! ```
//!
//! For each piece, the latest values at its end are enough; only the last piece is parsed again, up to its last
//! sample. A piece is parsed without knowledge of what came before it: whether its first change of the clock is an edge is
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

use super::counted::Counted;
use super::feed::Feed;
use super::gatherer::{Gatherer, Watch};
use super::header::Kind;
use super::ids::Ids;
use super::piece::{Found, Piece, UpTo, Worker};
use super::section::{FileEnd, Section};
use crate::WaveError;

/// Number of bytes that are compared before threads are started.
const FIRST_LOOK: usize = if cfg!(test) { 20 } else { 1 << 16 };
const THREADS: usize = 4;

/// Everything needed to read a VCD again from a place in its middle.
pub(crate) struct Reopen {
    pub(super) path: PathBuf,
    pub(super) file: File,
    pub(super) ids: Arc<Ids>,
    pub(super) kinds: Vec<Kind>,
    pub(super) watch: Option<Watch>,
    pub(super) file_end: FileEnd,
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
        section.file_end = self.file_end;
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
    pub(super) files: [Arc<Reopen>; 2],
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

    /// Follows the two files from these places as long as they are equal. With a clock, the time at each place is that of an edge that has
    /// been sampled. `stop` has, by slot, whether its next change ends the stretch. `apply` is called with the latest values before each
    /// piece's last sample and their states, `progress` with the progress of the stretch. Returns `None` if the stretch is too short.
    pub(crate) fn follow(
        &self,
        places: [u64; 2],
        stop: &[bool],
        apply: &mut dyn FnMut(u32, &[u64], u64),
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
                        let found = worker.piece(number, UpTo::End).unwrap_or(Found::End);
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
            // The effect of a piece depends on whether it is the last one.
            let mut latest: Option<(u64, Box<Piece>)> = None;
            'pieces: for (number, found) in receive {
                waiting.insert(number, found);
                while let Some(found) = waiting.remove(&wanted) {
                    wanted += 1;
                    match found {
                        Found::Nothing => {}
                        Found::Piece(piece) if latest.as_ref().is_none_or(|(_, latest)| latest.last < piece.first) => {
                            if let Some((_, before)) = latest.replace((wanted - 1, piece)) {
                                joined.join(&before, apply);
                            }
                        }
                        Found::Piece(_) | Found::End => {
                            limit.store(0, Ordering::Relaxed);
                            break 'pieces;
                        }
                    }
                    progress(&joined.stretch);
                }
            }
            if let Some((number, mut last)) = latest {
                if self.files[0].watch.is_some() {
                    match Worker::new(self, places, stop).piece(number, UpTo::LastSample) {
                        Ok(Found::Piece(piece)) => last = piece,
                        // The file has been written to in the meantime.
                        _ => return None,
                    }
                }
                joined.join(&last, apply);
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
    clock: Option<u8>,
    pieces: bool,
}

impl<'a> Joined<'a> {
    fn new(twins: &'a Twins, from: [u64; 2]) -> Self {
        Self {
            twins,
            from,
            stretch: Stretch::default(),
            clock: None,
            pieces: false,
        }
    }

    /// Adds the next piece.
    fn join(&mut self, piece: &Piece, apply: &mut dyn FnMut(u32, &[u64], u64)) {
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
        let values = &piece.values;
        let changes = values.changes((0, 0), values.changes.len(), &self.twins.lengths);
        for (at, (slot, changed)) in changes.enumerate() {
            apply(slot, changed.words(), values.state(at));
        }
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
        self.pieces = true;
    }
}

/// Reads up to the buffer's length; the position of the file's own reader does not change.
pub(super) fn read_at(file: &File, buffer: &mut [u8], place: u64) -> io::Result<usize> {
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
