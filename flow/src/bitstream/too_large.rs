//! What can be done about a design that does not fit a device: its largest blocks, and larger boards.

use crate::observer::Observer;
use posicast_bitstream::boards::{BOARDS, FpgaBoard};
use posicast_synth::yosys::{BlockEstimate, Family, Yosys};
use std::path::PathBuf;

/// Number of blocks that are named.
const NAMED_BLOCKS: usize = 5;

/// Names the largest blocks in the module `top` of these files, and the boards with more logic cells. Without an estimate it names the
/// boards alone.
pub(super) fn remedy(files: &[PathBuf], top: &str, board: &FpgaBoard, observer: &dyn Observer) -> String {
    let _shown = observer.begin("estimating which block takes what", None);
    let estimate = Yosys::installed().and_then(|yosys| yosys.estimate(files, top, Family::Cyclone4e));
    let blocks = estimate.map(|estimate| estimate.blocks).unwrap_or_default();
    [largest(&blocks), larger_boards(board)].concat().join("; ")
}

/// Names the boards with enough pins on their headers, and what needs fewer.
pub(super) fn remedy_for_pins(needed: usize) -> String {
    let fits = BOARDS.iter().filter(|board| board.header.len() >= needed);
    let names: Vec<&str> = fits.map(|board| board.name).collect();
    let boards = match names.as_slice() {
        [] => "no board has as many".to_owned(),
        some => format!("boards with as many: {}", some.join(", ")),
    };
    format!("{boards}; an axis less takes fewer, and --bare-board none")
}

/// The largest blocks, as a list of at most one sentence.
fn largest(blocks: &[BlockEstimate]) -> Vec<String> {
    let mut blocks: Vec<&BlockEstimate> = blocks.iter().collect();
    blocks.sort_by_key(|block| std::cmp::Reverse(block.resources.cells));
    let named = blocks.iter().take(NAMED_BLOCKS);
    let named: Vec<String> = named
        .map(|block| format!("{} {}", block.name, block.resources.cells))
        .collect();
    match named.as_slice() {
        [] => Vec::new(),
        some => vec![format!(
            "the largest blocks, by an estimate in logic elements of Cyclone IV E, without their multipliers: {}",
            some.join(", ")
        )],
    }
}

/// The boards whose device has more logic cells.
fn larger_boards(board: &FpgaBoard) -> Vec<String> {
    let cells = board.device.logic_cells();
    let larger = BOARDS.iter().filter(|other| other.device.logic_cells() > cells);
    let names: Vec<&str> = larger.map(|other| other.name).collect();
    match names.as_slice() {
        [] => vec!["no board is larger: leave out axes, shorten tap tables, or leave out traces".to_owned()],
        some => vec![format!("larger boards: {}", some.join(", "))],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_bitstream::boards::board;

    #[test]
    fn boards_with_as_many_pins_are_named() {
        assert_eq!(
            remedy_for_pins(41),
            "boards with as many: ulx3s-12f, ulx3s-25f, ulx3s-85f; an axis less takes fewer, and --bare-board none"
        );
        assert!(remedy_for_pins(52).starts_with("no board has as many; "));
    }

    #[test]
    fn larger_boards_are_those_with_more_cells() {
        let of = |name| larger_boards(&board(name).unwrap()).concat();
        assert_eq!(
            of("icebreaker"),
            "larger boards: ice40-hx8k, colorlight-i5, ulx3s-12f, ulx3s-25f, ulx3s-85f, tang-nano-9k, tang-nano-20k"
        );
        assert_eq!(of("colorlight-i5"), "larger boards: ulx3s-85f");
        assert!(of("ulx3s-85f").starts_with("no board is larger"));
    }
}
