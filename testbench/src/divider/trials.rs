//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::divider::DividerConfig;

use super::DividerBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let of = |tick_clocks| -> Result<DividerBlock, Error> {
        Ok(DividerBlock::new(DividerConfig::new(tick_clocks).map_err(refused)?, ""))
    };
    Ok(vec![
        Trial::new(of(5000)?, &[5000], 101).size("5000 clocks per tick"),
        Trial::new(of(131_071)?, &[131_071], 101).size("131071 clocks per tick"),
        Trial::new(of(97)?, &[97], 101).size("97 clocks per tick"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[BlockMutant::new(
    "a quotient that is clamped a bit too late",
    "FITS_PHASE = 7'd65",
    "FITS_PHASE = 7'd64",
)];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a division by no clocks",
    "divisor_next = elapsed | one_tick",
    "divisor_next = elapsed",
)
.violates("known_operands")];
