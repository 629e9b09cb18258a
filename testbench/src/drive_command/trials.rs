//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::DriveCommandBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(DriveCommandBlock::new("", "alone"), &[1, 2], 50)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "outputs that stay on beyond ready",
        "(axis_state == READY_STATE) & direct_enable",
        "direct_enable",
    ),
    BlockMutant::new("a limit that is an lsb too wide", "odd = 17'd1", "odd = 17'd0"),
    BlockMutant::new(
        "a duty that is cut",
        "saturates = controller_bits[17] ^ controller_bits[16]",
        "saturates = 1'd0",
    ),
    BlockMutant::new(
        "limit switches that are swapped",
        "if (backward) begin",
        "if (!backward) begin",
    ),
    BlockMutant::new(
        "a manual duty that the supervisor inherits",
        " | (next_active ^ active)",
        "",
    ),
    BlockMutant::new(
        "a mask that ends with the pwm",
        "masked <= next_test | tested",
        "masked <= next_test",
    ),
    BlockMutant::new(
        "a drive that a self test switches on",
        "drive_enable_q <= (axis_drive_enable | next_active) & !next_test",
        "drive_enable_q <= axis_drive_enable | next_active",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a mask that goes with the self test",
    "masked <= next_test | tested",
    "masked <= next_test",
)
.violates("mask_")];
