//! Reads of a stage beside its driver: settings and taps at any time, and flags in the clocks in which they are cleared.

use posicast_blocks::registers::RegisterMap;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::driver::Driver;
use crate::registers::stimuli::{ADDRESS, BYTE_ENABLE, READ, WRITE, WRITE_DATA};
use crate::stimuli::table::pick;

/// Clocks after the write of `CLEAR_FAULTS` in which flags go.
const AFTER_A_CLEAR_CLOCKS: u32 = 5;

/// Reads back settings or taps, from any bank at any time, in clocks in which the bus is otherwise idle.
///
/// It uses a generator of its own, so that it does not change what else a run reaches.
#[derive(Debug, Clone)]
pub(crate) struct ReadBack {
    rng: Xoshiro256PlusPlus,
    /// Of each axis that has them, its index, and the offsets of address, command and word.
    words: Vec<(usize, [u64; 3])>,
    /// Mask of the random address bits: bank and written rows.
    places: u64,
}

impl ReadBack {
    pub(crate) fn settings(map: &RegisterMap, axes: &[String], seed: u64) -> Self {
        let names = ["setting_address", "setting_read", "setting_loaded"];
        Self::new(map, axes, names, 0x30f, seed.rotate_left(32))
    }

    pub(crate) fn taps(map: &RegisterMap, axes: &[String], seed: u64) -> Self {
        let names = ["tap_address", "tap_read", "tap_loaded"];
        Self::new(map, axes, names, 0x307, seed.rotate_left(16))
    }

    fn new(map: &RegisterMap, axes: &[String], names: [&str; 3], places: u64, seed: u64) -> Self {
        let of_axis = |(index, axis): (usize, &String)| {
            let offset = |name| map.register(&format!("{axis}_{name}")).map(|found| found.offset.into());
            let [address, read, loaded] = names.map(offset);
            Some((index, [address?, read?, loaded?]))
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            words: axes.iter().enumerate().filter_map(of_axis).collect(),
            places,
        }
    }

    /// Returns the registers that only this generator uses.
    pub(crate) fn own(&self) -> Vec<u64> {
        self.words.iter().flat_map(|(_, [_, own @ ..])| *own).collect()
    }

    pub(crate) fn fill(&mut self, driver: &Driver, wild: bool, inputs: &mut [u64]) {
        if self.words.is_empty() {
            return;
        }
        let (axis, words) = self.words[self.rng.random_range(0..self.words.len())];
        let [pace, kind, data] = [50, 3, 1 << 10].map(|end| self.rng.random_range(0..end));
        let in_use = inputs[READ] != 0 || inputs[WRITE] != 0 || driver.writes(axis);
        // Random traffic writes settings and taps at the current address, which is not changed then.
        let moves_another = wild && kind == 0;
        if pace != 0 || in_use || moves_another {
            return;
        }
        inputs[ADDRESS] = words[kind];
        inputs[WRITE_DATA] = data as u64 & self.places;
        inputs[BYTE_ENABLE] = 0xf;
        let reads = kind == 2;
        (inputs[READ], inputs[WRITE]) = (reads.into(), (!reads).into());
    }
}

/// Reads what `CLEAR_FAULTS` clears in each of the clocks after it. Only these reads reveal a flag that is cleared a clock too early.
#[derive(Debug, Clone)]
pub(crate) struct Clears {
    /// Per axis, the offset of the command, then those of the words with flags.
    axes: Vec<[u64; 4]>,
    rng: Xoshiro256PlusPlus,
    word: u64,
    left: u32,
}

impl Clears {
    pub(crate) fn new(map: &RegisterMap, axes: &[String], seed: u64) -> Self {
        let names = ["clear_faults", "flags", "status", "saturations"];
        let of_axis = |axis: &String| {
            names.map(|name| {
                map.register(&format!("{axis}_{name}"))
                    .map_or(0, |found| found.offset.into())
            })
        };
        Self {
            axes: axes.iter().map(of_axis).collect(),
            rng: Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(48)),
            word: 0,
            left: 0,
        }
    }

    pub(crate) fn wrote(&mut self, offset: u64) {
        let Some([_, words @ ..]) = self.axes.iter().find(|[command, ..]| *command == offset) else {
            return;
        };
        (self.word, self.left) = (*pick(&mut self.rng, words), AFTER_A_CLEAR_CLOCKS);
    }

    /// The word to read in this clock, if there is one.
    pub(crate) fn word(&mut self) -> Option<u64> {
        self.left = self.left.checked_sub(1)?;
        Some(self.word)
    }
}
