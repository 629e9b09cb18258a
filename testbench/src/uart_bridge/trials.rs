//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::UartBridgeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(UartBridgeBlock::new("", "alone"), &[1, 2], 3)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a checksum that is not looked at",
        "holds = sum == RESIDUE",
        "holds = 1'b1",
    ),
    BlockMutant::new(
        "a repeated request that is executed again",
        "(sequence_number == last_sequence)",
        "1'b0",
    ),
    BlockMutant::new(
        "an address one beyond the registers",
        "exists = address_q < address_limit",
        "exists = address_q <= address_limit",
    )
    .within(1_000_000),
    BlockMutant::new(
        "a frame that goes on after a byte without a stop bit",
        "spoilt = skips | bad | (expired & begun)",
        "spoilt = skips | (expired & begun)",
    )
    .within(1_000_000),
    BlockMutant::new("a time out that never comes", "| bad | (expired & begun)", "| bad").within(1_000_000),
    BlockMutant::new("a bit that is taken an eighth late", "MIDDLE = 3'd3", "MIDDLE = 3'd4"),
    // A mutant that was not found while the host's numbers seldom went beyond 63.
    BlockMutant::new(
        "a sequence number that loses a bit on the way",
        "if (place == THIRD) begin",
        "if (|place) sequence_q_next = sequence_q & 8'hbf;\n            if (place == THIRD) begin",
    ),
    // With these the requests at the borders begin: random numbers take long to come upon them.
    BlockMutant::new(
        "a sequence number that is compared on six bits among the first requests",
        "(sequence_number == last_sequence)",
        "(sequence_number[5:0] == last_sequence[5:0])",
    )
    .within(20_000),
    BlockMutant::new(
        "a number 0 that repeats among the first requests",
        "(|sequence_number)",
        "1'b1",
    )
    .within(20_000),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a request whose CRC is wrong",
        "request_q <= whole",
        "request_q <= delimiter & begun",
    ),
    ProofMutant::new(
        "a request that is executed before all of it is checked",
        "looks_next = 1'd1",
        "looks_next = 1'd0",
    )
    .of("uart_sequencer")
    .violates("known_all_seen"),
    ProofMutant::new(
        "a repeated request that is executed again",
        "(|sequence_number) & (sequence_number == last_sequence)",
        "1'b0",
    )
    .of("uart_sequencer")
    .violates("known_again"),
];
