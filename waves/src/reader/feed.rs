//! A thread that reads a file ahead, and the batches that it hands over.
//!
//! ```text
//!  reading thread ──► full batches (at most 3) ──► comparing thread
//!        ▲                                              │
//!        └──────────────── empty batches ◄──────────────┘
//! ```
//!
//! The batches are reused in a circle, so that nothing is allocated on the way; a reader that is faster than the
//! comparison waits.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;

use super::batch::{Batch, Changes, Step};
use super::gatherer::Gatherer;
use super::section::Ended;
use super::twin::Reopen;
use super::words::truncated;
use crate::WaveError;
use crate::quiet::caught;

const BATCHES: usize = 3;

enum Message {
    Batch(Batch),
    Ended { unterminated: bool, cut: Option<u64> },
    Failed(WaveError),
}

/// The steps of a file, in order.
pub(crate) struct Feed {
    path: PathBuf,
    full: Receiver<Message>,
    empty: SyncSender<Batch>,
    batch: Batch,
    /// Number of words of each slot's values.
    lengths: Vec<u32>,
    /// The current step, and the start of its changes and of their words.
    step: usize,
    first: (usize, usize),
    started: bool,
    ended: bool,
    unterminated: bool,
    cut: Option<u64>,
    reopen: Option<Arc<Reopen>>,
    /// Slots that got a value of another kind than declared.
    odd: Vec<u32>,
    /// What is unusual in the file.
    notes: Vec<String>,
}

impl Feed {
    /// Starts `read` in a separate thread. It hands its batches to the function that it gets, which returns whether
    /// anybody still receives them.
    pub(super) fn start<F>(path: &Path, mut gatherer: Gatherer, read: F) -> Result<Self, WaveError>
    where
        F: FnOnce(&mut Gatherer, &mut dyn FnMut(&mut Gatherer) -> bool) -> Result<Ended, WaveError> + Send + 'static,
    {
        let lengths = gatherer.lengths();
        let (send_full, full) = sync_channel(BATCHES);
        let (empty, take_empty) = sync_channel::<Batch>(BATCHES + 1);
        for _ in 0..BATCHES {
            // There is room for all of them.
            let _ = empty.send(Batch::default());
        }
        let work = move || {
            let mut hand_over = |gatherer: &mut Gatherer| match take_empty.recv() {
                Ok(empty) => send_full.send(Message::Batch(gatherer.take(empty))).is_ok(),
                Err(_) => false,
            };
            // A panic ends the thread without a message; the receiver reports it.
            let Some(read) = caught(|| read(&mut gatherer, &mut hand_over)) else {
                return;
            };
            let end = match read {
                Ok(Ended::Unheard) => return,
                Ok(Ended::File { unterminated }) => Message::Ended {
                    unterminated,
                    cut: None,
                },
                Ok(Ended::Cut { byte }) => Message::Ended {
                    unterminated: false,
                    cut: Some(byte),
                },
                Err(error) => Message::Failed(error),
            };
            if hand_over(&mut gatherer) {
                // The receiver may be gone.
                let _ = send_full.send(end);
            }
        };
        let name = format!("read {}", path.display());
        let spawned = thread::Builder::new().name(name).spawn(work);
        spawned.map_err(WaveError::file(path, "start a thread to read"))?;
        Ok(Self {
            path: path.to_owned(),
            full,
            empty,
            batch: Batch::default(),
            lengths,
            step: 0,
            first: (0, 0),
            started: false,
            ended: false,
            unterminated: false,
            cut: None,
            reopen: None,
            odd: Vec::new(),
            notes: Vec::new(),
        })
    }

    /// Adds what is needed to read the file again from a place in its middle.
    pub(super) fn with_reopen(mut self, reopen: Arc<Reopen>) -> Self {
        self.reopen = Some(reopen);
        self
    }

    pub(super) fn reopen(&self) -> Option<Arc<Reopen>> {
        self.reopen.clone()
    }

    /// Goes to the next step and returns it; `None` at the end of the file.
    ///
    /// # Errors
    /// The error that the reader found after the steps that it has handed over.
    #[inline]
    pub(crate) fn next_step(&mut self) -> Result<Option<Step>, WaveError> {
        self.advance()?;
        Ok(self.step().copied())
    }

    /// Returns the current step; `None` before the first and at the end of the file.
    #[inline]
    pub(crate) fn step(&self) -> Option<&Step> {
        self.batch.steps.get(self.step)
    }

