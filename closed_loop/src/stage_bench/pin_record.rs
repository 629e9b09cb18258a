//! Records pins in every clock, and changes inputs at clocks that are known before.
//!
//! A record is a list of changes. What is derived from it, such as the count of an encoder's edges, owes nothing to the
//! stage.

use posicast_machine::plant::axis::AxisPlant;

use super::StageBench;
use posicast_testbench::Error;

/// Levels of the recorded pins from a clock on, a bit each, in the order in which they were named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PinChange {
    /// First clock with these levels.
    pub clock: u64,
    /// Bit k: the level of pin k.
    pub levels: u32,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    Input(usize),
    Output(usize),
}

/// The pins that are recorded, and their changes.
#[derive(Debug, Clone, Default)]
pub(super) struct PinRecord {
    places: Vec<Place>,
    changes: Vec<PinChange>,
    /// Changes of each plant's count: the clock and the count from then on.
    counts: Vec<Vec<(u64, i64)>>,
}

impl PinRecord {
    /// Takes the levels of a clock, with the plants as they are in it.
    pub(super) fn pass(&mut self, now: u64, inputs: &[u64], outputs: &[u64], plants: &[AxisPlant]) {
        if self.places.is_empty() {
            return;
        }
        let level = |place: &Place| match *place {
            Place::Input(at) => inputs[at] & 1,
            Place::Output(at) => outputs[at] & 1,
        };
        let bits = self.places.iter().enumerate();
        let levels = bits.fold(0, |levels, (bit, place)| levels | (level(place) as u32) << bit);
        if self.changes.last().is_none_or(|last| last.levels != levels) {
            self.changes.push(PinChange { clock: now, levels });
        }
        for (counts, plant) in self.counts.iter_mut().zip(plants) {
            let count = plant.count();
            if counts.last().is_none_or(|last| last.1 != count) {
                counts.push((now, count));
            }
        }
    }
}

/// A level that an input gets at a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scheduled {
    clock: u64,
    input: usize,
    level: u64,
}

impl StageBench {
    /// Records these inputs and outputs, at most 32 of one bit, and each plant's count, from the next clock on. An earlier
    /// record is dropped.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such pin.
    pub fn record_pins(&mut self, pins: &[String]) -> Result<(), Error> {
        let place = |pin: &String| {
            let input = self.input_names.iter().position(|name| name == pin).map(Place::Input);
            let output = || self.output_names.iter().position(|name| name == pin).map(Place::Output);
            let found = input.or_else(output);
            found.ok_or_else(|| Error::Unlike(format!("the stage has no pin `{pin}`")))
        };
        self.pins = PinRecord {
            places: pins.iter().map(place).collect::<Result<_, _>>()?,
            changes: Vec::new(),
            counts: vec![Vec::new(); self.plants.len()],
        };
        Ok(())
    }

    /// The recorded changes, the first of them with the levels at the start.
    pub fn recorded_pins(&self) -> &[PinChange] {
        &self.pins.changes
    }

    /// The recorded changes of a plant's count: the clock, and the count from then on.
    pub fn recorded_counts(&self, axis: usize) -> &[(u64, i64)] {
        self.pins.counts.get(axis).map_or(&[], Vec::as_slice)
    }

    /// Drives an input from this clock on, or from the next one if it is over.
    ///
    /// # Errors
    /// [`Error::Unlike`] if there is no such input.
    pub fn schedule(&mut self, input: &str, clock: u64, level: u64) -> Result<(), Error> {
        let found = self.input_names.iter().position(|name| name == input);
        let input = found.ok_or_else(|| Error::Unlike(format!("the stage has no input `{input}`")))?;
        let after = self.scheduled.partition_point(|other| other.clock <= clock);
        self.scheduled.insert(after, Scheduled { clock, input, level });
        Ok(())
    }

    /// Forgets what is scheduled for later clocks.
    pub fn drop_schedule(&mut self) {
        self.scheduled.clear();
    }

    /// Drives what is due, and returns the number of clocks to the next scheduled change; at least one.
    pub(super) fn drive_scheduled(&mut self) -> u64 {
        let due = self.scheduled.partition_point(|change| change.clock <= self.now);
        for change in self.scheduled.drain(..due) {
            self.inputs[change.input] = change.level;
        }
        self.scheduled.first().map_or(u64::MAX, |next| next.clock - self.now)
    }
}
