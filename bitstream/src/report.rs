//! What the comparisons of a bitstream report, whatever its family.

use schemars::JsonSchema;
use serde::Serialize;

/// Differences that a report lists; it counts all.
const LISTED: usize = 8;

/// Comparison of a packed bitstream with what the router wrote, tile by tile.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct TilesReport {
    /// Tiles compared, contents of memories and single bits outside tiles included.
    pub tiles: u64,
    /// What is set in them: bits of iCE40; switches, words and settings of ECP5.
    pub set: u64,
    /// Set bits that have no name in the database; they are in pads and in the configuration interface.
    pub unnamed: u64,
    /// Tiles that differ.
    pub differences: Vec<String>,
}

/// Comparison of the netlist of the bits with the router's.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub struct CellsReport {
    /// Look-up tables compared.
    pub tables: u64,
    /// Flip-flops compared.
    pub flip_flops: u64,
    /// Carries compared.
    pub carries: u64,
    /// Multiplexers behind look-up tables compared.
    pub multiplexers: u64,
    /// Memories compared, with their contents.
    pub memories: u64,
    /// Distributed RAMs of ECP5 compared, 16 words of four bits each; their tables are among the look-up tables.
    pub distributed_rams: u64,
    /// Connections compared: inputs of cells, and output pins.
    pub connections: u64,
    /// Logic cells through which the router only passes a net.
    pub passed_through: u64,
    /// Number of differences.
    pub differences: u64,
    /// The first of them.
    pub first: Vec<String>,
}

impl CellsReport {
    /// Counts a difference.
    pub(crate) fn differs(&mut self, what: String) {
        self.differences += 1;
        if self.first.len() < LISTED {
            self.first.push(what);
        }
    }
}

/// Kind of a bit that is flipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum FlipKind {
    /// An entry of a look-up table that is in use.
    Table,
    /// A switch of the routing; on iCE40, any set bit of a logic tile outside its tables and flip-flops.
    Routing,
    /// A bit of the contents of a memory that is in use.
    Memory,
}

impl FlipKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Table, Self::Routing, Self::Memory];

    /// The kind as a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::Routing => "routing",
            Self::Memory => "memory",
        }
    }
}
