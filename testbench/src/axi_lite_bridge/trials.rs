//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::AxiLiteBridgeBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(AxiLiteBridgeBlock::new(""), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "reads that always go first",
        "read_first_next = writes",
        "read_first_next = 1'd1",
    ),
    BlockMutant::new("a read more than the queues hold", "& !open_reads[2]", ""),
    BlockMutant::new(
        "a write that does not wait for its word",
        "write_addresses_holds & write_words_holds",
        "write_addresses_holds",
    ),
    BlockMutant::new(
        "a write without bytes that reaches the registers",
        "writes & (|bytes)",
        "writes",
    ),
    BlockMutant::new("an entry over the second one", "put & !full_q", "put"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new("a read more than the queues hold", "& !open_reads[2]", ""),
    ProofMutant::new(
        "a write that goes before its word",
        "write_addresses_holds & write_words_holds",
        "write_addresses_holds",
    )
    .violates(""),
    ProofMutant::new(
        "reads that let no write pass",
        "read_first_next = writes",
        "read_first_next = 1'd1",
    )
    .violates(""),
];
