//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::trace::TraceConfig;

use super::TraceBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let of =
        |samples| -> Result<TraceBlock, Error> { Ok(TraceBlock::new(TraceConfig::new(samples).map_err(refused)?, "")) };
    Ok(vec![
        Trial::new(of(256)?, &[1, 2], 10).size("256 samples"),
        Trial::new(of(2048)?, &[3], 1).size("2048 samples"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a level that is reached and does not count",
        "wide_value - wide_level",
        "wide_value + ~wide_level",
    ),
    BlockMutant::new(
        "a first row that triggers",
        "has_row_next = 1'd0",
        "has_row_next = 1'd1",
    ),
    BlockMutant::new(
        "an event that is not kept",
        "happens | (kept_event & !compare)",
        "happens",
    ),
    BlockMutant::new("words that were not written", "} < words", "} <= words"),
    BlockMutant::new(
        "rows that are not dropped while waiting",
        "oldest_next = oldest + 8'd1",
        "oldest_next = oldest",
    ),
    BlockMutant::new(
        "a halt that cuts a row",
        "if (active & ready)",
        "if (active & (ready | halting))",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a word behind the last one that is shown",
    "read_address} < words",
    "read_address} <= words",
)
.violates("shown_")];
