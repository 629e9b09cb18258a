//! The tables of `ladder/RESULTS.md` have a row for every block of the registry: a block that no program was run for is missing there.

use posicast_ladder::mutation::all;
use posicast_testbench::blocks::{Block, library};

const RESULTS: &str = include_str!("../RESULTS.md");

/// The part of a page below this heading, up to the next of the same level.
fn section(page: &'static str, heading: &str) -> &'static str {
    let below = page.split_once(&format!("\n## {heading}\n")).unwrap().1;
    below.split("\n## ").next().unwrap()
}

fn missing(heading: &str, rows: impl IntoIterator<Item = String>) -> Vec<String> {
    let table = section(RESULTS, heading);
    rows.into_iter().filter(|row| !table.contains(row)).collect()
}

#[test]
fn every_block_has_its_row_of_mutants() {
    let subjects = all().unwrap();
    let row = |block: &str, size: &str| format!("\n| {block} | {size} | ");
    let rows = subjects
        .iter()
        .map(|subject| row(subject.block().name(), subject.size()));
    assert_eq!(missing("Mutants", rows), [""; 0]);
}

#[test]
fn every_block_but_the_stage_has_its_row_of_netlists() {
    let blocks = library().unwrap();
    let blocks = blocks.iter().filter(|block| block.name() != "stage");
    let row = |block: &dyn Block| format!("\n| {} | {} | ", block.name(), block.instance());
    assert_eq!(missing("Netlist", blocks.map(|block| row(block.as_ref()))), [""; 0]);
}
