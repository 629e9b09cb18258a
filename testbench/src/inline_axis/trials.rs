//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::inline_axis::{InlineAxisConfig, InlineLinesActiveLow, MOST_TICK_STEPS};

use super::InlineAxisBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let low = InlineLinesActiveLow { a: true, b: false };
    let short = InlineAxisConfig::new(3, 5).map_err(refused)?.active_low(low);
    let long = InlineAxisConfig::new(200, 1000).map_err(refused)?;
    let unlimited = InlineAxisConfig::new(u64::from(MOST_TICK_STEPS), 20).map_err(refused)?;
    let trial = |config, seeds, least| Trial::new(InlineAxisBlock::new(config, "", "alone"), seeds, least);
    Ok(vec![
        trial(short, &[1, 2], 20).size("3 steps per tick"),
        trial(long, &[3], 2).size("200 steps per tick, 1000 ticks"),
        // No ride is at the limit, or beyond it.
        trial(unlimited, &[4], 0).size("without a limit"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a limit that is one too high",
        "biased > MOST",
        "biased > (MOST + 18'd1)",
    ),
    BlockMutant::new(
        "a limit going down that is one too low",
        "biased < LEAST",
        "biased <= LEAST",
    ),
    BlockMutant::new(
        "an axis that settles while steps are missing",
        "(behind == offset)",
        "1'b1",
    ),
    BlockMutant::new("a restart that is left out", "tick & !follow_q", "1'b0"),
    BlockMutant::new(
        "an axis that follows on in spite of a cause",
        "goes = run & !caused",
        "goes = run",
    ),
    BlockMutant::new("a line whose level is not turned", "pin_a ^ A_LOW", "pin_a"),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a limit of the input that is one too high",
    "biased > MOST",
    "biased > (MOST + 18'd1)",
)
.violates("stops_at_once")];
