//! A feedback of the wrong sign: the loop runs away, in HOLD from the smallest disturbance. It must trip after few
//! ticks and counts; a healthy machine must not trip, however it stops.

use posicast_blocks::axis::Cause;
use posicast_closed_loop::stage_bench::{StageBench, Wire, state};
use posicast_machine::control::{LostSign, lost_sign};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plant::axis::PlantOptions;

use crate::support::{self, XY, queue_move, stage};

const TORQUE: &str = include_str!("../../examples/xy-stage-torque.toml");
const SEED: u64 = 11;
/// Time of the supervision: 300 ticks.
const LOST_S: f64 = 0.03;
/// Largest number of ticks until the supervision has tripped on a wrong sign: its own ticks, and those until the
/// command is above half of full scale.
const MOST_TICKS: u64 = 300 + 300;
/// Largest number of counts in that time: full speed of 0.5 m/s for 30 ms, or 20.2 m/s² (2.73 A on 64 kg) for 40 ms.
const MOST_COUNTS: i64 = 16_000;
/// The same for a following error of 1000 counts, plus the overshoot until the gates are off.
const MOST_COUNTS_BY_ERROR: i64 = 1200;
/// Largest number of ticks until an axis that runs away is off.
const PATIENCE_TICKS: u64 = 3000;
/// Largest number of clocks until an axis is on.
const PATIENCE_CLOCKS: u64 = 1_000_000;
/// Number of clocks in which the brake releases and everything comes to rest.
const REST_CLOCKS: u64 = 300_000;

/// Returns the machine with changed axes.
fn machine(text: &str, change: impl Fn(&mut AxisSection)) -> Machine {
    let mut machine = support::machine(text);
    machine.axes.iter_mut().for_each(change);
    machine
}

/// Returns a bench of the machine, whose modes are at other frequencies.
fn bench(machine: &Machine, frequency_factor: f64) -> StageBench {
    let options = PlantOptions {
        frequency_factor,
        ..PlantOptions::default()
    };
    support::bench(machine, &stage(machine), &options, None, SEED)
}

fn tick_clocks(machine: &Machine) -> u64 {
    (machine.clock.frequency_hz / machine.clock.sample_hz) as u64
}

/// Starts a move of X by this many counts.
fn start(bench: &mut StageBench, machine: &Machine, counts: i32) {
    queue_move(bench, machine, 0, counts);
    bench.write("start", 1).unwrap();
}

/// Effect of a wrong sign.
#[derive(Debug)]
struct RunAway {
    causes: u32,
    ticks: u64,
    counts: i64,
}

