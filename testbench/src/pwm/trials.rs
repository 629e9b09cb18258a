//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::pwm::{ActiveLow, PwmConfig};

use super::PwmBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let floors = PwmConfig::new(ActiveLow::default(), 2, 1).map_err(refused)?;
    let polarities = ActiveLow {
        a_high: true,
        b_low: true,
        ..ActiveLow::default()
    };
    let inverted = PwmConfig::new(polarities, 1, 7).map_err(refused)?;
    Ok(vec![
        Trial::new(PwmBlock::new(floors, "", "alone"), &[1, 2], 10),
        Trial::new(PwmBlock::new(inverted, "", "alone"), &[3], 10).size("two pins active low"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new(
        "a watchdog that a feed does not reset",
        "waits = running & !feed",
        "waits = running",
    )
    .within(600_000),
    BlockMutant::new(
        "a clear while the fault stands",
        "clear_trip & !running & latched & over",
        "(clear_trip & !running) & latched",
    )
    .within(600_000),
    BlockMutant::new("an unlimited duty", "limited_next = !under", "limited_next = 1'd0").within(600_000),
    BlockMutant::new(
        "a duty one above its limit",
        "first = {3'd0, max_duty}",
        "first = {3'd0, max_duty} + 19'd1",
    )
    .within(600_000),
    BlockMutant::new("a pin that the mask forgets", "b_low_gate & on", "b_low_gate & armed").within(600_000),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] =
    &[ProofMutant::new("half a dead time", "lasts = dead_time;", "lasts = dead_time >> 1;").violates("dead_time_")];
