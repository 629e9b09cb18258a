//! The pairs that a change affects, and those that were affected.

use super::cells::Cells;

/// Pairs to compare again.
#[derive(Debug, Default)]
pub(super) struct Touched {
    pub(super) listed: Listed,
    /// Whether each pair waits for a delayed value to arrive.
    pub(super) waiting: Vec<bool>,
    /// The pairs that are simpler than that.
    pub(super) cells: Cells,
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
