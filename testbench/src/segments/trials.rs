//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::SegmentsBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(SegmentsBlock::new("", "alone"), &[1, 2], 50)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a stop that is too strong",
        "stop_deceleration} << 8",
        "stop_deceleration} << 9",
    ),
    BlockMutant::new(
        "an addend that is not sign extended",
        "addend_sign        (addend[7])",
        "addend_sign        (addend[6])",
    ),
    BlockMutant::new(
        "an entry that is taken without its words",
        "written[0] & written[1]",
        "written[0] | written[1]",
    ),
    BlockMutant::new(
        "an underrun that holds its speed",
        "state_q_next = STOP_STATE",
        "state_q_next = HOLD_STATE",
    ),
    BlockMutant::new(
        "a batch that is taken by parts",
        "stages = entered & more",
        "stages = 1'd0",
    ),
    BlockMutant::new(
        "a jerk of a cubic without its sign",
        "invert_q_next = addend_sign",
        "invert_q_next = 1'd0",
    ),
    BlockMutant::new(
        "an extrapolation without an end",
        "in_time = integrator_ticks_after < extrapolation",
        "in_time = 1'd1",
    ),
    BlockMutant::new(
        "an acceleration that wraps",
        "jerk_failed_next = unfit",
        "jerk_failed_next = unfit & points",
    ),
    BlockMutant::new(
        "a command that goes on to the end of its word",
        "leaves = past_reach & moving",
        "leaves = stands & moving",
    )
    .within(3_000_000),
    BlockMutant::new("a feed hold in motion", "& rests_q", ""),
    BlockMutant::new("a feed hold that uses up ticks", "counts & !held", "counts"),
    BlockMutant::new(
        "a stop that slows down past the end of its word",
        "brakes & stands",
        "brakes & moves",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a fifo that writes over its oldest entry",
        "(({2'd0, slot} << 2)",
        "(({2'd0, head} << 2)",
    )
    .violates("no_overwrite"),
    ProofMutant::new(
        "a fifo that writes over the entry that plays",
        "slot = (head + behind) + 6'd1",
        "slot = head + behind",
    )
    .violates("pointers"),
    ProofMutant::new(
        "a command that goes on to the end of its word",
        "leaves = past_reach & moving",
        "leaves = stands & moving",
    )
    .of("segments_range"),
    ProofMutant::new(
        "a stop that slows down past the end of its word",
        "brakes & stands",
        "brakes & moves",
    )
    .of("segments_range"),
];
