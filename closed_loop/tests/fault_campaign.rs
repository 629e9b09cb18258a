//! The fault campaign: a share of its cases on the model, a few with the RTL beside it, and stages that react more
//! slowly than stated.
//!
//! `scripts/verify-all` runs all cases, with the example of the same name.

use std::thread;

use posicast_blocks::axis::Cause;
use posicast_blocks::component::Component;
use posicast_blocks::stage::{Follower, StageConfig, Supervision};
use posicast_closed_loop::fault_campaign::{Bed, FaultKind, FaultReport, run, run_with_rtl};
use posicast_closed_loop::stage_bench::{Wire, state};
use posicast_machine::machine_file::{self, Machine, PwmMode};
use posicast_machine::motion::{TickLimits, plan_move};
use posicast_machine::plant::axis::PlantOptions;
use posicast_testbench::Error;
use posicast_testbench::blocks::Sources;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::lockstep::Device;

use crate::support::{bench, stage};

/// Number of cases of every kind.
const ROUNDS: u64 = 1;
const SEED: u64 = 7;

fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Returns the first case of a kind.
fn number(bed: &Bed, kind: FaultKind) -> u64 {
    bed.rows.iter().position(|row| row.kind == kind).unwrap() as u64
}

/// Runs one case of that kind on a machine whose stage has a supervision that differs from the expected one.
fn on_a_changed_stage(kind: FaultKind, change: fn(&mut Supervision)) -> FaultReport {
    on_a_changed(Bed::new().unwrap(), kind, change)
}

fn on_a_changed(bed: Bed, kind: FaultKind, change: fn(&mut Supervision)) -> FaultReport {
    on_another(bed, kind, |config| {
        for axis in &mut config.axes {
            change(&mut axis.supervision);
        }
    })
}

/// Runs one case of that kind on a stage of another configuration; the expectations do not change.
fn on_another(mut bed: Bed, kind: FaultKind, change: impl Fn(&mut StageConfig)) -> FaultReport {
    let mut config = bed.stage.config.clone();
    change(&mut config);
    bed.component = Component::stage(&config).unwrap();
    let first = number(&bed, kind);
    run(&bed, first..first + 1, SEED, 1).unwrap()
}

#[track_caller]
fn assert_says(report: &FaultReport, what: &str) {
    let failures = report.failures();
    assert!(failures.iter().any(|failure| failure.contains(what)), "{failures:#?}");
}

#[test]
fn every_fault_is_handled_as_stated() {
    let bed = Bed::new().unwrap();
    let report = run(&bed, 0..ROUNDS * bed.rows.len() as u64, SEED, threads()).unwrap();
    assert_eq!(report.failures(), [""; 0], "{report}");
    assert!(report.kinds().len() == 58 && report.kinds().iter().all(|kind| kind.cases == ROUNDS));
}

#[test]
fn every_fault_of_an_axis_with_steps_is_handled_as_stated() {
    let bed = Bed::with_steps().unwrap();
    let report = run(&bed, 0..ROUNDS * bed.rows.len() as u64, SEED, threads()).unwrap();
    assert_eq!(report.failures(), [""; 0], "{report}");
    assert!(report.kinds().len() == 38 && report.kinds().iter().all(|kind| kind.cases == ROUNDS));
}

#[test]
fn every_fault_of_an_axis_with_an_absolute_encoder_is_handled_as_stated() {
    let bed = Bed::with_absolute_encoders().unwrap();
    let report = run(&bed, 0..ROUNDS * bed.rows.len() as u64, SEED, threads()).unwrap();
    assert_eq!(report.failures(), [""; 0], "{report}");
    assert!(report.kinds().len() == 38 && report.kinds().iter().all(|kind| kind.cases == ROUNDS));
}

#[test]
fn long_lockstep_faults_with_the_rtl_beside_the_model() {
    let bed = Bed::new().unwrap();
    let block = ComponentBlock::new(bed.component.clone(), "xy_stage", "xy");
    let sources = Sources::write(&block).unwrap();
    let device = || -> Result<Box<dyn Device>, Error> { Ok(Box::new(sources.verilated(&block, 1)?)) };
    for (kind, cases) in [
        (FaultKind::RawFaultOneClock, 3),
        (FaultKind::ProbeFull, 1),
        (FaultKind::CompareFast, 1),
    ] {
        let first = number(&bed, kind);
        let report = run_with_rtl(&bed, first..first + cases, SEED, device).unwrap();
        assert_eq!(report.failures(), [""; 0], "{report}");
    }
}

#[test]
fn long_a_lost_encoder_is_seen_in_every_mode_of_pwm_and_encoder() {
    // A half bridge pushes in one direction only and cannot do these moves: it is in the test below.
    for mode in [PwmMode::Direction, PwmMode::FullBridge, PwmMode::LockedAntiphase] {
        for (filter_clocks, drive) in [(0, 0.5), (8, 0.6), (16, 0.5)] {
            let bed = Bed::of(|axis| {
                axis.pwm.as_mut().unwrap().mode = mode;
                axis.encoder.as_mut().unwrap().filter_clocks = filter_clocks;
                // Only the supervision of the encoder can detect it: there is no scale to compare with, and no time
                // of saturation.
                let limits = axis.limits.as_mut().unwrap();
                (limits.deviation, limits.saturation_s) = (None, 0.0);
                limits.encoder_lost_command = drive;
            });
            let bed = bed.unwrap();
            for kind in [FaultKind::EncoderLineStuck, FaultKind::EncoderLineStuckUnwatched] {
                let cases = (0..3).map(|round| number(&bed, kind) + round * bed.rows.len() as u64);
                for case in cases {
                    let report = run(&bed, case..case + 1, SEED, 1).unwrap();
                    // The gains are those of another mode: the end position of small moves is not tested here.
                    let mut failures = report.failures().to_vec();
                    failures.retain(|failure| !failure.ends_with("after the fault"));
                    assert_eq!(failures, [""; 0], "{mode:?}, filter {filter_clocks}: {report}");
                }
            }
        }
    }
}

