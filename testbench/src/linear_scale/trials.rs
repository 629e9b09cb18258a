//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::LinearScaleBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(LinearScaleBlock::new("", "alone"), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a product that is not rounded",
        "rounded_bit = product_bit ^ round_up",
        "rounded_bit = product_bit",
    ),
    BlockMutant::new(
        "an overflow that wraps",
        "fills_velocity = ends_velocity & serial_overflows",
        "fills_velocity = ends_velocity & rst",
    ),
    BlockMutant::new(
        "an align in a pass that is lost",
        "silent = asked_now | aligning",
        "silent = aligning",
    ),
    BlockMutant::new(
        "a reference that does not come back",
        "other_entering = other_reference << 31",
        "other_entering = 32'd0",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a tick over the one that is computed",
        "takes_positions = tick & !positions_wait",
        "takes_positions = tick",
    )
    .violates("known_ahead"),
    ProofMutant::new(
        "a ratio that is cut instead of rounded",
        "product_bit & (round_up | !begun)",
        "product_bit & round_up",
    )
    .of("serial_ratio")
    .violates("known_round"),
];
