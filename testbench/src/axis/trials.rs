//! The sizes that the tests compare, faults in the Verilog that the stimuli find, and faults with which its proofs fail.

use super::AxisBlock;
use crate::Error;
use crate::blocks::{BlockMutant, ProofMutant, Trial};

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

pub(super) const PROOF_MUTANTS: &[ProofMutant] = &[
    ProofMutant::new(
        "a brake that opens with the outputs off",
        "= next_on & !next_closing",
        "= next_on",
    )
    .violates("brake_never_in_fault"),
    ProofMutant::new(
        "a row of less priority that is taken",
        "hold_to_fault = in_hold & fault & (cut | closing)",
        "hold_to_fault = (in_hold & fault) & closing",
    )
    .of("axis_table")
    .violates("exact_state"),
    ProofMutant::new(
        "a cause that is cleared while it is active",
        "| watched;",
        "| (forget ? 16'd0 : watched);",
    )
    .of("axis_causes")
    .violates("exact_causes"),
    ProofMutant::new(
        "an axis that is homed with a lost encoder",
        "homed_q <= is_homed & ",
        "homed_q <= is_homed | ",
    )
    .of("axis_causes")
    .violates("homed_until_doubtful"),
    ProofMutant::new(
        "soft limits that wait for nothing",
        "(plus_limited_nonzero | minus_limited_nonzero) & !waits",
        "(plus_limited_nonzero | minus_limited_nonzero) & waits",
    )
    .of("axis_monitors")
    .violates(""),
    ProofMutant::new("a range that a rotary axis leaves", "far & !modulo", "far")
        .of("axis_causes")
        .violates("any_cause_at_once"),
    ProofMutant::new(
        "a motion from elsewhere",
        "motion <= captured - still_since",
        "motion <= still_since - captured",
    )
    .of("axis_monitors")
    .violates("motions"),
    ProofMutant::new(
        "a watch that does not follow a motion against the command",
        "over & (!stands | moves)",
        "over & !stands",
    )
    .of("axis_monitors")
    .violates("since_when"),
    ProofMutant::new(
        "a brake with a tick too little",
        "at_zero = !sum[16]",
        "at_zero = left <= 16'd1",
    )
    .of("axis_brake")
    .violates("exact_"),
    ProofMutant::new(
        "a limit that trips where it is reached",
        "if (!compares) begin\n            larger_q_next = 1'd0",
        "if (!compares) begin\n            larger_q_next = 1'd1",
    )
    .of("axis_monitors")
    .violates("sizes"),
    ProofMutant::new(
        "an emergency stop that only stops the other axes",
        "emergency = own_emergency | group_emergency_stop",
        "emergency = group_emergency_stop",
    )
    .of("axis_lines")
    .violates("trips_in_time"),
];
