//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::{InlineShaperBlock, TOP, example, unlimited};
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let trial = |shaper, seeds| Trial::new(InlineShaperBlock::new(shaper, TOP, TOP), seeds, 5);
    Ok(vec![
        trial(example()?, &[1, 2]).size("2 axes"),
        trial(unlimited()?, &[3]).size("without a limit"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a step generator that gets the tick itself", "(control)", "(tick)"),
    BlockMutant::new("shaping that is left out", "(bypassed)", "(1'd1)"),
    BlockMutant::new("a filter that is left out", "(6'd2)", "(6'd0)"),
    BlockMutant::new("an input that is read as another kind", "(3'd3)", "(3'd4)"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new("steps out that the axis does not count", "(given)", "(32'd0)").violates(""),
    ProofMutant::new(
        "steps in that are read from the wrong line",
        "rise_a = a & edge_a",
        "rise_a = b & edge_a",
    )
    .violates("counts_in"),
];
