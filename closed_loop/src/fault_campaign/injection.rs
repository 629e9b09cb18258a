//! Injects each kind of fault, and removes it again.

use posicast_blocks::axis::KICK;
use posicast_blocks::segments::{Entry, EntryMotion, Point};
use posicast_machine::plant::axis::{AbsoluteFault, EncoderPins};

use super::absolute::BITS;
use super::case::Case;
use super::kind::FaultKind;
use crate::stage_bench::{StageBench, StepWire, Wire};
use posicast_testbench::Error;

/// Number of ticks of the watchdog.
const WATCHDOG_TICKS: u32 = 5;
/// Jerk that makes the velocity exceed its word within a few ticks, Q8.32 counts per tick³.
const HUGE_JERK: i64 = 127 << 32;
/// Number of entries, more than the FIFO takes.
const MANY_ENTRIES: usize = 70;
/// Value for a handover to bank 1: `swap_bank` and `swap_how`.
const SWAP_TO_1: u32 = 1 | 1 << 4;
/// Value of the register `law`: PD with the settings of bank 3, which are all 0.
const NO_SETTINGS: u32 = 1 | 3 << 8;
/// Entry that makes the velocity exceed its word.
const OVERFLOWING: Entry = Entry {
    ticks: 100,
    motion: EntryMotion::Jerk(HUGE_JERK),
    notify: false,
};

/// Distance in counts by which an axis leaves its command for a short time, and the part of it that it moves at once, so
/// that the counter follows.
const EXCURSION_COUNTS: u32 = 75;
const EXCURSION_PART: u32 = 3;
/// Clocks for such a part.
const EXCURSION_PART_CLOCKS: u64 = 100;
/// Size of a disturbance in counts.
const PUSH_COUNTS: f64 = 3.0;
/// Distance in counts to a point that is within the position word, but so far away that e exceeds its own word.
const FAR_COUNTS: i32 = 4_000_000;

/// Returns the last entry of the move if the fault is an entry.
pub(super) fn last_entry(case: &Case, axis: usize) -> Option<Entry> {
    let side = case.counts[axis].signum() as i32;
    match case.row.kind {
        FaultKind::Overflow => Some(OVERFLOWING),
        FaultKind::OutOfRange | FaultKind::TooFast => Some(Entry {
            ticks: 1,
            motion: EntryMotion::Point(Point {
                position: (side * FAR_COUNTS) << 8,
                velocity: 0,
                acceleration: 0,
            }),
            notify: false,
        }),
        _ => None,
    }
}

/// Returns the name of the axis's line and its faulty level if the fault is on such a line.
fn line(case: &Case, axis: usize) -> Option<(&'static str, u64)> {
    let forward = case.counts[axis] > 0;
    Some(match case.row.kind {
        FaultKind::RawFault | FaultKind::RawFaultOneClock => ("fault_n", 0),
        FaultKind::DriveFault | FaultKind::DriveFaultGlitch => ("drive_fault_n", 0),
        FaultKind::DriveNotReady | FaultKind::DriveReadyGlitch => ("drive_ready", 0),
        FaultKind::LimitAhead | FaultKind::LimitGlitch if forward => ("limit_plus_n", 0),
        FaultKind::LimitAhead | FaultKind::LimitGlitch => ("limit_minus_n", 0),
        FaultKind::LimitBehind if forward => ("limit_minus_n", 0),
        FaultKind::LimitBehind => ("limit_plus_n", 0),
        FaultKind::Home => ("home", 1),
        _ => return None,
    })
}

/// Returns the name of the shared line if the fault is on one. Its faulty level is low.
fn shared_line(kind: FaultKind) -> Option<&'static str> {
    match kind {
        FaultKind::EmergencyStop | FaultKind::EmergencyStopGlitch => Some("emergency_stop_n"),
        FaultKind::PllUnlocked => Some("pll_locked"),
        _ => None,
    }
}

/// Injects the fault from the next clock on, or by writes that begin in it.
pub(super) fn begin(bench: &mut StageBench, case: &Case) -> Result<(), Error> {
    if let Some(line) = shared_line(case.row.kind) {
        return bench.set(line, 0);
    }
    match case.row.kind {
        FaultKind::Reset => return bench.set("rst", 1),
        FaultKind::StartAgain => return bench.write("start", 3),
        FaultKind::Excursion => return excursion(bench, case, 1.0),
        _ => {}
    }
    for axis in case.hit_axes() {
        let name = bench.axes()[axis].clone();
        match line(case, axis) {
            Some((line, level)) => bench.set(&format!("{name}_{line}"), level)?,
            None => begin_at(bench, case, axis, &name)?,
        }
    }
    if case.row.kind == FaultKind::NoGains {
        bench.write("commit", 0)?;
    }
    Ok(())
}

