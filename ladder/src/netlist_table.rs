//! The table of netlists in `ladder/RESULTS.md`: a row per block whose netlist is equal to its RTL.

use posicast_testbench::blocks::Block;

use crate::page::{Marks, merged};

/// Marks of the table.
pub const MARKS: Marks = Marks {
    begin: "<!-- netlists: written by `--example netlist -- --write` -->",
    end: "<!-- end of netlists -->",
};
const HEAD: &str = "| block | instance | kept |\n|---|---|---|\n";

/// First cells of a block's row.
fn key(block: &dyn Block) -> String {
    format!("| {} | {} |", block.name(), block.instance())
}

/// Returns the row of a block whose netlist keeps so many memories and multipliers as they are.
pub fn row(block: &dyn Block, kept: usize) -> String {
    format!("{} {kept} |\n", key(block))
}

/// Returns the table with a row for each of `blocks`: that of `new` if it has one, otherwise that of `old`.
pub fn renewed(old: &str, new: &str, blocks: &[Box<dyn Block>]) -> String {
    merged(HEAD, old, new, blocks.iter().map(|block| key(block.as_ref())))
}
