//! The size that the tests compare, and faults in the Verilog that the stimuli find.

use super::CompareBlock;
use crate::Error;
use crate::blocks::{BlockMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(CompareBlock::new("", "alone"), &[1, 2], 3)])
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
