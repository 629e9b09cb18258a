//! The sizes that the tests compare, and faults in the Verilog that the stimuli find.

use super::{InlineShaperBlock, TOP, example, unlimited};
use crate::Error;
use crate::blocks::{BlockMutant, Trial};

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
