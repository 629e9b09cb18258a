//! `[axis.encoder]`: the pulse counter that reads the axis's position.

use super::key::{Default, Key, Values};
use super::table::Table;
use posicast_blocks::pulse_counter::FILTER_CLOCKS_MAX;

/// `[axis.encoder]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoder {
    /// Pulses of up to this many clocks are ignored: 0 (the default, no filter) to [`FILTER_CLOCKS_MAX`]. Without a
    /// filter every level counts that two flip-flops see.
    pub filter_clocks: u32,
    /// Whether the encoder has an index line. Default: false.
    pub index: bool,
    /// Whether the lines count down where the drive's positive command moves up. Default: false.
    pub invert: bool,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "filter_clocks",
        Values::Integer(0, FILTER_CLOCKS_MAX),
        "Longest ignored pulse on every line. 0: no filter.",
    )
    .default(Default::Integer(0)),
    Key::switch("index", "The simulated encoder has an index line."),
    Key::switch(
        "invert",
        "The lines count down where a positive command moves the axis up.",
    ),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>) -> Option<Encoder> {
    table.allow(KEYS);
    let filter_clocks = if table.has("filter_clocks") {
        table.integer("filter_clocks", 0, FILTER_CLOCKS_MAX)?
    } else {
        0
    };
    Some(Encoder {
        filter_clocks,
        index: table.boolean("index").unwrap_or(false),
        invert: table.boolean("invert").unwrap_or(false),
    })
}
