//! What happens to position compare and capture beside the faults of the machine.

use crate::fault_campaign::expectation::{Expectation, Hit, NOTHING};
use crate::fault_campaign::kind::{FaultKind, FaultRow};

/// Nothing stops, and both axes are watched, in the part of the move in which they are fast.
const WATCHED: Expectation = Expectation {
    hit: Hit::Stage,
    within_percent: [40, 70],
    ..NOTHING
};

/// The same late in the move, when positions have been passed.
const LATE: Expectation = Expectation {
    within_percent: [60, 85],
    ..WATCHED
};

const fn row(kind: FaultKind, name: &'static str, injected: &'static str) -> FaultRow {
    FaultRow {
        kind,
        name,
        injected,
        expects: WATCHED,
    }
}

/// Kinds of every machine.
const CAPTURE: [FaultRow; 7] = [
    row(
        FaultKind::ProbeBounces,
        "probe, bouncing",
        "contacts shorter than the filter, then a touch, and the same at its end",
    ),
    row(
        FaultKind::ProbeShort,
        "probe, short touches",
        "touches shorter than the filter",
    ),
    row(
        FaultKind::ProbeFull,
        "probe, memory full",
        "17 to 40 edges, of which nobody takes the entries",
    ),
    row(
        FaultKind::ProbeTaken,
        "probe, entries taken",
        "30 edges, while a host takes the entries",
    ),
    row(
        FaultKind::ProbeWindow,
        "probe, window",
        "edges inside and outside the window of an axis, which may be empty",
    ),
    row(
        FaultKind::ProbeStuck,
        "probe, touching from the start",
        "the line is high from the reset to the end of the move",
    ),
    row(
        FaultKind::ProbeCleared,
        "probe, capture cleared",
        "`capture_clear`, three times, while edges come",
    ),
];

/// Kinds of a machine whose count is compared.
const COMPARE: [FaultRow; 4] = [
    row(
        FaultKind::CompareWritten,
        "compare, settings written",
        "other settings and entries, and `compare_clear`, while it is armed",
    ),
    FaultRow {
        expects: LATE,
        ..row(
            FaultKind::CompareArmed,
            "compare, armed again",
            "`compare_arm` in the move, with other settings",
        )
    },
    FaultRow {
        expects: LATE,
        ..row(
            FaultKind::CompareDisarmed,
            "compare, disarmed",
            "`compare_disarm` in the move",
        )
    },
    row(
        FaultKind::CompareOverlaps,
        "compare, overlapping pulses",
        "pulses longer than the time from position to position",
    ),
];

/// Kinds of a machine with encoders.
const COMPARE_OF_ENCODER: [FaultRow; 3] = [
    row(
        FaultKind::CompareGlitch,
        "compare, encoder's glitches",
        "A or B inverted, no longer than the filter, at a position on every count",
    ),
    row(
        FaultKind::CompareReversal,
        "compare, reversals",
        "the axis is pushed to and fro by up to 3 counts, with positions up to 3 counts apart",
    ),
    row(
        FaultKind::CompareFast,
        "compare, fast",
        "the axis is pushed as fast as the filter lets it count, over a position on every count",
    ),
];

/// The kinds of a machine with A, B and index.
pub(in crate::fault_campaign) fn of_encoders() -> impl Iterator<Item = FaultRow> {
    of_steps().chain(COMPARE_OF_ENCODER)
}

/// The kinds of a machine with steps.
pub(in crate::fault_campaign) fn of_steps() -> impl Iterator<Item = FaultRow> {
    of_absolute().chain(COMPARE)
}

/// The kinds of a machine with absolute encoders, which have a capture only.
pub(in crate::fault_campaign) fn of_absolute() -> impl Iterator<Item = FaultRow> {
    CAPTURE.into_iter()
}
