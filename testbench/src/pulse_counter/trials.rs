//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::PulseCounterBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(PulseCounterBlock::new("", "alone"), &[1, 2], 21)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a filter a clock too short", "left == 6'd0", "left <= 6'd1"),
    BlockMutant::new(
        "an index that latches before the step",
        "index_count_q_next = counted",
        "index_count_q_next = count_q",
    ),
    BlockMutant::new(
        "a velocity that rests a step of the timeout late",
        "interval[23:16] < timeout",
        "interval[23:16] <= timeout",
    ),
    BlockMutant::new(
        "an edge that stays known after the timeout",
        "known_next = moved | fresh",
        "known_next = moved | known",
    ),
    BlockMutant::new(
        "a count of illegal steps that ends too early",
        "(&illegal_high)",
        "illegal_high[2:0] == 3'd7",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "an illegal transition without a flag",
    "assign illegal = both & ready",
    "assign illegal = both & ready & swap",
)
.violates("illegal_flags")];
