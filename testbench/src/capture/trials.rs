//! The size that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::CaptureBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(CaptureBlock::new("", "alone"), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a filter that is a clock short",
        "lasts >= filter_clocks",
        "lasts + 16'd1 >= filter_clocks",
    ),
    BlockMutant::new("a first level that is an edge", "settles & known", "settles"),
    BlockMutant::new(
        "the reset of the line that is taken for its level",
        "primed[1] & !(",
        "!(",
    ),
    BlockMutant::new(
        "different levels that add up while none is known",
        "known | (now == last)",
        "1'b1",
    ),
    BlockMutant::new(
        "edges that are captured while disabled",
        "edge_line_changed & enable",
        "edge_line_changed",
    ),
    BlockMutant::new(
        "a window without its last position",
        "position <= window_last",
        "position < window_last",
    ),
    BlockMutant::new(
        "a window of positions without a sign",
        "window_first <= position",
        "$unsigned(window_first) <= $unsigned(position)",
    ),
    BlockMutant::new(
        "a window on another axis",
        "position = high_pair",
        "position = low_pair",
    ),
    BlockMutant::new("a full memory that is written over", "offers & !left[4]", "offers"),
    BlockMutant::new("a place that take does not make", "!left[4]", "!entries_q[4]"),
    BlockMutant::new("an entry that is taken before it is shown", "take & valid", "take"),
    BlockMutant::new("entries that come back after clear", "shown = place", "shown = oldest"),
    BlockMutant::new(
        "words of the memory that show without an entry",
        "valid & shown_mark[32]",
        "shown_mark[32]",
    ),
    BlockMutant::new(
        "edges that are counted on through clear",
        "edges_before = 32'd0",
        "edges_before = edges_q",
    ),
    BlockMutant::new(
        "a flag that is cleared as it is set",
        "memory_overflows | (overflowed_q & !clear_flags)",
        "(memory_overflows | overflowed_q) & !clear_flags",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "an edge of a line that was not steady",
        "lasts >= filter_clocks",
        "lasts + 16'd1 >= filter_clocks",
    )
    .violates("edge_is_steady"),
    ProofMutant::new(
        "an entry that is written over",
        "place = oldest + entries_q[3:0]",
        "place = oldest",
    )
    .violates("chosen_in_order"),
];
