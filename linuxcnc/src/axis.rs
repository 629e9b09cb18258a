//! The shaper of an axis between two positions of a controller: floating point in, integers of the hardware, floating
//! point out.
//!
//! ```text
//! command · lsb_per_unit ─► nearest word ─► MotionShaper of the model ─► word / lsb_per_unit
//! ```
//!
//! [`Axis::update`] is called by the servo thread: it allocates nothing, frees nothing, waits for nothing and cannot
//! panic on any input.

use posicast_blocks::shaper::{MotionShaper, swap_how, wrap};
use posicast_blocks::shaper_tables::{AxisShaperTables, ShaperTablesError};
use posicast_taps::TapTable;
use std::sync::Arc;

/// The shaper of an axis.
pub(crate) struct Axis {
    shaper: MotionShaper,
    tables: Vec<Arc<TapTable>>,
    /// The table in use, or to which a handover leads.
    table: usize,
    lsb_per_unit: f64,
    word_bits: u32,
    modulo: bool,
    /// The last command that was a number, in words.
    word: i64,
    /// Whether the previous command was shaped.
    shapes: bool,
}

/// Result of an axis for a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shaped {
    /// The shaped position, in the controller's unit.
    pub(crate) position: f64,
    /// The shaper's input word.
    pub(crate) word_in: i32,
    /// The shaper's output word.
    pub(crate) word_out: i32,
    /// The table in use, or to which a handover leads.
    pub(crate) table: u32,
    /// Whether a handover is under way; the next swap waits for its end.
    pub(crate) changes: bool,
    /// Whether the command was outside the range of its word and was clamped, or was not a number and the last one was
    /// held.
    pub(crate) clamped: bool,
}

impl Axis {
    /// An axis with its first table.
    ///
    /// # Errors
    /// [`ShaperTablesError`] for tables that no shaper holds.
    pub(crate) fn new(tables: &AxisShaperTables) -> Result<Self, ShaperTablesError> {
        let (config, all) = tables.shaper()?;
        let shaper = MotionShaper::new(&config);
        // The shaper's own table is kept, so that no swap frees it.
        let others = all.into_iter().skip(1).map(Arc::new);
        Ok(Self {
            tables: std::iter::once(Arc::clone(shaper.active())).chain(others).collect(),
            shaper,
            table: 0,
            lsb_per_unit: tables.lsb_per_unit,
            word_bits: tables.word_bits,
            modulo: tables.modulo,
            word: 0,
            shapes: false,
        })
    }

    /// Takes the command of a period. With `enable` low the output equals the command, and the history restarts from
    /// it. A `table` that does not exist changes nothing.
    pub(crate) fn update(&mut self, command: f64, table: u32, enable: bool) -> Shaped {
        let clamped = self.take(command);
        if !enable || !self.shapes {
            self.shaper.start([self.word, 0, 0]);
        }
        self.shapes = enable;
        let wanted = table as usize;
        if wanted != self.table && !self.shaper.changes() {
            let swapped = self
                .tables
                .get(wanted)
                .map(|table| self.shaper.swap_shared(table, swap_how::HANDOVER));
            if let Some(Ok(())) = swapped {
                self.table = wanted;
            }
        }
        let [shaped, ..] = self.shaper.push([self.word, 0, 0]);
        let (word_in, unwrapped) = if self.modulo {
            let turned = wrap(self.word, self.word_bits);
            (turned, self.word.wrapping_add(wrap(shaped - turned, self.word_bits)))
        } else {
            (self.word, shaped)
        };
        Shaped {
            position: unwrapped as f64 / self.lsb_per_unit,
            word_in: word_in as i32,
            word_out: shaped as i32,
            table: self.table as u32,
            changes: self.shaper.changes(),
            clamped,
        }
    }

    /// Converts the command to a word; returns whether it was clamped, or held because the command was not a number.
    fn take(&mut self, command: f64) -> bool {
        let words = (command * self.lsb_per_unit).round();
        if words.is_nan() {
            return true;
        }
        // A cast of a number that is too large gives the largest.
        let word = words as i64;
        let largest = if self.modulo {
            1 << 62
        } else {
            (1 << (self.word_bits - 1)) - 1
        };
        self.word = word.clamp(-largest - 1, largest);
        self.word != word
    }
}