    /// Goes to the next step, or to the end of the file.
    ///
    /// # Errors
    /// As [`Feed::next_step`].
    #[inline]
    pub(crate) fn advance(&mut self) -> Result<(), WaveError> {
        if self.started
            && let Some(step) = self.batch.steps.get(self.step)
        {
            self.first = (step.end as usize, step.words_end as usize);
            self.step += 1;
        }
        self.started = true;
        while self.batch.steps.get(self.step).is_none() && !self.ended {
            self.next_batch()?;
        }
        Ok(())
    }

    fn next_batch(&mut self) -> Result<(), WaveError> {
        match self.full.recv() {
            Ok(Message::Batch(batch)) => {
                let used = std::mem::replace(&mut self.batch, batch);
                self.odd.append(&mut self.batch.odd);
                self.notes.append(&mut self.batch.notes);
                // The first batch, which never held anything, is one too many; so is one that the reader no longer
                // takes.
                let _ = self.empty.try_send(used);
                (self.step, self.first) = (0, (0, 0));
            }
            Ok(Message::Ended { unterminated, cut }) => {
                (self.ended, self.unterminated, self.cut) = (true, unterminated, cut);
            }
            Ok(Message::Failed(error)) => {
                self.ended = true;
                return Err(error);
            }
            // The thread ended without a message.
            Err(_) => {
                self.ended = true;
                return Err(WaveError::Damaged {
                    path: self.path.clone(),
                    place: format!("after byte {}", self.batch.bytes),
                    problem: "the file is damaged, or of a kind that cannot be read".to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Calls `each` with the changes of the current step: slot and words.
    #[inline]
    pub(crate) fn each_change(&self, mut each: impl FnMut(u32, &[u64])) {
        for (slot, changed) in self.changes() {
            each(slot, changed.words());
        }
    }

    /// Returns the changes of the current step.
    #[inline]
    pub(crate) fn changes(&self) -> Changes<'_> {
        let end = self
            .batch
            .steps
            .get(self.step)
            .map_or(self.first.0, |step| step.end as usize);
        self.batch.changes(self.first, end, &self.lengths)
    }

    /// Whether no signal but the clock changes twice from the current step on until the next edge, as far as that is known.
    pub(crate) fn is_simple_until_edge(&self) -> bool {
        let steps = self.batch.steps.get(self.step..).unwrap_or_default();
        for (at, step) in steps.iter().enumerate() {
            if at > 0 && step.edge {
                return true;
            }
            if step.again {
                return false;
            }
        }
        false
    }

    /// Returns the next steps, as far as they have been handed over, as long as each is an edge and nothing changes from the current
    /// step up to it.
    pub(crate) fn quiet_edges(&self) -> &[Step] {
        let Some([current, next @ ..]) = self.batch.steps.get(self.step..) else {
            return &[];
        };
        let nothing = self.first.0 as u32;
        if current.end != nothing || current.off {
            return &[];
        }
        let mut count = 0;
        for step in next {
            if !step.edge || step.off {
                break;
            }
            count += 1;
            // What changes at an edge is sampled at the next one.
            if step.end != nothing {
                break;
            }
        }
        &next[..count]
    }

    /// Goes on by so many steps, up to which nothing changes.
    pub(crate) fn skip(&mut self, steps: usize) {
        self.step += steps;
    }

    /// Whether a change of the current step has a state beside its value.
    #[inline]
    pub(crate) fn has_states(&self) -> bool {
        !self.batch.states.is_empty()
    }

    /// Returns the state beside the value of the current step's change with this number; 0 if there is none.
    pub(crate) fn state(&self, change: usize) -> u64 {
        self.batch.state(self.first.0 + change)
    }

    /// Returns the slots that got a value of another kind than declared, so far.
    pub(crate) fn odd(&self) -> &[u32] {
        &self.odd
    }

    /// Returns what is unusual in the file, so far.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Takes over what was found in the file by the feed that this one continues.
    pub(crate) fn continue_from(&mut self, before: Self) {
        self.odd.splice(..0, before.odd);
        self.notes.splice(..0, before.notes);
    }

    /// Returns the number of bytes of the file that were read so far.
    pub(crate) fn bytes(&self) -> u64 {
        self.batch.bytes
    }

    /// Returns the number of bytes after which the file was cut off, once that has been found.
    pub(crate) fn cut(&self) -> Option<u64> {
        self.cut
    }

    /// Returns the error of a file that has ended while another continues; only a file whose last line is cut has
    /// one.
    pub(crate) fn cut_off(&self) -> Result<(), WaveError> {
        if self.unterminated {
            let inside = "before the other, in a line without line break";
            return Err(truncated(&self.path, self.batch.bytes.saturating_sub(1), inside));
        }
        Ok(())
    }
}
