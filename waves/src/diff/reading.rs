//! Reads a file again, as a comparison has read it: with the vectors that were put together, and up to the same end.

use std::collections::BTreeSet;
use std::path::Path;

use super::parts::{Derived, PartOf, parts_by_slot};
use crate::WaveError;
use crate::reader::{Declarations, Feed, FileEnd, Kind, Named, Values, Wave};

/// How a comparison has read a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reading {
    /// Slots that hold values of any kind.
    pub(super) any: BTreeSet<u32>,
    /// Slots that are made of bits of others, and their names.
    pub(super) derived: Vec<Derived>,
    pub(super) names: Vec<(String, u32)>,
}

/// A file that is read again.
pub(crate) struct Reread {
    pub(crate) declarations: Declarations,
    feed: Feed,
    pub(crate) values: Values,
    parts: Vec<Vec<PartOf>>,
    /// Slots that changed in the current step, each once.
    pub(crate) changed: Vec<u32>,
}

impl Reading {
    /// Opens the file. `up_to_last_time` tells that it is cut off, and was compared up to its last complete time.
    pub(crate) fn open(&self, path: &Path, up_to_last_time: bool) -> Result<Reread, WaveError> {
        let mut wave = Wave::open(path)?;
        wave.hold_any(&self.any);
        let derived = self.derived.iter();
        wave.declarations
            .kinds
            .extend(derived.map(|derived| Kind::Bits(derived.width)));
        let names = self.names.iter().map(|(name, slot)| Named {
            path: name.clone(),
            slot: *slot,
            part: None,
        });
        wave.declarations.names.extend(names);
        let file_end = match up_to_last_time {
            true => FileEnd::UpToLastTime,
            false => FileEnd::AsFarAsPossible,
        };
        let (declarations, feed) = wave.play(None, file_end)?;
        Ok(Reread {
            values: Values::new(&declarations.kinds),
            parts: parts_by_slot(self.derived.iter(), declarations.kinds.len()),
            declarations,
            feed,
            changed: Vec::new(),
        })
    }
}

impl Reread {
    /// Goes to the next step; returns its time in the file's unit, and `None` at the end of the file.
    pub(crate) fn next_time(&mut self) -> Result<Option<u64>, WaveError> {
        Ok(self.feed.next_step()?.map(|step| step.time))
    }

    /// Takes in the changes of the current step.
    pub(crate) fn take_in(&mut self) {
        self.changed.clear();
        let Self {
            feed,
            values,
            parts,
            changed,
            ..
        } = self;
        let mut wholes = Vec::new();
        feed.each_change(|slot, words| {
            if values.set(slot, words) || values.kind(slot) == Kind::Event {
                changed.push(slot);
                for part in parts.get(slot as usize).into_iter().flatten() {
                    part.copy(values);
                    wholes.push(part.whole);
                }
            }
        });
        changed.append(&mut wholes);
        changed.sort_unstable();
        changed.dedup();
    }
}
