//! The table of faults: what is injected and what is expected, one row each.

use posicast_blocks::axis::Cause;

use super::expectation::{Due, Expectation, FAULT, Hit, Lasts, NOTHING, Others, Reaction, Seen, bits};
use super::machine::{FILTER_CLOCKS, TICK_CLOCKS};

/// A kind of fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table says what each is")]
pub enum FaultKind {
    EmergencyStop,
    EmergencyStopGlitch,
    PllUnlocked,
    RawFault,
    RawFaultOneClock,
    DriveFault,
    DriveFaultGlitch,
    DriveNotReady,
    DriveReadyGlitch,
    LimitAhead,
    LimitBehind,
    LimitGlitch,
    Home,
    EncoderIllegal,
    EncoderGlitch,
    EncoderStuck,
    EncoderLineStuck,
    EncoderLineStuckUnwatched,
    EncoderDisconnected,
    EncoderReversed,
    EncoderReversedUnwatched,
    EncoderReversedInHold,
    EncoderReversedInHoldUnwatched,
    ScaleStuck,
    ScaleIllegal,
    Jam,
    JamWithoutFollowingError,
    HostSilent,
    Flush,
    Overflow,
    OutOfRange,
    Malformed,
    FifoFull,
    SoftLimit,
    Stop,
    Disable,
    Reset,
    SettingRefused,
    NoGains,
    TableHandover,
    PresetOrigin,
    ClearFaults,
    StartAgain,
    DirectMode,
    StepsCut,
    StepsReversed,
    TooFast,
    Excursion,
    AbsoluteStuck,
    AbsoluteBit,
    AbsoluteBrief,
    ProbeBounces,
    ProbeShort,
    ProbeFull,
    ProbeTaken,
    ProbeWindow,
    ProbeStuck,
    ProbeCleared,
    CompareWritten,
    CompareArmed,
    CompareDisarmed,
    CompareOverlaps,
    CompareGlitch,
    CompareReversal,
    CompareFast,
}

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultRow {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Name in reports.
    pub name: &'static str,
    /// Description of the injected fault.
    pub injected: &'static str,
    /// Expected reaction.
    pub expects: Expectation,
}

/// Latency from a line to the state: synchroniser, filter, state.
const LINE: Due = Due::Clocks(FILTER_CLOCKS + 4);
/// Latency from a raw fault to the state: latch, synchroniser, `tripped`, state.
const RAW: Due = Due::Clocks(4);
/// Latency from a drive's fault to the state: a register, synchroniser, filter, trip, state.
const DRIVE_FAULT: Due = Due::Clocks(FILTER_CLOCKS + 6);
/// Latency from the bus to the state: the bus's register, the command's, the state.
const HOST: Due = Due::Clocks(4);
/// Latency from the encoder's lines to the state: synchroniser, filter, counter, cause, state.
const ENCODER: Due = Due::Clocks(FILTER_CLOCKS + 6);
/// Causes to which an axis that no longer follows may lead.
pub(super) const LOST: u32 = bits(&[
    Cause::FollowingError,
    Cause::Deviation,
    Cause::Saturation,
    Cause::EncoderLost,
    Cause::SoftLimitPlus,
    Cause::SoftLimitMinus,
]);
const SHORT: Lasts = Lasts::Clocks(1, FILTER_CLOCKS);
/// Part of the move in which the command is fast enough for an error to grow.
const IN_MOTION: [u64; 2] = [15, 50];

const fn row(kind: FaultKind, name: &'static str, injected: &'static str, expects: Expectation) -> FaultRow {
    FaultRow {
        kind,
        name,
        injected,
        expects,
    }
}

/// A fault with this cause and this latest time.
const fn fault(cause: Cause, due: Due) -> Expectation {
    Expectation {
        causes: cause.bit(),
        due,
        ..FAULT
    }
}

