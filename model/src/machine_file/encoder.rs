//! `[axis.encoder]`: the pulse counter that reads the axis's position.

use super::table::Table;
use crate::rtl::pulse_counter::FILTER_CLOCKS_MAX;

/// `[axis.encoder]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Encoder {
    /// Pulses of up to so many clocks are ignored, 0 to [`FILTER_CLOCKS_MAX`]. Default 0: every level that two flip-flops
    /// see counts.
    pub filter_clocks: u32,
    /// Whether the encoder has an index line. Default: it has none.
    pub index: bool,
    /// Whether its lines count down where the drive's positive command moves up. Default: they count up.
    pub invert: bool,
}

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>) -> Option<Encoder> {
    table.allow(&["filter_clocks", "index", "invert"]);
    let filter_clocks = match table.has("filter_clocks") {
        true => table.integer("filter_clocks", 0, FILTER_CLOCKS_MAX)?,
        false => 0,
    };
    Some(Encoder {
        filter_clocks,
        index: table.boolean("index").unwrap_or(false),
        invert: table.boolean("invert").unwrap_or(false),
    })
}
