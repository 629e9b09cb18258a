//! A stage with steps and its motors: what the motors do is what the machine file says, and an overrun is seen.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

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
