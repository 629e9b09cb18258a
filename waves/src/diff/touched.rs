//! Which pairs a change touches, and which were touched.

use super::cells::Cells;

/// Pairs to look at again.
#[derive(Debug, Default)]
pub(super) struct Touched {
    flags: Vec<bool>,
    list: Vec<u32>,
    /// Pairs that wait for a delayed value to arrive.
    pub(super) waiting: Vec<bool>,
    /// The pairs that are simpler than that.
    pub(super) cells: Cells,
}

impl Touched {
    /// So many pairs, all to be looked at.
    pub(super) fn new(pairs: usize) -> Self {
        Self {
            flags: vec![true; pairs],
            list: (0..pairs as u32).collect(),
            waiting: vec![false; pairs],
            cells: Cells::default(),
        }
    }

    #[inline]
    pub(super) fn touch(&mut self, pair: u32) {
        if !std::mem::replace(&mut self.flags[pair as usize], true) {
            self.list.push(pair);
        }
    }

    /// These pairs are cells: they are not looked at one by one.
    pub(super) fn leave_to(&mut self, cells: Cells, is_cell: impl Fn(u32) -> bool) {
        self.list.retain(|pair| !is_cell(*pair));
        self.cells = cells;
    }

    /// The pairs touched since, which are then untouched.
    pub(super) fn drain(&mut self, mut each: impl FnMut(u32)) {
        for pair in self.list.drain(..) {
            self.flags[pair as usize] = false;
            each(pair);
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
