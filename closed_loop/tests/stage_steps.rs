//! A stage with steps and its motors: what the motors do is what the machine file says, and an overrun is seen.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_blocks::axis::Cause;
use posicast_closed_loop::stage_run::{Shaping, StageRun};

use crate::support::{machine, stage};

const PRINTER: &str = include_str!("../../examples/printer.toml");

#[test]
fn the_motors_follow_and_the_shapers_calm_the_load() {
    let machine = machine(PRINTER);
    let config = stage(&machine).config;
    let run = StageRun::new(&machine, &config, 1).unwrap();
    let shaped = run.moved(Shaping::Shaped, 1.0).unwrap();
    let unshaped = run.moved(Shaping::Unshaped, 1.0).unwrap();
    assert_eq!((&shaped.trouble, &unshaped.trouble), (&None, &None));
    assert_eq!((&shaped.lost_steps, &unshaped.lost_steps), (&vec![0, 0], &vec![0, 0]));
    let expected = run.expected(Shaping::Shaped, 1.0).unwrap();
    let bare = run.expected(Shaping::Unshaped, 1.0).unwrap();
    for (axis, (expected, bare)) in expected.iter().zip(&bare).enumerate() {
        let (with, without) = (&shaped.axes[axis], &unshaped.axes[axis]);
        // The expectation is a linear motor behind the exact reference.
        assert!(
            with.residual.peak <= expected.ringing_allowed(),
            "{with:?} {expected:?}"
        );
        assert!(
            with.tracking.peak <= expected.tracking_allowed(),
            "{with:?} {expected:?}"
        );
        assert!(
            (without.residual.peak / bare.figures.residual.peak - 1.0).abs() < 0.1,
            "{without:?} {bare:?}"
        );
        assert!(expected.exercises(bare), "{expected:?} {bare:?}");
        // The motor rests on its step, less than half a step from the target.
        assert!(with.offset.abs() <= 0.6 * expected.count, "{with:?}");
    }
}

#[test]
fn an_overrun_motor_loses_whole_pitches() {
    // The motor's largest acceleration is (2π · 20 Hz)² · 0.8 mm / 2π = 2 m/s², and the move has 5.
    let text = PRINTER.replace("resonance_hz = 120.0 ", "resonance_hz = 20.0 ");
    assert_ne!(text, PRINTER);
    let machine = machine(&text);
    let config = stage(&machine).config;
    let run = StageRun::new(&machine, &config, 1).unwrap();
    let moved = run.moved(Shaping::Unshaped, 1.0).unwrap();
    assert!(
        moved.lost_steps[0] > 0 && moved.lost_steps[0].is_multiple_of(4 * 16),
        "{:?}",
        moved.lost_steps
    );
    assert_eq!(moved.lost_steps[1], 0);
}

/// The printer with a scale of ten counts per step at the load of X.
fn with_scale(limits: &str, resonance: &str) -> String {
    let table = format!("[axis.scale]\ncounts_per_unit = 800_000\n\n[axis.limits]\n{limits}\n");
    let text = PRINTER.replacen("[axis.limits]\n", &table, 1);
    text.replacen("resonance_hz = 120.0 ", &format!("resonance_hz = {resonance} "), 1)
}

/// Names of the causes with which X stopped in its move without a shaper; none if it did not.
fn stopped_by(text: &str) -> Vec<Cause> {
    let machine = machine(text);
    let config = stage(&machine).config;
    let run = StageRun::new(&machine, &config, 1).unwrap();
    let trouble = run.moved(Shaping::Unshaped, 1.0).unwrap().trouble;
    let causes = trouble.map_or(0, |trouble| trouble.causes);
    Cause::ALL
        .into_iter()
        .filter(|cause| causes & cause.bit() != 0)
        .collect()
}

#[test]
fn a_lag_passes_and_a_stall_stops_the_axis() {
    // At 5 m/s² the load, 52 Hz, is 4 steps behind, and the motor, 60 Hz, 3 more: while it accelerates, and while it rings.
    let lag = "deviation = 50e-6";
    assert_eq!(stopped_by(&with_scale(lag, "60.0")), [Cause::Deviation]);
    assert_eq!(
        stopped_by(&with_scale(&format!("{lag}\ndeviation_s = 0.5"), "60.0")),
        []
    );
    // A motor that is pulled over falls behind for good, by 64 steps: 0.8 mm.
    let overrun = "deviation = 0.4e-3\ndeviation_s = 0.02";
    assert_eq!(stopped_by(&with_scale(overrun, "20.0")), [Cause::Deviation]);
}
