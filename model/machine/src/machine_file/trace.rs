//! `[axis.trace]`: the memory that records signals of the axis's loop.

use super::key::{Key, Values};
use super::table::Table;
use posicast_blocks::trace::SAMPLES;

/// `[axis.trace]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TraceSection {
    /// Words that the memory holds, 256, 512, 1024 or 2048: the rows of one signal; two or four share them.
    pub samples: u32,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[Key::new(
    "samples",
    Values::OneOf(&SAMPLES),
    "Words of the memory, shared by the recorded signals.",
)
.rule("1024 hold 1024 rows of one signal, 512 of two, 256 of four")
.required()];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>) -> Option<TraceSection> {
    let list = SAMPLES.map(|samples| samples.to_string()).join(", ");
    table.allow(KEYS);
    table.require("samples", list);
    let samples = table.one_of("samples", &SAMPLES)?;
    Some(TraceSection { samples })
}
