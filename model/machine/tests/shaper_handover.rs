//! Motion of a machine whose shaper changes from one table to another while it moves: the figures of
//! `docs/shaper.md`.

use crate::support;

use posicast_blocks::shaper::{MotionShaper, ShaperConfig, ShaperMotion, swap_how};
use posicast_machine::plan::design_machine;
use posicast_machine::plant::{Plant, SampledPlant};
use posicast_shaper::mode::Mode;
use posicast_taps::TapTable;

const SAMPLE_HZ: u32 = 10_000;
const DAMPING: f64 = 0.05;
const DISTANCE: f64 = 30_000_000.0;
const MOVE_SAMPLES: usize = 6000;
const CHANGE: usize = 700;

fn zvd(frequency_hz: f64) -> TapTable {
    let machine = support::machine(
        SAMPLE_HZ,
        "modal",
        &support::shaper("zvd", 0.0),
        &[(frequency_hz, DAMPING, "")],
    );
    design_machine(&machine).unwrap().axes[0].table.clone()
}

/// Returns a move of constant velocity: `CHANGE` is in the middle of it, and both ends excite vibration.
fn words() -> Vec<i64> {
    let there = |n: usize| (DISTANCE * n.min(MOVE_SAMPLES) as f64 / MOVE_SAMPLES as f64).round() as i64;
    (0..MOVE_SAMPLES + 400).map(there).collect()
}

/// Returns the largest step of the shaped position from sample to sample, and the amplitude with which a machine of
/// `frequency_hz` rings once the shaped command stands still, per million of the distance.
fn run(old: &TapTable, new: &TapTable, how: u8, frequency_hz: f64) -> (i64, f64) {
    let config = ShaperConfig::new(32, old.clone())
        .unwrap()
        .with_room_for(500, 64)
        .unwrap();
    let config = config
        .for_motion(ShaperMotion {
            channels: 1,
            modulo: false,
        })
        .unwrap();
    let mut shaper = MotionShaper::new(&config);
    let mode = Mode {
        frequency_hz,
        damping: DAMPING,
    };
    let mut machine = SampledPlant::new(&Plant::new(&[(mode, 1.0)]).unwrap(), 1.0 / f64::from(SAMPLE_HZ), 0.0);
    let (mut last, mut step, mut vibration) = (0, 0, 0.0);
    for (n, x) in words().into_iter().enumerate() {
        if n == CHANGE {
            shaper.swap(new, how).unwrap();
        }
        let [y, ..] = shaper.push([x, 0, 0]);
        machine.step(y as f64);
        step = step.max((y - last).abs());
        if y != last {
            vibration = machine.vibration();
        }
        last = y;
    }
    assert_eq!(last, DISTANCE as i64);
    (step, vibration / DISTANCE * 1e6)
}

#[test]
fn prop_after_a_handover_the_residual_is_that_of_the_new_shaper() {
    let (old, new) = (zvd(40.0), zvd(60.0));
    // The machine's mode went from 40 to 60 Hz, for example because of a lighter load.
    let (step_alone, alone) = run(&new, &new, swap_how::AT_ONCE, 60.0);
    let (_, not_changed) = run(&old, &old, swap_how::AT_ONCE, 60.0);
    let (step_at_once, _) = run(&old, &new, swap_how::AT_ONCE, 60.0);
    let (step, handed_over) = run(&old, &new, swap_how::HANDOVER, 60.0);
    let figures = format!(
        "residual: new alone {alone:.1} ppm, handed over {handed_over:.1}, not changed {not_changed:.1}; \
         largest step: new alone {step_alone}, handed over {step}, at once {step_at_once}"
    );
    assert!((handed_over - alone).abs() < 1.0, "{figures}");
    assert!(not_changed > 1000.0 * handed_over, "{figures}");
    assert!(step < 2 * step_alone && step_at_once > 20 * step_alone, "{figures}");
}
