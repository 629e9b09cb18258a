//! The linear scale clock by clock: what its datasheet says about time, align, wrap and long travel.

use posicast_blocks::linear_scale::{Inputs, LATENCY_CLOCKS, LinearScale, PASS_CLOCKS, ScaleRatio};
use proptest::prelude::*;

fn tied(ratio: &ScaleRatio, use_scale: bool) -> Inputs {
    Inputs {
        ratio_mantissa: ratio.mantissa(),
        ratio_shift: ratio.shift() as u8,
        use_scale,
        ..Inputs::default()
    }
}

fn wait(scale: &mut LinearScale, inputs: Inputs, clocks: u32) {
    for _ in 0..clocks {
        scale.step(&inputs);
    }
}

/// Plays a tick with these positions, and returns the resulting deviation.
fn tick(scale: &mut LinearScale, tied: Inputs, motor_position: i32, scale_position: i32) -> i32 {
    let inputs = Inputs {
        tick: true,
        motor_position,
        scale_position,
        ..tied
    };
    scale.step(&inputs);
    let waited = (1..200).find(|_| scale.step(&tied).deviation_valid);
    assert_eq!(waited, Some(LATENCY_CLOCKS));
    scale.outputs().deviation
}

fn align(scale: &mut LinearScale, tied: Inputs, motor_position: i32, scale_position: i32) {
    scale.step(&Inputs { align: true, ..tied });
    assert_eq!(scale.outputs().deviation, 0);
    assert_eq!(tick(scale, tied, motor_position, scale_position), 0);
}

#[test]
fn the_deviation_is_in_the_unit_of_the_loop() {
    // 5 motor counts are 2 counts of the scale.
    let on_scale = tied(&ScaleRatio::new(5.0, 2.0).unwrap(), true);
    let watched = tied(&ScaleRatio::for_monitor(5.0, 2.0).unwrap(), false);
    assert_eq!(tick(&mut LinearScale::new(), on_scale, 500, 190), 10);
    assert_eq!(tick(&mut LinearScale::new(), watched, 500, 190), 25);
    assert_eq!(tick(&mut LinearScale::new(), watched, 500, 210), -25);
}

#[test]
fn counters_may_wrap_after_align() {
    let tied = tied(&ScaleRatio::new(1.0, 1.0).unwrap(), true);
    let mut scale = LinearScale::new();
    align(&mut scale, tied, i32::MAX - 5, i32::MIN + 5);
    assert_eq!(tick(&mut scale, tied, i32::MIN + 4, i32::MIN + 13), 2);
}

#[test]
fn an_align_in_a_pass_is_not_lost() {
    let tied = tied(&ScaleRatio::new(1.0, 1.0).unwrap(), true);
    for clocks in 0..=PASS_CLOCKS {
        let mut scale = LinearScale::new();
        let moved = Inputs {
            motor_position: 1000,
            ..tied
        };
        scale.step(&Inputs { tick: true, ..moved });
        wait(&mut scale, moved, clocks);
        scale.step(&Inputs { align: true, ..moved });
        wait(&mut scale, moved, PASS_CLOCKS + 1 - clocks);
        assert_eq!(scale.outputs().deviation, 0, "align after {clocks} clocks");
        assert_eq!(tick(&mut scale, tied, 1000, 0), 0, "align after {clocks} clocks");
        assert_eq!(tick(&mut scale, tied, 1003, 0), 3, "align after {clocks} clocks");
    }
}

#[test]
fn velocities_are_scaled_in_their_turn() {
    let tied = tied(&ScaleRatio::new(2.0, 1.0).unwrap(), true);
    let velocity = Inputs {
        velocity_valid: true,
        motor_velocity: -(7 << 16) - 1,
        ..tied
    };
    let mut scale = LinearScale::new();
    scale.step(&velocity);
    wait(&mut scale, tied, PASS_CLOCKS);
    assert_eq!(scale.outputs().velocity, -(7 << 15));
    // An align with the tick takes effect after the positions.
    let mut scale = LinearScale::new();
    scale.step(&Inputs { tick: true, ..velocity });
    wait(&mut scale, tied, 2 * PASS_CLOCKS);
    assert_eq!(scale.outputs().velocity, -(7 << 15));
    // Without a loop on the scale, position and velocity pass unchanged.
    let watched = Inputs {
        use_scale: false,
        ..velocity
    };
    scale.step(&watched);
    assert_eq!(scale.outputs().velocity, velocity.motor_velocity);
}

#[test]
fn a_metre_of_thirds_shows_what_the_datasheet_says() {
    let ratio = ScaleRatio::new(3.0, 1.0).unwrap();
    let shown = ratio.apply(3_000_000) - 1_000_000;
    let stated = ratio.relative_error() * 1e6;
    assert!(
        stated <= 1e6 / 131_072.0 && (shown.abs() as f64 - stated).abs() <= 0.5,
        "{shown}, {stated}"
    );
}

proptest! {
    #[test]
    fn prop_no_drift_over_any_way(
        motor_counts in 1.0f64..1e5,
        scale_counts in 1.0f64..1e5,
        use_scale: bool,
        way in proptest::collection::vec(-4_000_000i32..4_000_000, 1..20),
        start: (i32, i32),
    ) {
        let ratio = if use_scale { ScaleRatio::new(motor_counts, scale_counts) } else { ScaleRatio::for_monitor(motor_counts, scale_counts) };
        let Ok(ratio) = ratio else { return Ok(()) };
        let tied = tied(&ratio, use_scale);
        let mut scale = LinearScale::new();
        align(&mut scale, tied, start.0, start.1);
        let mut travelled = 0i32;
        for step in way {
            travelled += step;
            // The converted position moves by `travelled`, the other one by the equivalent, to half a count.
            let exact = f64::from(travelled) * ratio.value();
            if exact.abs() > 1e9 {
                return Ok(());
            }
            let converted = (exact + 0.5).floor() as i32;
            let (motor, of_scale) = if use_scale { (travelled, converted) } else { (converted, travelled) };
            let shown = tick(&mut scale, tied, start.0.wrapping_add(motor), start.1.wrapping_add(of_scale));
            prop_assert_eq!(shown, 0);
        }
    }
}
