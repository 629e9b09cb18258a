//! Position capture: an edge of a line, a touch probe for example, takes the positions of up to four axes in one clock,
//! with a time stamp, into a memory of 16 entries.
//!
//! The datasheet is `docs/capture.md`; the hardware is compared with this reference model.
//!
//! - `level` follows the line once it has had a new level for `filter_clocks` clocks in a row. The first level after a
//!   reset is no edge.
//! - The positions, the stamp and all settings are those of the first clock in which `level` is the new one:
//!   [`LATENCY_CLOCKS`] + `filter_clocks` after the clock in which the line changed.
//! - `take` and `clear` come before an edge of the same clock: it finds the place that they have made.
//! - A full memory keeps its entries, and drops the new one.
//!
//! ```text
//! filter_clocks = 2
//! clock         0   1   2   3   4   5   6
//! line         _/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! level        _________________/‾‾‾‾‾‾‾‾‾‾      the positions of clock 4 are captured
//! captured     _____________________/‾‾‾\__
//! entry_valid  _________________________/‾‾
//! ```
//!
//! ```
//! use posicast_blocks::capture::{Capture, Inputs, LATENCY_CLOCKS};
//!
//! // An axis moves a count per clock, and the probe touches at 100.
//! let mut capture = Capture::new();
//! let filter_clocks = 8;
//! for position in 0..200 {
//!     let count = [position, 0, 0, 0];
//!     let (line, enable, rises) = (position >= 100, true, true);
//!     capture.step(&Inputs { line, filter_clocks, enable, rises, count, ..Inputs::default() });
//! }
//! let shown = capture.outputs();
//! assert!(shown.entry_valid && shown.entry_rising);
//! assert_eq!(shown.entry_count[0], 100 + LATENCY_CLOCKS as i32 + 8);
//! ```

mod line;
mod ports;

pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use super::{Moore, clocked_block, quiet_at_rest, show_each};
use line::CaptureLine;

/// Number of axes.
pub const AXES: usize = 4;
/// Number of entries in the memory.
pub const ENTRIES: usize = 16;
/// Clocks from a change of the line to the captured positions, in addition to `filter_clocks`: those of the
/// synchroniser.
pub const LATENCY_CLOCKS: u32 = 2;

/// What an edge leaves in the memory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CaptureEntry {
    /// Positions of the axes in counts.
    pub count: [i32; AXES],
    /// Time of the edge.
    pub stamp: u32,
    /// Whether the edge rises.
    pub rising: bool,
}

/// The cycle-accurate model of the position capture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Capture {
    line: CaptureLine,
    /// The entries, the oldest first.
    memory: [CaptureEntry; ENTRIES],
    entries: usize,
    entry_valid: bool,
    captured: bool,
    edges: u32,
    overflowed: bool,
    outside: bool,
}

impl Capture {
    /// A capture after power-up.
    pub fn new() -> Self {
        Self::default()
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let entry = if self.entry_valid {
            self.memory[0]
        } else {
            CaptureEntry::default()
        };
        Outputs {
            level: self.line.level,
            level_known: self.line.known,
            captured: self.captured,
            entries: self.entries as u8,
            edges: self.edges,
            entry_valid: self.entry_valid,
            entry_count: entry.count,
            entry_stamp: entry.stamp,
            entry_rising: entry.rising,
            overflowed: self.overflowed,
            outside: self.outside,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        if inputs.rst {
            *self = Self::new();
            return shown;
        }
        if inputs.clear {
            (self.entries, self.edges) = (0, 0);
        } else if inputs.take && self.entry_valid {
            self.memory.copy_within(1.., 0);
            self.entries -= 1;
        }
        // An entry that is written now is in the memory's output two clocks later.
        self.entry_valid = self.entries > 0;

        let edge = self.line.edge().filter(|rising| inputs.wants(*rising));
        let offered = edge.filter(|_| inputs.is_inside());
        let captured = offered.filter(|_| self.entries < ENTRIES);
        if let Some(rising) = captured {
            let (count, stamp) = (inputs.count, inputs.stamp);
            self.memory[self.entries] = CaptureEntry { count, stamp, rising };
            self.entries += 1;
        }
        self.captured = captured.is_some();
        self.edges = self.edges.wrapping_add(edge.is_some().into());
        self.overflowed = (self.overflowed && !inputs.clear_flags) || (offered.is_some() && captured.is_none());
        self.outside = (self.outside && !inputs.clear_flags) || (edge.is_some() && offered.is_none());

        self.line.clock(inputs.line, inputs.filter_clocks);
        shown
    }
}

clocked_block!(Capture, "the position capture");

impl Moore for Capture {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            Capture::step(next, &Inputs::from_raw(raw));
        })
    }

    /// Positions and time are taken at an edge.
    fn ignores(&self, input: &str) -> bool {
        input == "stamp" || input.starts_with("count_")
    }
}
