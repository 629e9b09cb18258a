//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use posicast_blocks::step_generator::{StepGeneratorConfig, StepLinesActiveLow, StepMode, StepTimes};

use super::StepGeneratorBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};
use crate::formal::refused;

/// Few clocks each, so that a run has many steps and a proof reaches its covers soon.
const FEW: StepTimes = StepTimes {
    pulse_clocks: 3,
    space_clocks: 4,
    direction_setup_clocks: 12,
    direction_hold_clocks: 8,
};

/// A few steps per tick, and reversals that owe about as many as are allowed.
pub(super) fn small(mode: StepMode) -> Result<StepGeneratorConfig, Error> {
    StepGeneratorConfig::new(50, 4, mode, FEW, 3).map_err(refused)
}

pub(super) fn all() -> Result<Vec<Trial>, Error> {
    let short = StepTimes {
        pulse_clocks: 2,
        space_clocks: 1,
        direction_setup_clocks: 0,
        direction_hold_clocks: 30,
    };
    let setup_below_space = StepTimes {
        pulse_clocks: 5,
        space_clocks: 9,
        direction_setup_clocks: 2,
        direction_hold_clocks: 40,
    };
    let a_low = StepLinesActiveLow { a: true, b: false };
    let b_low = StepLinesActiveLow { a: false, b: true };
    let up_down = StepGeneratorConfig::new(300, 8, StepMode::UpDown, setup_below_space, 1).map_err(refused)?;
    let quadrature = StepGeneratorConfig::new(211, 0, StepMode::Quadrature, setup_below_space, 1).map_err(refused)?;
    let largest = StepGeneratorConfig::new(1 << 14, 16, StepMode::StepDirection, short, 1).map_err(refused)?;
    let trial = |config, seeds, least| Trial::new(StepGeneratorBlock::new(config, ""), seeds, least);
    Ok(vec![
        // With seed 2 a run owes too many steps 14 times.
        trial(small(StepMode::StepDirection)?, &[1, 2], 10).size("step and direction"),
        trial(up_down.active_low(a_low), &[3], 5).size("up and down, a active low"),
        trial(quadrature.active_low(b_low), &[4], 5).size("quadrature without fraction, b active low"),
        // A million clocks are 60 of its ticks: too few for every case.
        trial(largest, &[5], 0).size("largest accumulator, shortest times"),
    ])
}

pub(super) const MUTANTS: &[BlockMutant] = &[
    BlockMutant::new("a reversal that forgets to turn the sum", "passed ^ turns", "passed"),
    BlockMutant::new("a pulse a clock too short", "PULSE = 16'd3", "PULSE = 16'd2"),
    BlockMutant::new(
        "a step that is given without being taken off",
        "given = MINUS_ONE",
        "given = 3'd0",
    ),
    BlockMutant::new("a tick that is taken over the one before", "(!moving | last)", "1'b1"),
    BlockMutant::new(
        "a largest rate that is one too high",
        "magnitude[0] != 1'd0",
        "magnitude[0] != 1'd1",
    ),
];

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[ProofMutant::new(
    "a direction that changes with the end of a pulse",
    "may_turn | (!pulsing & (timer == HOLD))",
    "may_turn | !pulsing",
)
.violates("known_held")];
