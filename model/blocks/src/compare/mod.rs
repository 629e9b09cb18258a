//! Position compare: a pulse when a count passes a position, for a line camera, a laser or a probe.
//!
//! The datasheet is `docs/compare.md`; the hardware is compared with this reference model.
//!
//! - A position `p` is the edge between the counts `p − 1` and `p`: it is passed upward when the count becomes `p`, and
//!   downward when it leaves `p` for `p − 1`.
//! - The positions are `first + k · spacing` for `k` below `positions`, or those of a list in memory, which increase.
//! - The block knows the nearest position on either side of the count: `below ≤ count < above`. A count that changes by
//!   one passes one of them or none, so nothing is missed or doubled at up to a count per clock.
//! - After `arm`, and after a count that changed by more than one, it steps to these two positions, a step in a clock (in
//!   a list, in three); `ready` is low meanwhile and no position is passed.
//!
//! ```text
//! clock        0     1     2     3     4
//! count       <p−1 >< p  >------------------      passes p upward
//! passed      ____________/‾‾‾‾‾\___________      in clock 3, counted
//! pulse       ____________/‾‾‾‾‾‾‾‾‾‾‾\_____      pulse_clocks = 2
//! ```
//!
//! ```
//! use posicast_blocks::compare::{Compare, Inputs};
//!
//! // A pulse every 10 counts from 100 to 130, going up.
//! let mut compare = Compare::new(1);
//! let settings = Inputs { first: 100, spacing: 10, positions: 4, rises: true, pulse_clocks: 3, ..Inputs::default() };
//! compare.step(&Inputs { arm: true, ..settings });
//! for count in 0..200 {
//!     compare.step(&Inputs { count, ..settings });
//! }
//! assert_eq!(compare.outputs().passes, 4);
//! ```

mod ports;

pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use crate::shaper::Arbitrary;
use crate::{FOREVER, Moore, clocked_block, show_each};

/// Number of positions in the list.
pub const LIST_POSITIONS: usize = 256;
/// Least distance of two positions of the list in counts; the next one is read from memory meanwhile.
pub const LEAST_DISTANCE_COUNTS: i64 = 4;
/// Clocks from a count at the input to `passed` and `pulse`.
pub const LATENCY_CLOCKS: u32 = 2;
/// Clocks of a step to the next position of the list.
pub const LIST_STEP_CLOCKS: u32 = 3;

/// Which position is being read from the list, and how far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Fetch {
    /// A position is being read.
    runs: bool,
    /// It is the one above the count.
    above: bool,
    /// The memory shows it.
    shown: bool,
}

/// Settings as `arm` took them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Settings {
    use_list: bool,
    rises: bool,
    falls: bool,
    spacing: i64,
    positions: u32,
    hysteresis: i64,
    pulse_clocks: u32,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Registers {
    /// Count of the clock before, and of the one before that.
    count: i32,
    earlier: i32,
    settings: Settings,
    /// Number of positions that are not above the count.
    index: u32,
    above: i64,
    above_known: bool,
    below: i64,
    below_known: bool,
    fetch: Fetch,
    /// Position of the last pulse, and whether the count is still near it.
    last: i32,
    near: bool,
    left_clocks: u32,
    shown: Outputs,
    newest_entry: i32,
}

/// The cycle-accurate model of the position compare.
#[derive(Debug, Clone)]
pub struct Compare {
    registers: Registers,
    list: Vec<i32>,
    /// Word that the memory shows.
    word: i32,
}

impl Compare {
    /// A block after power-up. `seed` determines the arbitrary contents of its memory, which no output ever shows.
    pub fn new(seed: u64) -> Self {
        let contents = Arbitrary::new(seed).take(LIST_POSITIONS);
        Self {
            registers: Registers::default(),
            list: contents.map(|word| word as i32).collect(),
            word: 0,
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.registers.shown
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        let before = self.registers;
        let read = self.list[before.read_address()];
        if inputs.rst {
            self.registers = Registers::default();
        } else {
            self.registers = before.next(inputs, self.word);
            if before.takes(inputs) {
                self.list[usize::from(before.shown.entries)] = inputs.entry;
            }
        }
        self.word = read;
        outputs
    }
}

clocked_block!(Compare, "the position compare");

impl Moore for Compare {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(raw) = <&[u64; INPUT_PORTS]>::try_from(inputs) else {
            return 0;
        };
        let (inputs, now) = (Inputs::from_raw(raw), self.registers);
        let commands = inputs.rst || inputs.arm || inputs.entry_write || inputs.entries_clear;
        if commands || self.list[now.read_address()] != self.word {
            return 0;
        }
        let next = now.next(&inputs, self.word);
        if next == now {
            return FOREVER;
        }
        let counted = Registers {
            left_clocks: now.left_clocks.saturating_sub(1),
            ..now
        };
        if next == counted {
            u64::from(counted.left_clocks)
        } else {
            0
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        self.registers.left_clocks = self.registers.left_clocks.saturating_sub(clocks as u32);
    }

    fn ignores(&self, input: &str) -> bool {
        let at_arm = [
            "use_list",
            "first",
            "spacing",
            "positions",
            "rises",
            "falls",
            "hysteresis",
            "pulse_clocks",
        ];
        input == "entry" || at_arm.contains(&input)
    }
}

impl Registers {
    /// Address of the position that is read.
    fn read_address(&self) -> usize {
        let below = self.index.wrapping_sub(1);
        (if self.fetch.above { self.index } else { below }) as usize % LIST_POSITIONS
    }

    /// Whether the list cannot be written.
    fn keeps_list(&self, inputs: &Inputs) -> bool {
        self.shown.armed || inputs.arm
    }

