//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::EncoderGeneratorBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(EncoderGeneratorBlock::new("", "alone"), &[1, 2], 20)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "lines that change in successive clocks",
        "if (!moved) begin",
        "if (1'b1) begin",
    ),
    BlockMutant::new(
        "a turn that is a period too long",
        "next_period >= index_periods",
        "next_period > index_periods",
    ),
    BlockMutant::new(
        "an index that is lost going down",
        "from_period = index_periods",
        "from_period = period",
    ),
    BlockMutant::new(
        "lines that outlive a reset",
        "generated_a = line_a & !rst",
        "generated_a = line_a",
    ),
    BlockMutant::new("a rate without its sign", "{{32{rate[31]}}, rate}", "{32'd0, rate}"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] =
    &[ProofMutant::new("lines that turn back at once", "if (!moved) begin", "begin").violates("every_other_clock")];
