//! `[capture]`: a line whose edges take the positions of all axes, such as that of a touch probe.

use super::ClockSection;
use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use posicast_shaper::unit::show_seconds;

/// Range of the filter's time.
const FILTER_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// Longest filter in clocks.
const MOST_FILTER_CLOCKS: f64 = u16::MAX as f64;

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
        let clocks = self.filter_s * clock.frequency_hz;
        // Decimals such as 1e-6 are not exact.
        (clocks * (1.0 - 1e-9)).ceil().clamp(1.0, MOST_FILTER_CLOCKS) as u16
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
    let word = table.choice("edge", &CaptureEdge::ALL.map(|(_, name)| name));
    let edge = CaptureEdge::ALL.into_iter().find(|(_, name)| Some(*name) == word);
    let filter_s = table.number("filter_s", FILTER_S).unwrap_or(0.0);
    let longest_s = clock.map(|clock| MOST_FILTER_CLOCKS / clock.frequency_hz);
    if let Some(longest_s) = longest_s.filter(|longest_s| filter_s > longest_s * (1.0 + 1e-9)) {
        let found = format!("filter_s = {}", table.quote("filter_s"));
        let allowed = format!("at most {}, {MOST_FILTER_CLOCKS} clocks", show_seconds(longest_s, 4));
        let remedy = "shorten it: the positions are as late as the filter is long";
        table.contradiction("filter_s", found, allowed, remedy);
    }
    CaptureSection {
        edge: edge.map_or(CaptureEdge::Rising, |(edge, _)| edge),
        filter_s,
    }
}
