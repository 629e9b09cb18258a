//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::ErrorTableBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let of = |entries, spacing_bits| -> Result<ErrorTableBlock, Error> {
        Ok(ErrorTableBlock::new(
            ErrorTableBlock::of_size(entries, spacing_bits)?,
            "",
            "alone",
        ))
    };
    Ok(vec![
        Trial::new(of(9, 6)?, &[1, 2], 3).size("9 entries"),
        Trial::new(of(256, 12)?, &[3], 3).size("256 entries"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "an average that is not rounded",
        "rounded = average + half",
        "rounded = average",
    ),
    BlockMutant::new(
        "a neighbour behind the last entry",
        "!beyond & (index < LAST)",
        "!beyond",
    ),
    BlockMutant::new("an origin that jumps", "if (off) begin", "if (off | ~homed) begin"),
    BlockMutant::new(
        "a bank that is written while in use",
        "(loaded & !off)",
        "(loaded & off)",
    ),
    BlockMutant::new(
        "a step that is too steep by one",
        "step <= MOST_STEP",
        "step <= MOST_STEP + 20'sd1",
    ),
    BlockMutant::new(
        "a sum that wraps",
        "beyond = sum_bits[32] ^ sum_bits[31]",
        "beyond = sum_bits[32] & ~sum_bits[32]",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a bank that changes while it counts",
        "if (off) begin",
        "if (1'b1) begin",
    )
    .violates("taken_at_0"),
    ProofMutant::new(
        "an entry that is too steep",
        "step <= MOST_STEP",
        "step <= MOST_STEP + 20'sd1",
    )
    .violates("neighbours"),
    ProofMutant::new("an entry of a bank in use", "(loaded & !off)", "(1'b0)").violates(""),
    ProofMutant::new("a neighbour behind the table", "index < LAST", "index <= LAST").of("error_lookup"),
    ProofMutant::new(
        "an average that is rounded down",
        "rounded = average + half",
        "rounded = average",
    )
    .of("error_lookup"),
];
