//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::WishboneBridgeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(WishboneBridgeBlock::new(""), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a classic request that is made again", "pipelined | !open", "1'd1"),
    BlockMutant::new(
        "an answer to a master that has left",
        "passed & !failed & listens",
        "passed & !failed",
    ),
    BlockMutant::new(
        "a write without bytes that reaches the registers",
        "wb_we & (|wb_sel)",
        "wb_we",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new("a classic request that is made again", "pipelined | !open", "1'd1").violates(""),
    ProofMutant::new(
        "an answer to a master that has left",
        "passed & !failed & listens",
        "passed & !failed",
    )
    .violates("answer"),
];
