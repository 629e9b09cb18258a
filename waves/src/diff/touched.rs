//! The pairs that a change affects, and those that were affected.

use super::cells::Cells;

/// Pairs to compare again.
#[derive(Debug, Default)]
pub(super) struct Touched {
    pub(super) listed: Listed,
    /// Whether each pair waits for a delayed value to arrive.
    pub(super) waiting: Vec<bool>,
    /// The pairs that are compared word by word.
    pub(super) cells: Cells,
    /// The states beside the values.
    pub(super) states: States,
}

impl Touched {
    /// Creates a set of this many pairs, all to be compared.
    pub(super) fn new(pairs: usize) -> Self {
        Self {
            listed: Listed {
                flags: vec![true; pairs],
                list: (0..pairs as u32).collect(),
            },
            waiting: vec![false; pairs],
            cells: Cells::default(),
            states: States {
                changed: Listed {
                    flags: vec![false; pairs],
                    list: Vec::new(),
                },
                ..States::default()
            },
        }
    }

    /// Leaves the pairs that are cells to `cells`, which compares them together.
    pub(super) fn leave_to(&mut self, cells: Cells, is_cell: impl Fn(u32) -> bool) {
        self.listed.list.retain(|pair| !is_cell(*pair));
        self.cells = cells;
    }

    /// Calls `each` for the pairs affected since, and clears the set.
    pub(super) fn drain(&mut self, mut each: impl FnMut(u32)) {
        let Listed { flags, list } = &mut self.listed;
        for pair in list.drain(..) {
            flags[pair as usize] = false;
            each(pair);
        }
    }
}

/// States that a file has beside its values, such as VHDL's weak ones, which are compared as 0, 1, `x` and `z`. Most files
/// have none.
#[derive(Debug, Default)]
pub(super) struct States {
    /// State of each slot, for both files; empty as long as there is none.
    of: [Vec<u64>; 2],
    /// Number of slots that have one now.
    live: [usize; 2],
    /// Pairs whose state or value has changed on one side.
    changed: Listed,
}

impl States {
    /// Whether any slot of any file has a state.
    #[inline]
    pub(super) fn any(&self) -> bool {
        self.live != [0; 2]
    }

    /// Sets the state of a slot of a file that has `slots` slots. Returns the state before.
    pub(super) fn set(&mut self, side: usize, slot: u32, state: u64, slots: usize) -> u64 {
        let of = &mut self.of[side];
        if of.is_empty() {
            if state == 0 {
                return 0;
            }
            of.resize(slots, 0);
        }
        let before = std::mem::replace(&mut of[slot as usize], state);
        self.live[side] = self.live[side] + usize::from(state != 0) - usize::from(before != 0);
        before
    }

    /// Sets the state of a slot of both files.
    pub(super) fn set_both(&mut self, slot: u32, state: u64, slots: usize) {
        if state != 0 || self.any() {
            for side in 0..2 {
                self.set(side, slot, state, slots);
            }
        }
    }

    pub(super) fn get(&self, side: usize, slot: u32) -> u64 {
        self.of[side].get(slot as usize).copied().unwrap_or(0)
    }

    /// Notes that a pair is to be looked at.
    pub(super) fn touch(&mut self, pair: u32) {
        self.changed.touch(pair);
    }

    /// Takes the pairs to be looked at.
    pub(super) fn take(&mut self) -> Vec<u32> {
        let list = std::mem::take(&mut self.changed.list);
        for pair in &list {
            self.changed.flags[*pair as usize] = false;
        }
        list
    }
}

/// The pairs that were affected since the last sample, each once.
#[derive(Debug, Default)]
pub(super) struct Listed {
    flags: Vec<bool>,
    list: Vec<u32>,
}

impl Listed {
    #[inline]
    pub(super) fn touch(&mut self, pair: u32) {
        if !std::mem::replace(&mut self.flags[pair as usize], true) {
            self.list.push(pair);
        }
    }
}

/// Lists of numbers, one per slot, in one array.
#[derive(Debug, Default)]
pub(super) struct Lists {
    starts: Vec<u32>,
    numbers: Vec<u32>,
}

impl Lists {
    pub(super) fn new(lists: usize, entries: &[(u32, u32)]) -> Self {
        let mut sorted = entries.to_vec();
        sorted.sort_unstable();
        let mut starts = vec![0u32; lists + 1];
        for (list, _) in &sorted {
            starts[*list as usize + 1] += 1;
        }
        for at in 0..lists {
            starts[at + 1] += starts[at];
        }
        let numbers = sorted.into_iter().map(|(_, number)| number).collect();
        Self { starts, numbers }
    }

    #[inline]
    pub(super) fn get(&self, list: u32) -> &[u32] {
        let at = list as usize;
        &self.numbers[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
}
