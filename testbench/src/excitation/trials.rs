//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::ExcitationBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(ExcitationBlock::new("", "alone"), &[1, 2], 10)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("another polynomial", "noise[14] ^ noise[13]", "noise[14] ^ noise[12]").within(1_000_000),
    BlockMutant::new("a position that wraps", "sum_bits[32] ^ sum_bits[31]", "1'b0"),
    BlockMutant::new("an amplitude beyond its limit", "amplitude > amplitude_limit", "1'b0"),
    BlockMutant::new("a signal that starts twice", "if (starts) begin", "if (1'b0) begin"),
    BlockMutant::new(
        "a value rounded toward zero",
        "complement = ~subtrahend",
        "complement = -subtrahend",
    ),
    BlockMutant::new("a chirp without end", "too_fast = turned", "too_fast = 1'b0").within(1_000_000),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a test signal that is not allowed",
    "enable & allowed & (|kind)",
    "enable & (|kind)",
)
.violates("cut_off")];
