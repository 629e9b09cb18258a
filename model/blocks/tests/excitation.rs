//! The excitation compared with its datasheet.

use posicast_blocks::excitation::{Excitation, ExcitationKind, Inputs, Outputs, TICK_CLOCKS};
use proptest::prelude::*;

fn settings(kind: ExcitationKind, amplitude: u16, period_ticks: u16, duration_ticks: u32) -> Inputs {
    Inputs {
        enable: true,
        allowed: true,
        kind,
        amplitude,
        amplitude_limit: u16::MAX,
        period_ticks,
        duration_ticks,
        ..Inputs::default()
    }
}

/// Returns the outputs of the first `ticks` ticks, long after their `valid`.
fn ticks(excitation: &mut Excitation, inputs: &Inputs, ticks: usize) -> Vec<Outputs> {
    let tick = |_| {
        excitation.step(&Inputs { valid: true, ..*inputs });
        for _ in 1..TICK_CLOCKS {
            excitation.step(inputs);
        }
        excitation.outputs()
    };
    (0..ticks).map(tick).collect()
}

fn armed() -> Excitation {
    let mut excitation = Excitation::new();
    excitation.step(&Inputs::default());
    excitation
}

fn values(inputs: &Inputs, count: usize) -> Vec<i32> {
    let shown = ticks(&mut armed(), inputs, count);
    shown.iter().map(|outputs| outputs.excitation_value).collect()
}

