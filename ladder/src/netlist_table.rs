//! The tables of netlists in `ladder/RESULTS.md`: a row per block whose netlist is equal to its RTL.

use posicast_testbench::blocks::Block;

use crate::page::{Marks, merged};

/// A table of netlists.
#[derive(Debug, Clone, Copy)]
pub struct NetlistTable {
    /// Where it stands in the page.
    pub marks: Marks,
    head: &'static str,
}

/// Netlists of Cyclone IV E's logic elements.
pub const CYCLONE4E: NetlistTable = NetlistTable {
    marks: Marks {
        begin: "<!-- netlists: written by `--example netlist -- --write` -->",
        end: "<!-- end of netlists -->",
    },
    head: "| block | instance | kept |\n|---|---|---|\n",
};

/// Netlists of Cyclone V's cells.
pub const CYCLONE5: NetlistTable = NetlistTable {
    marks: Marks {
        begin: "<!-- netlists of Cyclone V: written by `--example netlist -- --write --family cyclone5` -->",
        end: "<!-- end of netlists of Cyclone V -->",
    },
    head: "| block | instance | kept | multipliers |\n|---|---|---|---|\n",
};

/// First cells of a block's row.
fn key(block: &dyn Block) -> String {
    format!("| {} | {} |", block.name(), block.instance())
}

/// Returns the row of a block whose proof keeps so many memories and multipliers as they are and, in a table that shows
/// them, whose simulation has so many multipliers of the device.
pub fn row(block: &dyn Block, kept: usize, multipliers: Option<usize>) -> String {
    let multipliers = multipliers.map_or_else(String::new, |count| format!(" {count} |"));
    format!("{} {kept} |{multipliers}\n", key(block))
}

impl NetlistTable {
    /// Returns the table with a row for each of `blocks`: that of `new` if it has one, otherwise that of `old`.
    pub fn renewed(&self, old: &str, new: &str, blocks: &[Box<dyn Block>]) -> String {
        merged(self.head, old, new, blocks.iter().map(|block| key(block.as_ref())))
    }
}
