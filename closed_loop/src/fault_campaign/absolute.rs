//! The machine of the campaign with absolute encoders, and the faults of such a machine.
//!
//! X has an encoder with SSI, Y one with BiSS-C, and neither has a scale.

use posicast_blocks::absolute_encoder::{AbsoluteFrame, AbsoluteProtocol, AbsoluteTimesInSeconds, FrameCheck};
use posicast_blocks::axis::Cause;
use posicast_machine::machine_file::{AbsoluteSection, AxisSection, LimitsSection};

use super::expectation::{Due, Expectation, FAULT, Lasts, NOTHING, bits};
use super::kind::{FaultKind, FaultRow, LOST, TABLE};
use super::machine::TICK_CLOCKS;
use super::positions;

/// Bits of a position: so few that a reading over SSI and the controllers fit into a tick. The moves are of some hundred counts.
pub(super) const BITS: u32 = 14;
/// Readings in a row that may fail.
const TOLERATED: u32 = 2;

/// Faults of [`TABLE`] that a machine with absolute encoders has too, with the same reaction.
const COMMON: [FaultKind; 28] = [
    FaultKind::EmergencyStop,
    FaultKind::EmergencyStopGlitch,
    FaultKind::PllUnlocked,
    FaultKind::RawFault,
    FaultKind::RawFaultOneClock,
    FaultKind::DriveFault,
    FaultKind::DriveFaultGlitch,
    FaultKind::DriveNotReady,
    FaultKind::DriveReadyGlitch,
    FaultKind::LimitAhead,
    FaultKind::LimitBehind,
    FaultKind::LimitGlitch,
    FaultKind::Home,
    FaultKind::Jam,
    FaultKind::HostSilent,
    FaultKind::Flush,
    FaultKind::Overflow,
    FaultKind::Malformed,
    FaultKind::FifoFull,
    FaultKind::SoftLimit,
    FaultKind::Stop,
    FaultKind::Disable,
    FaultKind::SettingRefused,
    FaultKind::NoGains,
    FaultKind::TableHandover,
    FaultKind::PresetOrigin,
    FaultKind::ClearFaults,
    FaultKind::StartAgain,
];

/// Replaces the encoder of an axis by an absolute one.
pub(super) fn change(axis: &mut AxisSection) {
    let is_ssi = axis.name == "x";
    let (protocol, frame, line_hz) = if is_ssi {
        let frame = AbsoluteFrame {
            gray: true,
            check: FrameCheck::EvenParity,
            ..AbsoluteFrame::ssi(BITS)
        };
        (AbsoluteProtocol::Ssi, frame, 2e6)
    } else {
        (AbsoluteProtocol::BissC, AbsoluteFrame::biss_c(BITS), 10e6)
    };
    if let Some(encoder) = &mut axis.encoder {
        (encoder.filter_clocks, encoder.index) = (0, false);
        encoder.absolute = Some(AbsoluteSection {
            protocol,
            frame,
            times: AbsoluteTimesInSeconds {
                line_hz,
                pause_s: 4e-6,
                answer_s: 4e-6,
            },
            tolerated: TOLERATED,
            offset: 1 << (BITS - 1),
            cable_m: Some(10.0),
        });
    }
    (axis.scale, axis.compare) = (None, None);
    axis.limits = axis.limits.map(|limits| LimitsSection {
        deviation: None,
        ..limits
    });
}

/// Readings that fail for good: one more than may, and the tick after the last one shows it. The controller stops then, so the PWM
/// trips by its watchdog where the cause does not switch off.
const LOSES: Expectation = Expectation {
    causes: bits(&[Cause::EncoderError]),
    also: LOST | bits(&[Cause::PwmTripped]),
    due: Due::Ticks {
        clocks: 0,
        ticks: TOLERATED as u64 + 2,
    },
    flag: Some(("flags", "encoder_lost")),
    position_known: false,
    ..FAULT
};

/// The kinds of faults.
pub(super) fn rows() -> Vec<FaultRow> {
    let common = TABLE.into_iter().filter(|row| COMMON.contains(&row.kind));
    let own = [
        FaultRow {
            kind: FaultKind::AbsoluteStuck,
            name: "encoder's data stuck",
            injected: "`encoder_data` stays high, or low",
            expects: LOSES,
        },
        FaultRow {
            kind: FaultKind::AbsoluteBit,
            name: "encoder, wrong bit",
            injected: "one bit of every frame inverted",
            expects: LOSES,
        },
        FaultRow {
            kind: FaultKind::AbsoluteBrief,
            name: "encoder, few wrong readings",
            injected: "one bit of as many frames inverted as may fail",
            expects: Expectation {
                lasts: Lasts::Clocks(1, (TOLERATED as u64 - 1) * TICK_CLOCKS),
                ..NOTHING
            },
        },
    ];
    common.chain(own).chain(positions::rows::of_absolute()).collect()
}