/// All kinds of faults of a machine with loops, without those of its compare and capture.
pub const TABLE: [FaultRow; 44] = [
    row(
        FaultKind::EmergencyStop,
        "emergency stop",
        "`emergency_stop_n` low, for longer than the filter or for good",
        Expectation {
            hit: Hit::Stage,
            also: bits(&[Cause::PwmTripped]),
            lasts: Lasts::HeldOrClocks(FILTER_CLOCKS + 1, 4000),
            ..fault(Cause::EmergencyStop, LINE)
        },
    ),
    row(
        FaultKind::EmergencyStopGlitch,
        "emergency stop, glitch",
        "the same, no longer than the filter",
        Expectation {
            hit: Hit::Stage,
            lasts: SHORT,
            ..NOTHING
        },
    ),
    row(
        FaultKind::PllUnlocked,
        "PLL unlocked",
        "`pll_locked` low, from one clock on",
        Expectation {
            hit: Hit::Stage,
            gates_at_once: true,
            lasts: Lasts::HeldOrClocks(1, 4000),
            ..fault(Cause::PwmTripped, RAW)
        },
    ),
    row(
        FaultKind::RawFault,
        "raw fault",
        "`fault_n` low",
        Expectation {
            gates_at_once: true,
            lasts: Lasts::HeldOrClocks(2, 4000),
            ..fault(Cause::PwmTripped, RAW)
        },
    ),
    row(
        FaultKind::RawFaultOneClock,
        "raw fault, one clock",
        "`fault_n` low for one clock",
        Expectation {
            gates_at_once: true,
            lasts: Lasts::Clocks(1, 1),
            ..fault(Cause::PwmTripped, RAW)
        },
    ),
    row(
        FaultKind::DriveFault,
        "drive's fault",
        "`drive_fault_n` low, for longer than the filter or for good",
        Expectation {
            lasts: Lasts::HeldOrClocks(FILTER_CLOCKS + 1, 4000),
            ..fault(Cause::PwmTripped, DRIVE_FAULT)
        },
    ),
    row(
        FaultKind::DriveFaultGlitch,
        "drive's fault, glitch",
        "the same, no longer than the filter",
        Expectation {
            lasts: SHORT,
            ..NOTHING
        },
    ),
    row(
        FaultKind::DriveNotReady,
        "drive not ready",
        "`drive_ready` low, for longer than the filter or for good",
        Expectation {
            lasts: Lasts::HeldOrClocks(FILTER_CLOCKS + 1, 4000),
            ..fault(Cause::DriveLost, LINE)
        },
    ),
    row(
        FaultKind::DriveReadyGlitch,
        "drive not ready, glitch",
        "the same, no longer than the filter",
        Expectation {
            lasts: SHORT,
            ..NOTHING
        },
    ),
    row(
        FaultKind::LimitAhead,
        "limit switch ahead",
        "the limit switch in the direction of motion, for more than a tick or for good; the way back stays open",
        Expectation {
            causes: bits(&[Cause::LimitPlus, Cause::LimitMinus]),
            due: Due::Ticks {
                clocks: FILTER_CLOCKS + 3,
                ticks: 1,
            },
            lasts: Lasts::HeldOrClocks(FILTER_CLOCKS + 4 + TICK_CLOCKS, 4000),
            within_percent: [5, 85],
            ..FAULT
        },
    ),
    row(
        FaultKind::LimitBehind,
        "limit switch behind",
        "the limit switch of the other direction",
        Expectation {
            lasts: Lasts::HeldOrClocks(1, 4000),
            within_percent: [5, 85],
            ..NOTHING
        },
    ),
    row(
        FaultKind::LimitGlitch,
        "limit switch, glitch",
        "the limit switch ahead, no longer than the filter",
        Expectation {
            lasts: SHORT,
            ..NOTHING
        },
    ),
    row(
        FaultKind::Home,
        "home",
        "`home` high or low, for any time",
        Expectation {
            lasts: Lasts::HeldOrClocks(1, 4000),
            ..NOTHING
        },
    ),
    row(
        FaultKind::EncoderIllegal,
        "encoder, illegal transition",
        "A and B inverted together",
        Expectation {
            also: LOST,
            flag: Some(("flags", "encoder_illegal")),
            position_known: false,
            lasts: Lasts::Clocks(2 * FILTER_CLOCKS, 400),
            ..fault(Cause::EncoderError, ENCODER)
        },
    ),
    row(
        FaultKind::EncoderGlitch,
        "encoder, glitch",
        "A or B inverted, no longer than the filter",
        Expectation {
            lasts: SHORT,
            ..NOTHING
        },
    ),
    row(
        FaultKind::EncoderStuck,
        "encoder stuck",
        "A and B stay as they are",
        Expectation {
            causes: bits(&[Cause::FollowingError]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::FollowingError),
            position_known: false,
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderLineStuck,
        "encoder, one line stuck",
        "A or B stays as it is: the count dithers by one",
        Expectation {
            causes: bits(&[Cause::FollowingError, Cause::Deviation]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::FollowingError),
            position_known: false,
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderLineStuckUnwatched,
        "encoder, one line stuck, error not watched",
        "the same with `following_error_limit` 0",
        Expectation {
            causes: bits(&[Cause::Saturation, Cause::EncoderLost, Cause::Deviation]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::Lost),
            position_known: false,
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderDisconnected,
        "encoder disconnected",
        "A, B and Z low",
        Expectation {
            causes: bits(&[Cause::FollowingError, Cause::EncoderError]),
            also: LOST,
            due: Due::Seen(Seen::FollowingError),
            position_known: false,
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderReversed,
        "encoder reversed",
        "the wires of A exchanged in the move: the loop runs away",
        Expectation {
            also: LOST | bits(&[Cause::EncoderError]),
            position_known: false,
            within_percent: IN_MOTION,
            ..fault(Cause::FollowingError, Due::Seen(Seen::FollowingError))
        },
    ),
    row(
        FaultKind::EncoderReversedUnwatched,
        "encoder reversed, error not watched",
        "the same with `following_error_limit` 0",
        Expectation {
            causes: bits(&[Cause::Saturation, Cause::EncoderLost, Cause::Deviation]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::Lost),
            position_known: false,
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderReversedInHold,
        "encoder reversed in HOLD",
        "the wires of A exchanged in HOLD, and the axis 3 counts away",
        Expectation {
            causes: bits(&[Cause::FollowingError, Cause::Deviation]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::FollowingError),
            position_known: false,
            in_hold: true,
            ..FAULT
        },
    ),
    row(
        FaultKind::EncoderReversedInHoldUnwatched,
        "encoder reversed in HOLD, error not watched",
        "the same with `following_error_limit` 0",
        Expectation {
            causes: bits(&[Cause::Saturation, Cause::EncoderLost, Cause::Deviation]),
            also: LOST | bits(&[Cause::EncoderError]),
            due: Due::Seen(Seen::Lost),
            position_known: false,
            in_hold: true,
            ..FAULT
        },
    ),
    row(
        FaultKind::ScaleStuck,
        "scale stuck",
        "A and B of the scale stay as they are",
        Expectation {
            within_percent: IN_MOTION,
            ..fault(Cause::Deviation, Due::Seen(Seen::Deviation))
        },
    ),
    row(
        FaultKind::ScaleIllegal,
        "scale, illegal transition",
        "A and B of the scale inverted together",
        Expectation {
            lasts: Lasts::Clocks(2 * FILTER_CLOCKS, 400),
            ..fault(Cause::EncoderError, ENCODER)
        },
    ),
    row(
        FaultKind::Jam,
        "jam",
        "the axis stands still",
        Expectation {
            also: LOST,
            within_percent: IN_MOTION,
            ..fault(Cause::FollowingError, Due::Seen(Seen::FollowingError))
        },
    ),
    row(
        FaultKind::JamWithoutFollowingError,
        "jam, error not watched",
        "the same with `following_error_limit` 0",
        Expectation {
            causes: bits(&[Cause::Saturation, Cause::EncoderLost]),
            due: Due::Seen(Seen::Stuck),
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::HostSilent,
        "host silent",
        "`watchdog_ticks` 5, one kick, then kicks with a wrong word",
        fault(Cause::Watchdog, Due::Ticks { clocks: 2, ticks: 6 }),
    ),
    row(
        FaultKind::Flush,
        "FIFO underrun",
        "`flush` in motion: nothing follows the entry that plays",
        Expectation {
            flag: Some(("flags", "segments_underrun")),
            within_percent: [3, 50],
            ..fault(Cause::Segments, Due::Seen(Seen::Segments))
        },
    ),
    row(
        FaultKind::Overflow,
        "segments' overflow",
        "a velocity that does not fit, without monitors and with a stop at once",
        Expectation {
            flag: Some(("flags", "segments_overflow")),
            also: bits(&[Cause::Deviation, Cause::Saturation, Cause::EncoderLost]),
            ..fault(Cause::Segments, Due::Seen(Seen::Segments))
        },
    ),
    row(
        FaultKind::OutOfRange,
        "out of range",
        "a point so far away that e does not fit its word, without monitors",
        Expectation {
            also: bits(&[Cause::SoftLimitPlus, Cause::SoftLimitMinus]),
            ..fault(Cause::Range, Due::Seen(Seen::Range))
        },
    ),
    row(
        FaultKind::Malformed,
        "malformed entry",
        "an entry without ticks, one with words missing, and one with a reserved flag",
        Expectation {
            flag: Some(("flags", "segment_malformed")),
            ..NOTHING
        },
    ),
    row(
        FaultKind::FifoFull,
        "FIFO full",
        "70 entries that stand still",
        Expectation {
            flag: Some(("flags", "segment_refused")),
            within_percent: [5, 85],
            ..NOTHING
        },
    ),
    row(
        FaultKind::SoftLimit,
        "soft limit",
        "`soft_limit_plus` or `_minus` moved to where the axis is",
        Expectation {
            causes: bits(&[Cause::SoftLimitPlus, Cause::SoftLimitMinus]),
            due: Due::Seen(Seen::SoftLimit),
            within_percent: IN_MOTION,
            ..FAULT
        },
    ),
    row(
        FaultKind::Stop,
        "stop",
        "`stop` of the host",
        Expectation {
            reaction: Reaction::Halt,
            due: HOST,
            ..NOTHING
        },
    ),
    row(
        FaultKind::Disable,
        "disable",
        "`enable` low in the move",
        Expectation {
            reaction: Reaction::Disable,
            due: HOST,
            ..NOTHING
        },
    ),
    row(
        FaultKind::Reset,
        "reset",
        "`rst` for 1 to 40 clocks",
        Expectation {
            hit: Hit::Stage,
            reaction: Reaction::Reset,
            causes: bits(&[Cause::PwmTripped]),
            due: Due::Clocks(1),
            gates_at_once: false,
            lasts: Lasts::Clocks(1, 40),
            ..FAULT
        },
    ),
    row(
        FaultKind::SettingRefused,
        "settings of garbage",
        "random settings for the bank in use, and for one that there is not",
        Expectation {
            flag: Some(("events", "setting_refused")),
            ..NOTHING
        },
    ),
    row(
        FaultKind::NoGains,
        "settings all 0",
        "the law's bank 3 committed: the drive is told to stand",
        Expectation {
            also: LOST,
            within_percent: IN_MOTION,
            ..fault(Cause::FollowingError, Due::Seen(Seen::FollowingError))
        },
    ),
    row(
        FaultKind::TableHandover,
        "another tap table",
        "a table of one tap is loaded, and swapped to by handover",
        NOTHING,
    ),
    row(
        FaultKind::PresetOrigin,
        "preset of the position",
        "the user's position becomes another; the loop's count does not",
        NOTHING,
    ),
    row(
        FaultKind::ClearFaults,
        "clear_faults",
        "`clear_faults` with nothing to clear",
        NOTHING,
    ),
    row(
        FaultKind::StartAgain,
        "start again",
        "`start` of both axes in the move",
        Expectation {
            hit: Hit::Stage,
            ..NOTHING
        },
    ),
    row(
        FaultKind::DirectMode,
        "direct mode",
        "a manual duty in the move",
        Expectation {
            others: Others::GoOn,
            ..NOTHING
        },
    ),
];