/// Runs X until its outputs are off.
fn run_away(bench: &mut StageBench, machine: &Machine, begin: i64) -> RunAway {
    let tick = tick_clocks(machine);
    let mut ticks = 0;
    while bench.pins(0).drive_enable && ticks < PATIENCE_TICKS {
        bench.clocks(tick).unwrap();
        ticks += 1;
    }
    assert!(
        !bench.pins(0).drive_enable,
        "on after {ticks} ticks, at {}",
        bench.plant(0).count()
    );
    RunAway {
        causes: bench.net("x_causes").unwrap() as u32,
        ticks,
        counts: (bench.plant(0).count() - begin).abs(),
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum When {
    /// In HOLD, three counts away from the held position.
    Hold,
    /// From the start of a move on.
    Move,
    /// In the middle of a move.
    InMotion,
}

/// Runs a machine of the wrong sign, with every other supervision disabled.
fn run_with_wrong_sign(text: &str, following_error: bool, lost_s: f64, when: When) -> RunAway {
    let machine = machine(text, |axis| {
        let limits = axis.limits.as_mut().unwrap();
        limits.travel = None;
        limits.encoder_lost_s = lost_s;
        if !following_error {
            limits.following_error = None;
        }
        if when == When::Hold {
            // Friction would hold an axis with so small a deviation.
            axis.drive.as_mut().unwrap().coulomb = 0.0;
        }
    });
    let mut bench = bench(&machine, 1.0);
    let reverse = |bench: &mut StageBench| bench.break_wire(0, Some(Wire::AInverted));
    if when != When::InMotion {
        reverse(&mut bench);
    }
    assert!(bench.switch_on(PATIENCE_CLOCKS).unwrap());
    if when == When::Hold {
        bench.displace(0, 3.0);
    } else {
        bench.clocks(10_000).unwrap();
        start(&mut bench, &machine, 40_000);
    }
    if when == When::InMotion {
        bench.clocks(100 * tick_clocks(&machine)).unwrap();
        reverse(&mut bench);
    }
    let begin = bench.plant(0).count();
    run_away(&mut bench, &machine, begin)
}

#[test]
fn a_wrong_sign_trips_in_hold_and_in_a_move() {
    for (drive, text) in [("velocity", XY), ("torque", TORQUE)] {
        for when in [When::Hold, When::Move, When::InMotion] {
            for following_error in [true, false] {
                let found = run_with_wrong_sign(text, following_error, LOST_S, when);
                let (cause, most) = if following_error {
                    (Cause::FollowingError, MOST_COUNTS_BY_ERROR)
                } else {
                    (Cause::EncoderLost, MOST_COUNTS)
                };
                assert_eq!(found.causes, cause.bit(), "{drive}, {when:?}: {found:?}");
                let in_bounds = found.counts < most && found.ticks < MOST_TICKS;
                assert!(in_bounds, "{drive}, {when:?}: {found:?}");
            }
        }
    }
}

#[test]
fn without_both_watches_a_wrong_sign_goes_on_to_the_end_of_the_errors_word() {
    for text in [XY, TORQUE] {
        let found = run_with_wrong_sign(text, false, 0.0, When::Hold);
        assert_ne!(found.causes & Cause::Range.bit(), 0, "{found:?}");
        assert!(found.counts > 30_000, "{found:?}");
    }
}

#[test]
fn long_a_sound_machine_of_torque_drives_does_not_trip_when_it_stops() {
    for frequency_factor in [0.8, 1.0, 1.2] {
        for stop_deceleration in [None, Some(16.0)] {
            sound(frequency_factor, stop_deceleration);
        }
    }
}

/// Moves there and back, with quick stops in the middle: at `stop_deceleration`, and at once.
fn sound(frequency_factor: f64, stop_deceleration: Option<f64>) {
    let machine = machine(TORQUE, |axis| {
        let LostSign::Watched = lost_sign(axis) else {
            panic!("{} is not watched", axis.name);
        };
        let limits = axis.limits.as_mut().unwrap();
        // This is the shortest time of the supervision.
        limits.encoder_lost_s = 1e-4;
        limits.following_error = None;
        limits.stop_deceleration = stop_deceleration;
        let LostSign::TooShort { least_s } = lost_sign(axis) else {
            panic!("a tick is not too short");
        };
        axis.limits.as_mut().unwrap().encoder_lost_s = least_s + 1e-4;
        assert_eq!(lost_sign(axis), LostSign::Watched);
    });
    let mut bench = bench(&machine, frequency_factor);
    assert!(bench.switch_on(PATIENCE_CLOCKS).unwrap());
    bench.clocks(REST_CLOCKS).unwrap();
    let mut fastest: f64 = 0.0;
    for (turn, stop_after) in [None, Some(60), Some(90), Some(130), Some(200), Some(260), None]
        .into_iter()
        .enumerate()
    {
        if stop_after == Some(130) {
            // From here on the command stops at once.
            bench.write("x_stop_deceleration", 0).unwrap();
        }
        start(&mut bench, &machine, if turn % 2 == 0 { 60_000 } else { -60_000 });
        if let Some(ticks) = stop_after {
            // Its motion begins some ticks later.
            bench.clocks((ticks + 300) * tick_clocks(&machine)).unwrap();
            fastest = fastest.max(bench.plant(0).motion().velocity.abs());
            bench.write("x_stop", 0).unwrap();
        }
        assert!(bench.wait("x", state::HOLD, 10_000_000).unwrap());
        bench.clocks(2 * REST_CLOCKS).unwrap();
        let causes = bench.net("x_causes").unwrap();
        assert_eq!(causes, 0, "{frequency_factor} {stop_deceleration:?}, move {turn}");
    }
    assert!(fastest > 0.2, "{fastest} m/s");
}
