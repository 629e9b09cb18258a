//! `[capture]`: a line whose edges take the positions of all axes, such as that of a touch probe.

use super::ClockSection;
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;

/// Range of the filter's time.
const FILTER_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");

/// Edge that takes the positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaptureEdge {
    /// From low to high.
    Rising,
    /// From high to low.
    Falling,
    /// Either.
    Both,
}

impl CaptureEdge {
    /// Every edge with its name in the machine file.
    pub const ALL: [(Self, &str); 3] = [
        (Self::Rising, "rising"),
        (Self::Falling, "falling"),
        (Self::Both, "both"),
    ];
}

/// `[capture]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CaptureSection {
    /// Edge that takes the positions. Default: rising.
    pub edge: CaptureEdge,
    /// Time for which the line must have a new level, s. Default 0: one clock.
    pub filter_s: f64,
}

impl CaptureSection {
    /// Clocks for which the line must have a new level, at least one.
    pub fn filter_clocks(&self, clock: &ClockSection) -> u16 {
        u16::try_from(clock.clocks_up(self.filter_s).max(1)).unwrap_or(u16::MAX)
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "edge",
        Values::Word(|| CaptureEdge::ALL.map(|(_, name)| name).to_vec()),
        "Edge that takes the positions: `falling` for a probe that closes to ground when it touches.",
    )
    .default(Default::Word("rising")),
    Key::or_zero(
        "filter_s",
        FILTER_S,
        "How long the line must have its new level, rounded up to clocks. The positions are those of then.",
    )
    .rule("at most 65,535 clocks"),
];

/// Reads the table.
pub(super) fn read(table: &Table<'_, '_>, clock: Option<ClockSection>) -> CaptureSection {
    table.allow(KEYS);
    let edge = table.word("edge", &CaptureEdge::ALL);
    let filter_s = table.number("filter_s", FILTER_S).unwrap_or(0.0);
    let remedy = "shorten it: the positions are as late as the filter is long";
    table.at_most_clocks(("filter_s", filter_s), clock, u16::MAX.into(), remedy);
    CaptureSection {
        edge: edge.unwrap_or(CaptureEdge::Rising),
        filter_s,
    }
}
