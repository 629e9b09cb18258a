//! The size that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::CompareBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(CompareBlock::new("", "alone"), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a downward passage a count early",
        "fell & has_below & (&below_bits)",
        "fell & has_below & !(|below_bits)",
    ),
    BlockMutant::new(
        "a pulse that is a clock too long",
        "goes_on = left > ",
        "goes_on = left >= ",
    ),
    BlockMutant::new("a hysteresis that is forgotten", "wanted & !(is_near & same)", "wanted"),
    BlockMutant::new("entries that may be equal", "(distance >= LEAST)", "1'b1"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a position that is left a count early",
        "fell & has_below & (&below_bits)",
        "fell & has_below & !(|below_bits)",
    ),
    ProofMutant::new(
        "entries of a list that are too near",
        "LEAST = 33'sd4",
        "LEAST = 33'sd3",
    ),
];
