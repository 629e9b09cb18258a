//! The table of proofs in `ladder/RESULTS.md`: it follows from the registry.

use posicast_testbench::Error;
use posicast_testbench::blocks::proofs_by_block;
use posicast_testbench::formal::Task;

use crate::page::Marks;

/// Marks of the table.
pub const MARKS: Marks = Marks {
    begin: "<!-- proofs: written by scripts/regenerate -->",
    end: "<!-- end of proofs -->",
};

/// Returns the table with a row per property file and size.
///
/// # Errors
/// [`Error::Block`] if a block cannot be written as Verilog.
pub fn markdown() -> Result<String, Error> {
    let head = "| block | property file | size | engine | left open |\n|---|---|---|---|---|\n";
    let rows = proofs_by_block()?;
    Ok(rows
        .iter()
        .fold(head.to_owned(), |table, (block, task)| table + &row(block, task)))
}

fn row(block: &str, task: &Task) -> String {
    format!(
        "| {block} | `{}` | {} | {} | {} |\n",
        task.name,
        task.size,
        task.engine.name(),
        task.left_open().join(", ")
    )
}