/// Injects, at an axis, a fault that is not a line.
fn begin_at(bench: &mut StageBench, case: &Case, axis: usize, name: &str) -> Result<(), Error> {
    let register = |register: &str| format!("{name}_{register}");
    let lines = bench.plant(axis).encoder();
    match case.row.kind {
        FaultKind::EncoderIllegal => bench.force_encoder(axis, Some(inverted(lines))),
        FaultKind::EncoderGlitch => {
            let a = case.choice & 1 != 0;
            let (a, b) = (lines.a ^ a, lines.b ^ !a);
            bench.force_encoder(axis, Some(EncoderPins { a, b, ..lines }));
        }
        FaultKind::EncoderStuck => bench.force_encoder(axis, Some(lines)),
        FaultKind::EncoderDisconnected => bench.force_encoder(axis, Some(EncoderPins::default())),
        FaultKind::EncoderLineStuck => bench.break_wire(axis, Some(stuck(case, lines))),
        FaultKind::EncoderLineStuckUnwatched => {
            without_following_error(bench, name)?;
            bench.break_wire(axis, Some(stuck(case, lines)));
        }
        FaultKind::EncoderReversed => bench.break_wire(axis, Some(Wire::AInverted)),
        FaultKind::EncoderReversedUnwatched => {
            without_following_error(bench, name)?;
            bench.break_wire(axis, Some(Wire::AInverted));
        }
        FaultKind::EncoderReversedInHold => reverse_and_push(bench, case, axis),
        FaultKind::EncoderReversedInHoldUnwatched => {
            without_following_error(bench, name)?;
            reverse_and_push(bench, case, axis);
        }
        FaultKind::ScaleStuck => bench.force_scale(axis, Some(bench.plant(axis).scale())),
        FaultKind::ScaleIllegal => bench.force_scale(axis, Some(inverted(bench.plant(axis).scale()))),
        FaultKind::AbsoluteStuck => {
            bench.fault_absolute_encoder(axis, Some(AbsoluteFault::Stuck(case.choice & 1 != 0)));
        }
        FaultKind::AbsoluteBit | FaultKind::AbsoluteBrief => {
            bench.fault_absolute_encoder(axis, Some(AbsoluteFault::Inverted(case.choice % BITS)));
        }
        FaultKind::StepsCut => bench.break_step_wire(axis, Some(StepWire::Cut)),
        FaultKind::StepsReversed => bench.break_step_wire(axis, Some(StepWire::Reversed)),
        FaultKind::Jam => bench.jam(axis, true),
        FaultKind::JamWithoutFollowingError => {
            without_following_error(bench, name)?;
            bench.jam(axis, true);
        }
        FaultKind::HostSilent => {
            bench.write(&register("kick"), KICK)?;
            bench.write(&register("watchdog"), WATCHDOG_TICKS | u32::from(case.off_causes) << 16)?;
            bench.write(&register("kick"), KICK ^ (1 << (case.choice % 32)))?;
        }
        FaultKind::Flush => bench.write(&register("flush"), 0)?,
        FaultKind::OutOfRange | FaultKind::TooFast => without_following_error(bench, name)?,
        FaultKind::Overflow => {
            without_following_error(bench, name)?;
            bench.write(&register("stop_deceleration"), 0)?;
        }
        FaultKind::Malformed => malformed(bench, name)?,
        FaultKind::FifoFull => {
            let still = Entry {
                ticks: 1,
                motion: EntryMotion::Jerk(0),
                notify: false,
            };
            for _ in 0..MANY_ENTRIES {
                bench.segment(name, &still)?;
            }
        }
        FaultKind::SoftLimit => {
            let at = bench.net(&register("shaped_position"))? as u32;
            let side = if case.counts[axis] > 0 { "plus" } else { "minus" };
            bench.write(&register(&format!("soft_limit_{side}")), at)?;
        }
        FaultKind::Stop => bench.write(&register("stop"), 0)?,
        FaultKind::Disable => bench.write(&register("control"), 0)?,
        FaultKind::SettingRefused => {
            for bank in [0, 3] {
                bench.write(&register("setting_address"), (case.choice % 16) | (bank << 8))?;
                bench.write(&register("setting"), case.choice)?;
            }
        }
        FaultKind::NoGains => bench.write(&register("law"), NO_SETTINGS)?,
        FaultKind::TableHandover => {
            let one = 1 << bench.read(&register("coefficient_fraction"))?;
            bench.write(&register("tap_address"), 1 << 8)?;
            bench.write(&register("tap"), one)?;
            bench.write(&register("swap"), SWAP_TO_1)?;
        }
        FaultKind::PresetOrigin => bench.write(&register("preset"), case.choice)?,
        FaultKind::ClearFaults => bench.write(&register("clear_faults"), 0)?,
        FaultKind::DirectMode => {
            bench.write(&register("control"), 0b11)?;
            bench.write(&register("direct"), case.choice & 0x1_ffff)?;
        }
        _ => {}
    }
    Ok(())
}

