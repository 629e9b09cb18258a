//! Reads a file again, as a comparison has read it: with the vectors that were put together, and up to the same end.

use std::collections::{BTreeSet, HashMap};
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
    /// Number of slots of the file, and the names of those that are used above: a comparison of some signals gives other
    /// numbers to their slots.
    pub(super) slots: u32,
    pub(super) declared: Vec<(String, u32)>,
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
        let slot_now = self.slots_now(&wave.declarations);
        wave.hold_any(&self.any.iter().map(|slot| slot_now(*slot)).collect());
        let mut derived = self.derived.clone();
        for derived in &mut derived {
            derived.slot = slot_now(derived.slot);
            for run in &mut derived.runs {
                run.source = slot_now(run.source);
            }
        }
        let names: Vec<Named> = self
            .names
            .iter()
            .map(|(name, slot)| Named {
                path: name.clone(),
                slot: slot_now(*slot),
                part: None,
            })
            .collect();
        let kinds = &mut wave.declarations.kinds;
        kinds.extend(derived.iter().map(|derived| Kind::Bits(derived.width)));
        wave.declarations.names.extend(names);
        let file_end = if up_to_last_time {
            FileEnd::UpToLastTime
        } else {
            FileEnd::AsFarAsPossible
        };
        let (declarations, feed) = wave.play(None, file_end)?;
        Ok(Reread {
            values: Values::new(&declarations.kinds),
            parts: parts_by_slot(derived.iter(), declarations.kinds.len()),
            declarations,
            feed,
            changed: Vec::new(),
        })
    }
}

impl Reading {
    /// Returns the number that a slot of the comparison has now.
    fn slots_now(&self, declarations: &Declarations) -> impl Fn(u32) -> u32 + use<> {
        let of_file = self.slots;
        let count = declarations.kinds.len() as u32;
        let names = declarations.names.iter().filter(|_| !self.declared.is_empty());
        let now: HashMap<&str, u32> = names.map(|named| (named.path.as_str(), named.slot)).collect();
        let slots: HashMap<u32, u32> = self
            .declared
            .iter()
            .filter_map(|(name, slot)| Some((*slot, *now.get(name.as_str())?)))
            .collect();
        move |slot| match slot.checked_sub(of_file) {
            Some(derived) => count + derived,
            None => slots.get(&slot).copied().unwrap_or(slot),
        }
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