fn any_kind() -> impl Strategy<Value = ExcitationKind> {
    prop_oneof![
        Just(ExcitationKind::Prbs),
        Just(ExcitationKind::Chirp),
        Just(ExcitationKind::Square),
        Just(ExcitationKind::None)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn prop_the_signal_keeps_its_bound_whatever_happens(
        clocks in prop::collection::vec((0..40u32, any_kind(), 0..8u16, any::<u16>(), 0..12u32), 1..100),
        amplitude: u16,
        amplitude_limit: u16,
        y_0: i32,
    ) {
        let bound = i32::from(amplitude.min(amplitude_limit));
        let mut excitation = armed();
        for (length, kind, period_ticks, sweep, duration_ticks) in clocks {
            for clock in 0..length {
                let enable = length != 7 || clock > 0;
                let inputs = Inputs { amplitude_limit, sweep, enable, y_0, valid: clock % 20 == 0, allowed: length != 9,
                    ..settings(kind, amplitude, period_ticks, duration_ticks) };
                let before = excitation.outputs();
                excitation.step(&inputs);
                let shown = excitation.outputs();
                prop_assert!(shown.excitation_value.abs() <= bound);
                if shown.reference_valid {
                    prop_assert_eq!(shown.position_reference, y_0.saturating_add(shown.excitation_value));
                }
                prop_assert!(!shown.excitation_done || (before.excitation_active && !shown.excitation_active));
            }
        }
    }

    #[test]
    fn prop_a_period_is_exactly_so_many_ticks(period_ticks in 1..400u16, amplitude in 1..u16::MAX) {
        let inputs = settings(ExcitationKind::Square, amplitude, period_ticks, 10_000);
        for (tick, value) in values(&inputs, 3 * usize::from(period_ticks) + 1)[1..].iter().enumerate() {
            // The tick is in the first half of a turn of 256 steps; the last step, which has only begun, does not
            // count.
            let place = tick as u64 * 256 / u64::from(period_ticks) % 256;
            let sign = if place < 128 { 1 } else { -1 };
            prop_assert_eq!(*value, sign * i32::from(amplitude), "tick {}", tick);
        }
    }
}

#[test]
fn prbs_bits_last_a_period_and_start_anew() {
    let mut reference = vec![true; 15];
    while reference.len() < 200 {
        let n = reference.len();
        reference.push(reference[n - 15] ^ reference[n - 14]);
    }
    for period_ticks in [1, 2, 3, 7] {
        let inputs = settings(ExcitationKind::Prbs, 777, period_ticks, 180);
        let mut excitation = armed();
        for _ in 0..2 {
            let shown = ticks(&mut excitation, &inputs, 183);
            for (tick, outputs) in shown[1..181].iter().enumerate() {
                let one = reference[tick / usize::from(period_ticks)];
                assert_eq!(outputs.excitation_value, if one { 777 } else { -777 });
            }
            assert!(shown[179].excitation_active && !shown[180].excitation_active);
            assert_eq!((shown[0].excitation_value, shown[181].excitation_value), (0, 0));
            excitation.step(&Inputs::default());
        }
    }
}

#[test]
fn a_chirp_rises_by_its_sweep() {
    // The frequency rises from one turn in 100 ticks by 1/64 of that per tick: n + n(n − 1)/128 hundredths of a turn
    // after n ticks.
    let chirp = Inputs {
        sweep: 1024,
        ..settings(ExcitationKind::Chirp, 64 << 8, 100, 1000)
    };
    for (n, value) in values(&chirp, 300)[1..].iter().enumerate() {
        let n = n as f64;
        let turn = (n + n * (n - 1.0) / 128.0) / 100.0;
        let triangle = 1.0 - 4.0 * ((turn + 0.25).rem_euclid(1.0) - 0.5).abs();
        // The tolerance is half a step of the triangle either way, and the step by which the angle is late.
        assert!(
            (f64::from(*value) / 256.0 - 64.0 * triangle).abs() < 2.0,
            "tick {n}: {value}, {triangle}"
        );
    }
}

#[test]
fn what_turns_too_fast_ends() {
    let fast = Inputs {
        sweep: u16::MAX,
        ..settings(ExcitationKind::Chirp, 1 << 8, 2, 1 << 20)
    };
    let shown = ticks(&mut armed(), &fast, 20);
    assert!(shown[1].excitation_active && !shown[19].excitation_active);
    let slow = Inputs {
        period_ticks: u16::MAX,
        ..fast
    };
    let shown = ticks(&mut armed(), &slow, 70);
    // The frequency's word holds 63 times the first frequency.
    let active = shown.iter().filter(|outputs| outputs.excitation_active).count();
    assert!((60..66).contains(&active), "{active}");
    let none = settings(ExcitationKind::Prbs, 1 << 8, 0, 1 << 20);
    assert!(
        ticks(&mut armed(), &none, 3)
            .iter()
            .all(|outputs| !outputs.excitation_active || outputs.excitation_value == 0)
    );
}

#[test]
fn it_starts_once_per_enable_and_never_without_duration() {
    let inputs = settings(ExcitationKind::Square, 1 << 8, 4, 3);
    let mut excitation = Excitation::new();
    assert!(
        ticks(&mut excitation, &inputs, 5)
            .iter()
            .all(|outputs| !outputs.excitation_active)
    );
    excitation.step(&Inputs::default());
    assert_eq!(
        ticks(&mut excitation, &inputs, 20)
            .iter()
            .filter(|outputs| outputs.excitation_value != 0)
            .count(),
        3
    );
    excitation.step(&Inputs::default());
    let never = Inputs {
        duration_ticks: 0,
        ..inputs
    };
    assert!(
        ticks(&mut excitation, &never, 5)
            .iter()
            .all(|outputs| !outputs.excitation_active)
    );
    assert!(ticks(&mut excitation, &inputs, 2)[1].excitation_active);
    // When not allowed, the signal ends with the next tick, and does not return with the permission.
    let forbidden = Inputs {
        allowed: false,
        ..inputs
    };
    assert_eq!(
        ticks(&mut excitation, &forbidden, 1)[0].excitation_value,
        256,
        "falls in the clock of valid"
    );
    assert_eq!(ticks(&mut excitation, &forbidden, 1)[0].excitation_value, 0);
    assert!(
        ticks(&mut excitation, &inputs, 5)
            .iter()
            .all(|outputs| outputs.excitation_value == 0)
    );
}

#[test]
fn the_position_stays_at_its_ends_or_wraps() {
    let inputs = settings(ExcitationKind::Square, 0xffff, 1000, 100);
    for (y_0, stays) in [
        (i32::MAX, i32::MAX),
        (i32::MAX - 3, i32::MAX),
        (i32::MIN, i32::MIN + 0xffff),
    ] {
        let at = |modulo| {
            ticks(
                &mut armed(),
                &Inputs {
                    y_0,
                    y_1: 7,
                    y_2: -9,
                    modulo,
                    ..inputs
                },
                2,
            )[1]
        };
        assert_eq!(at(false).position_reference, stays);
        assert_eq!(at(true).position_reference, y_0.wrapping_add(0xffff));
        assert_eq!((at(true).velocity_reference, at(true).acceleration_reference), (7, -9));
    }
}