/// Switches the check of the following error off, if the axis has one.
fn without_following_error(bench: &mut StageBench, name: &str) -> Result<(), Error> {
    let register = format!("{name}_following_error_limit");
    if bench.has(&register) {
        bench.write(&register, 0)?;
    }
    Ok(())
}

/// Exchanges the wires of A, and adds a disturbance, which the loop then makes larger.
fn reverse_and_push(bench: &mut StageBench, case: &Case, axis: usize) {
    bench.break_wire(axis, Some(Wire::AInverted));
    bench.displace(axis, PUSH_COUNTS * case.counts[axis].signum() as f64);
}

/// Displaces the axes that are hit, all at the same time; with −1 for `way`, back.
fn excursion(bench: &mut StageBench, case: &Case, way: f64) -> Result<(), Error> {
    let side = if case.choice & 1 == 0 { way } else { -way };
    for _ in 0..EXCURSION_COUNTS / EXCURSION_PART {
        for axis in case.hit_axes() {
            bench.displace(axis, side * f64::from(EXCURSION_PART));
        }
        bench.clocks(EXCURSION_PART_CLOCKS)?;
    }
    Ok(())
}

/// Holds A or B at its level.
fn stuck(case: &Case, lines: EncoderPins) -> Wire {
    match case.choice & 1 {
        0 => Wire::AStuck(lines.a),
        _ => Wire::BStuck(lines.b),
    }
}

/// Inverts A and B.
fn inverted(lines: EncoderPins) -> EncoderPins {
    EncoderPins {
        a: !lines.a,
        b: !lines.b,
        ..lines
    }
}

/// Writes entries that are dropped: without ticks, without word 0, with a reserved flag.
fn malformed(bench: &mut StageBench, name: &str) -> Result<(), Error> {
    let mut words = |entry: &[(usize, u32)]| {
        let mut writes = entry.iter();
        writes.try_for_each(|(word, data)| bench.write_word(&format!("{name}_segment"), *word, *data))
    };
    words(&[(0, 5), (1, 0), (3, 0)])?;
    words(&[(1, 0), (3, 7)])?;
    words(&[(0, 5), (1, 0), (3, 7 | 1 << 24)])
}

/// Removes a fault that lasts. `way_back` leaves a limit switch active, since the axis must be able to move away from
/// it.
pub(super) fn end(bench: &mut StageBench, case: &Case, way_back: bool) -> Result<(), Error> {
    let kind = case.row.kind;
    if kind == FaultKind::Reset {
        return bench.set("rst", 0);
    }
    if kind == FaultKind::Excursion {
        return excursion(bench, case, -1.0);
    }
    if let Some(line) = shared_line(kind) {
        return bench.set(line, 1);
    }
    for axis in case.hit_axes() {
        let name = bench.axes()[axis].clone();
        let register = |register: &str| format!("{name}_{register}");
        match line(case, axis) {
            Some(_) if way_back && kind == FaultKind::LimitAhead => {}
            Some((line, level)) => bench.set(&register(line), 1 - level)?,
            None => {}
        }
        bench.force_encoder(axis, None);
        bench.fault_absolute_encoder(axis, None);
        bench.break_wire(axis, None);
        bench.break_step_wire(axis, None);
        bench.force_scale(axis, None);
        bench.jam(axis, false);
        match kind {
            FaultKind::DirectMode => bench.write(&register("control"), 1)?,
            FaultKind::HostSilent => bench.write(&register("watchdog"), u32::from(case.off_causes) << 16)?,
            FaultKind::NoGains => bench.write(&register("law"), 1)?,
            _ => {}
        }
    }
    if kind == FaultKind::NoGains {
        bench.write("commit", 0)?;
    }
    Ok(())
}