/// A machine on which an encoder with one stuck line was once not detected: it moved 118,622 counts at full speed,
/// without a cause.
const LOST_ENCODER: &str = include_str!("fixtures/lost-encoder.toml");

#[test]
fn a_line_that_is_stuck_stops_the_machine_without_a_following_error() {
    for mode in [
        PwmMode::Direction,
        PwmMode::HalfBridge,
        PwmMode::FullBridge,
        PwmMode::LockedAntiphase,
    ] {
        let mut machine = machine_file::parse("lost-encoder.toml", LOST_ENCODER).unwrap();
        machine.axes[0].pwm.as_mut().unwrap().mode = mode;
        stuck_lines_stop(&machine);
    }
}

/// Each line sticks, at each level, at full speed.
fn stuck_lines_stop(machine: &Machine) {
    let stage = stage(machine);
    let watched = stage.config.axes[0].supervision;
    assert_eq!((watched.following_error_limit, watched.lost_ticks), (0, 100));
    for stuck in 0..4 {
        let mut bench = bench(machine, &stage, &PlantOptions::default(), None, SEED);
        assert!(bench.switch_on(200_000).unwrap());
        let limits = TickLimits::of_axis(&machine.axes[0], &machine.clock);
        for entry in plan_move(0, 200_000 << 8, &limits).unwrap() {
            bench.segment("x", &entry).unwrap();
        }
        bench.write("start", 1).unwrap();
        bench.clocks(200_000).unwrap();
        let (at, lines) = (bench.plant(0).count(), bench.plant(0).encoder());
        let wires = [
            Wire::AStuck(lines.a),
            Wire::BStuck(lines.b),
            Wire::AStuck(!lines.a),
            Wire::BStuck(!lines.b),
        ];
        bench.break_wire(0, Some(wires[stuck]));
        assert!(bench.wait("x", state::FAULT, 1_000_000).unwrap(), "{stuck}: it runs on");
        assert_ne!(
            u64::from(Cause::EncoderLost.bit()) & bench.net("x_causes").unwrap(),
            0,
            "{stuck}"
        );
        // The bound is full speed for the time of the supervision, plus the parts before and after.
        let on = (bench.plant(0).count() - at).abs();
        assert!(on < 150 * 50, "{stuck}: {on} counts");
    }
}

/// Only the supervision of the encoder detects it with a velocity drive; `wrong_sign.rs` tests torque drives.
#[test]
fn a_wrong_sign_is_seen_by_the_watch_of_the_encoder_alone() {
    let bed = Bed::of(|axis| {
        let limits = axis.limits.as_mut().unwrap();
        (limits.deviation, limits.saturation_s) = (None, 0.0);
    });
    let bed = bed.unwrap();
    for kind in [
        FaultKind::EncoderReversedUnwatched,
        FaultKind::EncoderReversedInHoldUnwatched,
    ] {
        for case in (0..4).map(|round| number(&bed, kind) + round * bed.rows.len() as u64) {
            let report = run(&bed, case..case + 1, SEED, 1).unwrap();
            assert_eq!(report.failures(), [""; 0], "{report}");
        }
    }
}

#[test]
fn mutate_a_watch_of_motion_alone_does_not_see_a_wrong_sign() {
    for kind in [
        FaultKind::EncoderReversedUnwatched,
        FaultKind::EncoderReversedInHoldUnwatched,
    ] {
        let report = on_a_changed_stage(kind, |watched| {
            (watched.deviation_limit, watched.saturation_ticks) = (0, 0);
            watched.watches_direction = false;
        });
        assert_ne!(report.failures(), [""; 0], "{kind:?}");
    }
}

#[test]
fn mutate_a_deviation_that_acts_at_once_stops_at_an_excursion() {
    let report = on_a_changed(Bed::with_steps().unwrap(), FaultKind::Excursion, |watched| {
        watched.deviation_ticks = 0;
    });
    assert_says(&report, &format!("causes {:#x}", Cause::Deviation.bit()));
}

#[test]
fn mutate_a_slower_filter_is_late() {
    let report = on_a_changed_stage(FaultKind::EmergencyStop, |watched| watched.filter_clocks += 1);
    assert_says(&report, "1 clocks late");
}

#[test]
fn mutate_a_longer_stop_is_late() {
    let report = on_a_changed_stage(FaultKind::Stop, |watched| watched.settle_ticks += 40);
    assert_says(&report, "a quick stop of");
}

#[test]
fn mutate_a_late_count_shows_in_pulses_and_captures() {
    // A pulse shows one clock; a captured position shows it where a count changed meanwhile.
    for (kind, late_clocks, what) in [
        (FaultKind::CompareReversal, 1, "compare: "),
        (FaultKind::CompareFast, 1, "compare: "),
        (FaultKind::ProbeTaken, 32, "capture: Entry"),
    ] {
        let report = on_another(Bed::new().unwrap(), kind, |config| {
            for axis in &mut config.axes {
                if let Follower::Loop(of) = &mut axis.follower {
                    of.encoder_filter_clocks += late_clocks;
                }
            }
        });
        assert_says(&report, what);
    }
}
