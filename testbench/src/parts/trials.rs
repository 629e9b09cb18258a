//! Faults in the Verilog of the small parts: some that the stimuli find, others with which their proofs fail.

use super::{PartBlock, SmallPart};
use crate::blocks::{BlockMutant, ProofMutant, Trial};

/// A part as the tests compare it.
pub(super) fn trial(part: SmallPart, size: &'static str) -> Trial {
    Trial::new(PartBlock::new(part, "alone"), &[1], 20).size(size)
}

pub(super) const ABSOLUTE_FEEDBACK: &[BlockMutant] = &[
    BlockMutant::new(
        "a first reading that is not taken modulo the range",
        "(reading_bits - offset) & range",
        "reading_bits - offset",
    ),
    BlockMutant::new(
        "a direction that the velocity does not follow",
        "speed = $signed(32'd0 - change)",
        "speed = $signed(change)",
    ),
    BlockMutant::new("a change that wraps", "bounded = MOST", "bounded = speed"),
    BlockMutant::new(
        "a controller that starts with the first reading",
        "control & steady",
        "control & is_placed",
    ),
    BlockMutant::new(
        "an axis that is ready before it is placed",
        "drive_ready & (steady | lost)",
        "drive_ready",
    ),
    BlockMutant::new(
        "an axis that stays placed while its encoder is lost",
        "reading_known & (is_placed | reading_valid)",
        "is_placed | reading_valid",
    ),
];
pub(super) const SCHEDULE: &[BlockMutant] = &[BlockMutant::new(
    "a tick that does not begin anew",
    "if (tick) begin",
    "if (tick & !waits) begin",
)];
pub(super) const DIVIDER_SHARE: &[BlockMutant] = &[BlockMutant::new(
    "steps of the other channel",
    "steps_q_next = steps_of_1;",
    "steps_q_next = steps_of_0;",
)
.of("2 channels")];
pub(super) const GROUP: &[BlockMutant] = &[BlockMutant::new(
    "a start that looks at another axis",
    "& !can_start_1)",
    "& !can_start_0)",
)];
pub(super) const INLINE_GROUP: &[BlockMutant] = &[
    BlockMutant::new(
        "drives that come back after an emergency stop",
        "& awake & !emergency",
        "& awake",
    ),
    BlockMutant::new(
        "a change of the shaping while an axis moves",
        "tick & (all_settled | !run_q)",
        "tick",
    ),
    BlockMutant::new("a clear that lasts", "& !clear_before", ""),
];
pub(super) const LASTING_DEVIATION: &[BlockMutant] = &[
    BlockMutant::new(
        "a deviation that lasts a tick longer",
        "count >= ticks",
        "count > ticks",
    ),
    BlockMutant::new(
        "a negative deviation of no size",
        "size = ~deviation_bits",
        "size = 32'd0",
    ),
    BlockMutant::new(
        "a count that goes on after an excursion",
        "count_next = 16'd0",
        "count_next = count",
    ),
];
pub(super) const PROBE_LINE: &[BlockMutant] = &[
    BlockMutant::new("a line in one polarity", "probe ^ active_low", "probe"),
    BlockMutant::new(
        "a filter from the reset on",
        "primed[3] & (|filter_clocks)",
        "(|filter_clocks)",
    ),
];
pub(super) const REALIGN: &[BlockMutant] = &[
    BlockMutant::new("a correction that does not align", "enabled | correct", "enabled"),
    BlockMutant::new("steps without their sign", "{16{realign_steps[15]}}", "{16{1'b0}}"),
];
pub(super) const SETTING_BANKS: &[BlockMutant] = &[
    BlockMutant::new(
        "a read-back of another row",
        "read_row = setting_row;",
        "read_row = row;",
    ),
    BlockMutant::new("a read-back while the controller reads", "& !busy", ""),
];

pub(super) const SAMPLE_SELECT_PROOFS: &[ProofMutant] = &[ProofMutant::new(
    "a start of the other source",
    "start_q_next = pin_start",
    "start_q_next = pin_start | host_start",
)
.violates("exact")];

pub(super) const SCHEDULE_PROOFS: &[ProofMutant] =
    &[ProofMutant::new("a control a clock late", "LAST = 17'd0", "LAST = 17'd1").violates("exactly")];

pub(super) const TIME_BASE_PROOFS: &[ProofMutant] = &[ProofMutant::new(
    "a division that starts with its tick",
    "divide_q <= tick_q;",
    "divide_q <= tick_q_next;",
)
.violates("divide_follows")];

pub(super) const DIVIDER_SHARE_PROOFS: &[ProofMutant] = &[ProofMutant::new(
    "a share that begins with the second channel",
    "FIRST_CHANNEL = 4'd0",
    "FIRST_CHANNEL = 4'd1",
)
.violates("next_follows")];

pub(super) const INLINE_GROUP_PROOFS: &[ProofMutant] = &[ProofMutant::new(
    "shaping that changes in motion",
    "tick & (all_settled | !run_q)",
    "tick",
)
.violates("changes_at_rest")];

pub(super) const LASTING_DEVIATION_PROOFS: &[ProofMutant] = &[
    ProofMutant::new(
        "a deviation that is passed on a tick late",
        "count >= ticks",
        "count > ticks",
    )
    .violates(""),
    ProofMutant::new(
        "a count that goes on after an excursion",
        "count_next = 16'd0",
        "count_next = count",
    )
    .violates(""),
];

pub(super) const PROBE_LINE_PROOFS: &[ProofMutant] = &[
    ProofMutant::new("a probe of the other polarity", "probe ^ active_low", "probe").violates(""),
    ProofMutant::new(
        "a probe that is filtered from its reset on",
        "primed[3] & (|filter_clocks)",
        "(|filter_clocks)",
    )
    .violates(""),
];

pub(super) const REALIGN_PROOFS: &[ProofMutant] = &[
    ProofMutant::new(
        "a correction after which nothing counts anew",
        "enabled | correct",
        "enabled",
    )
    .violates("aligns_after"),
    ProofMutant::new(
        "steps of a correction without their sign",
        "{16{realign_steps[15]}}",
        "{16{1'b0}}",
    )
    .violates("counts_the_hosts"),
];

pub(super) const SETTING_BANKS_PROOFS: &[ProofMutant] = &[
    ProofMutant::new("a setting that changes in use", " & (setting_bank != bank)", "").violates("active_stays"),
    ProofMutant::new("a read back in a pass", "& !busy", "").violates("serves_idle"),
];

pub(super) const GROUP_PROOFS: &[ProofMutant] = &[ProofMutant::new(
    "an axis that starts alone",
    "start_q_0 <= start & !blocked",
    "start_q_0_next = start",
)
.violates("all_or_none")];

pub(super) const ABSOLUTE_FEEDBACK_PROOFS: &[ProofMutant] = &[
    ProofMutant::new(
        "a first reading that is not taken modulo the range",
        "(reading_bits - offset) & range",
        "reading_bits - offset",
    )
    .violates("placed_in_range"),
    ProofMutant::new(
        "an axis that is ready before it is placed",
        "drive_ready & (steady | lost)",
        "drive_ready",
    )
    .violates("ready_when_steady"),
];