    /// Whether the entry at the inputs is appended.
    fn takes(&self, inputs: &Inputs) -> bool {
        let far = i64::from(inputs.entry) - i64::from(self.newest_entry) >= LEAST_DISTANCE_COUNTS;
        let follows = self.shown.entries == 0 || far;
        let has_room = usize::from(self.shown.entries) < LIST_POSITIONS;
        inputs.entry_write && !inputs.entries_clear && !self.keeps_list(inputs) && has_room && follows
    }

    fn next(&self, inputs: &Inputs, word: i32) -> Self {
        let mut next = *self;
        next.load(inputs, self.takes(inputs));
        next.earlier = self.count;
        next.count = inputs.count;
        if self.fetch.runs {
            next.fetch.shown = true;
            if self.fetch.shown {
                next.fetch = Fetch {
                    runs: false,
                    ..self.fetch
                };
                if self.fetch.above {
                    (next.above, next.above_known) = (word.into(), true);
                } else {
                    (next.below, next.below_known) = (word.into(), true);
                }
            }
        }
        let fires = self.pass(&mut next);
        next.pulse(fires, self);
        if inputs.arm {
            next.arm(inputs, self);
        }
        if inputs.disarm {
            (next.shown.armed, next.shown.ready) = (false, false);
        }
        next.shown.merged |= self.shown.merged && !inputs.clear_flags;
        next.shown.jumped |= self.shown.jumped && !inputs.clear_flags;
        next.shown.refused |= self.shown.refused && !inputs.clear_flags;
        next
    }

    /// The list; flags are those of this clock alone from here.
    fn load(&mut self, inputs: &Inputs, taken: bool) {
        let kept = self.keeps_list(inputs);
        let refused_write = inputs.entry_write && !inputs.entries_clear && !taken;
        let refused_clear = inputs.entries_clear && kept;
        self.shown.refused = refused_write || refused_clear;
        self.shown.merged = false;
        self.shown.jumped = false;
        if inputs.entries_clear && !kept {
            self.shown.entries = 0;
        }
        if taken {
            self.newest_entry = inputs.entry;
            self.shown.entries += 1;
        }
    }

    /// Steps to the positions beside the count. Returns the direction in which one was passed with a pulse.
    fn pass(&self, next: &mut Self) -> Option<bool> {
        let has_above = self.index != self.settings.positions && self.above_known && self.above <= i32::MAX.into();
        let has_below = self.index != 0 && self.below_known;
        let change = i64::from(self.count) - i64::from(self.earlier);
        let count = i64::from(self.count);
        let upward = self.shown.ready && change == 1 && has_above && count == self.above;
        let downward = self.shown.ready && change == -1 && has_below && count == self.below - 1;
        if self.shown.ready && change.abs() > 1 {
            next.shown.jumped = true;
            next.shown.ready = false;
        }
        let seeks = self.shown.armed && !self.shown.ready && !self.fetch.runs;
        if upward || (seeks && has_above && count >= self.above) {
            self.step_up(next);
        } else if downward || (seeks && has_below && count < self.below) {
            self.step_down(next);
        } else if seeks {
            next.shown.ready = true;
        }
        let from_last = count - i64::from(self.last);
        let distance = if from_last < 0 { -1 - from_last } else { from_last };
        let is_near = self.near && distance < self.settings.hysteresis;
        let same = (upward && from_last == 0) || (downward && from_last == -1);
        let wanted = (upward && self.settings.rises) || (downward && self.settings.falls);
        let fires = wanted && !(is_near && same);
        next.near = is_near;
        if fires {
            next.near = true;
            next.last = if upward { self.count } else { self.earlier };
        }
        fires.then_some(upward)
    }

    fn step_up(&self, next: &mut Self) {
        next.index = self.index.wrapping_add(1);
        (next.below, next.below_known) = (self.above, true);
        if self.settings.use_list {
            next.above_known = false;
            next.fetch(true);
        } else {
            next.above = self.above + self.settings.spacing;
        }
    }

    fn step_down(&self, next: &mut Self) {
        next.index = self.index.wrapping_sub(1);
        (next.above, next.above_known) = (self.below, true);
        if self.settings.use_list {
            next.below_known = false;
            next.fetch(false);
        } else {
            next.below = self.below - self.settings.spacing;
        }
    }

    fn fetch(&mut self, above: bool) {
        self.fetch = Fetch {
            runs: true,
            above,
            shown: false,
        };
    }

    fn pulse(&mut self, fires: Option<bool>, before: &Self) {
        self.shown.passed = fires.is_some();
        self.left_clocks = before.left_clocks.saturating_sub(1);
        self.shown.pulse = before.left_clocks > 1;
        if let Some(upward) = fires {
            self.shown.passed_upward = upward;
            self.shown.passes = before.shown.passes.wrapping_add(1);
            self.shown.merged = before.shown.pulse;
            self.left_clocks = before.settings.pulse_clocks;
            self.shown.pulse = true;
        }
    }

    fn arm(&mut self, inputs: &Inputs, before: &Self) {
        let entries = u32::from(before.shown.entries);
        self.settings = Settings {
            use_list: inputs.use_list,
            rises: inputs.rises,
            falls: inputs.falls,
            spacing: inputs.spacing.max(1).into(),
            positions: if inputs.use_list { entries } else { inputs.positions },
            hysteresis: inputs.hysteresis.into(),
            pulse_clocks: inputs.pulse_clocks.max(1),
        };
        (self.shown.armed, self.shown.ready) = (true, false);
        self.index = 0;
        (self.above, self.above_known) = (inputs.first.into(), !inputs.use_list);
        (self.below, self.below_known) = (i64::from(inputs.first) - i64::from(inputs.spacing.max(1)), true);
        self.near = false;
        self.shown.passes = 0;
        self.fetch(true);
        self.fetch.runs = inputs.use_list;
    }
}
