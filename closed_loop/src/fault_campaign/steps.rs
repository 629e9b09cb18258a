//! The machine of the campaign with step inputs, and the faults of such a machine.
//!
//! A scale at the load watches the steps. The drives are ideal: what is tested is the stage, not the motor.

use posicast_blocks::axis::Cause;
use posicast_blocks::step_generator::{StepLinesActiveLow, StepMode, StepTimesInSeconds};
use posicast_machine::machine_file::{AxisSection, LimitsSection, StepsSection};

use super::expectation::{Due, Expectation, FAULT, Lasts, NOTHING, Seen, bits};
use super::kind::{FaultKind, FaultRow, TABLE};
use super::machine::{STALL_TICKS, TICK_CLOCKS, TICK_S};
use super::positions;

/// A million steps per second, four times the largest velocity.
const TIMES: StepTimesInSeconds = StepTimesInSeconds {
    pulse_s: 500e-9,
    space_s: 500e-9,
    direction_setup_s: 400e-9,
    direction_hold_s: 200e-9,
};

/// Faults of [`TABLE`] that a machine with steps has too, with the same reaction.
const COMMON: [FaultKind; 23] = [
    FaultKind::EmergencyStop,
    FaultKind::EmergencyStopGlitch,
    FaultKind::DriveNotReady,
    FaultKind::DriveReadyGlitch,
    FaultKind::LimitAhead,
    FaultKind::LimitBehind,
    FaultKind::LimitGlitch,
    FaultKind::Home,
    FaultKind::ScaleStuck,
    FaultKind::ScaleIllegal,
    FaultKind::Jam,
    FaultKind::HostSilent,
    FaultKind::Flush,
    FaultKind::Malformed,
    FaultKind::FifoFull,
    FaultKind::SoftLimit,
    FaultKind::Stop,
    FaultKind::Disable,
    FaultKind::Reset,
    FaultKind::TableHandover,
    FaultKind::PresetOrigin,
    FaultKind::ClearFaults,
    FaultKind::StartAgain,
];
/// Part of the move in which so many steps are missed that the scale shows it.
const IN_MOTION: [u64; 2] = [15, 50];

/// Longest excursion in clocks: shorter than a stall by the time in which it goes and comes back.
const LONGEST_EXCURSION: u64 = (STALL_TICKS - 3) * TICK_CLOCKS;

/// Replaces the loop of an axis by steps.
pub(super) fn change(axis: &mut AxisSection) {
    (axis.encoder, axis.pwm, axis.drive, axis.controller) = (None, None, None, None);
    axis.steps = Some(StepsSection {
        mode: StepMode::StepDirection,
        times: TIMES,
        active_low: StepLinesActiveLow::default(),
        owed_limit: None,
    });
    axis.limits = axis.limits.map(|limits| LimitsSection {
        following_error: None,
        saturation_s: 0.0,
        encoder_lost_s: 0.0,
        // A stall acts once it has lasted.
        deviation_s: STALL_TICKS as f64 * TICK_S,
        ..limits
    });
}

/// A fault that only the scale shows.
const DEVIATES: Expectation = Expectation {
    causes: bits(&[Cause::Deviation]),
    also: bits(&[Cause::EncoderError]),
    due: Due::Seen(Seen::Deviation),
    within_percent: IN_MOTION,
    ..FAULT
};

/// The kinds of faults.
pub(super) fn rows() -> Vec<FaultRow> {
    let common = TABLE.into_iter().filter(|row| COMMON.contains(&row.kind));
    let common = common.map(|row| match row.kind {
        // The motor stands: the drive has taken all steps.
        FaultKind::Jam => FaultRow {
            name: "stall",
            injected: "the motor stands while steps come",
            expects: DEVIATES,
            ..row
        },
        // There is no PWM that is tripped after a reset.
        FaultKind::Reset => FaultRow {
            expects: Expectation {
                causes: 0,
                ..row.expects
            },
            ..row
        },
        _ => row,
    });
    let own = [
        FaultRow {
            kind: FaultKind::StepsCut,
            name: "step line cut",
            injected: "the drive sees no step",
            expects: Expectation {
                position_known: false,
                ..DEVIATES
            },
        },
        FaultRow {
            kind: FaultKind::StepsReversed,
            name: "direction reversed",
            injected: "the drive sees the direction inverted",
            expects: Expectation {
                position_known: false,
                ..DEVIATES
            },
        },
        FaultRow {
            kind: FaultKind::Excursion,
            name: "short excursion",
            injected: "the load is displaced beyond `limits.deviation`, for less than `limits.deviation_s`",
            expects: Expectation {
                lasts: Lasts::Clocks(TICK_CLOCKS, LONGEST_EXCURSION),
                ..NOTHING
            },
        },
        FaultRow {
            kind: FaultKind::TooFast,
            name: "too fast",
            injected: "a point so far away that no step generator gives its steps",
            expects: Expectation {
                causes: bits(&[Cause::PwmTripped]),
                also: bits(&[Cause::SoftLimitPlus, Cause::SoftLimitMinus, Cause::Segments]),
                due: Due::Seen(Seen::StepsTripped),
                flag: Some(("flags", "steps_too_fast")),
                ..FAULT
            },
        },
    ];
    common.chain(own).chain(positions::rows::of_steps()).collect()
}
