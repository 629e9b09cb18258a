//! The sizes that the tests compare, and faults in the Verilog that the stimuli find.

use super::AxisBlock;
use crate::Error;
use crate::blocks::{BlockMutant, Trial};

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    Ok(vec![Trial::new(AxisBlock::new("", "alone"), &[1, 2], 10)])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a limit that blocks the way back",
        "on_minus & (backward",
        "on_minus & (forward",
    ),
    BlockMutant::new(
        "a clear that forgets what is active",
        "| watched",
        "| (forget ? 16'd0 : watched)",
    ),
    BlockMutant::new(
        "a limit that is passed by an lsb",
        "if (!compares) begin\n            larger_q_next = 1'd0",
        "if (!compares) begin\n            larger_q_next = 1'd1",
    ),
    BlockMutant::new(
        "a shaper that is let go before its first sample",
        "!next_on | (starting_q & !segments_valid)",
        "!next_on",
    ),
    BlockMutant::new("a rotary axis that is held in a range", "far & !modulo", "far & modulo"),
    BlockMutant::new(
        "a motion of the wrong sign",
        "motion <= captured - still_since",
        "motion <= still_since - captured",
    ),
];
