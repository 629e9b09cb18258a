//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::SpiBridgeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(SpiBridgeBlock::new("", "alone"), &[1, 2], 1)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a frame that goes on after a byte that was cut off",
        "bad_q <= !selected_level & !first",
        "bad_q <= 1'b0",
    )
    .within(1_000_000),
    BlockMutant::new(
        "an edge that counts although the selection only begins",
        "is_selected = selected_level & selected_before",
        "is_selected = selected_level",
    )
    .within(1_000_000),
    BlockMutant::new(
        "a byte of the reply that is lost with its selection",
        "busy = full",
        "busy = full & selected_level",
    )
    .within(1_000_000),
    BlockMutant::new(
        "a line to the host that is a bit late",
        "spi_miso = given[7]",
        "spi_miso = given[6]",
    ),
    BlockMutant::new("a time out that never comes", "| bad | (expired & begun)", "| bad").within(1_000_000),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a byte that goes on in the next selection",
    "place_next = FIRST_PLACE",
    "place_next = place",
)
.violates("known_lines")];
