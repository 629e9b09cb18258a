//! Compares the component with the hardware, and checks that it does nothing that a real-time thread must not do.

use crate::axis::Axis;
use crate::clocked::Clocked;
use assert_no_alloc::assert_no_alloc;
use posicast_blocks::shaper_tables::AxisShaperTables;
use proptest::prelude::*;

fn tables(modulo: bool) -> AxisShaperTables {
    AxisShaperTables {
        name: "x".to_owned(),
        lsb_per_unit: 256e3,
        word_bits: 32,
        modulo,
        coefficient_fraction: 16,
        tables: vec![
            vec![(0, 25420), (3, 11000), (4, 19000), (7, 10116)],
            vec![(0, 65536)],
            vec![(0, 40000), (5, -20000), (9, 45536)],
        ],
    }
}

/// Commands in mm that move by up to 0.3 m/s, with tables that change now and then.
fn commands() -> impl Strategy<Value = Vec<(f64, u32)>> {
    let stretch = (-0.3..0.3f64, 0..3u32, 1..30usize);
    proptest::collection::vec(stretch, 1..12).prop_map(|stretches| {
        let mut at = 12.3;
        let stretches = stretches
            .into_iter()
            .flat_map(|(step, table, samples)| std::iter::repeat_n((step, table), samples));
        stretches
            .map(|(step, table)| {
                at += step;
                (at, table)
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn prop_the_component_gives_the_words_of_the_hardware(commands in commands(), modulo: bool) {
        let tables = tables(modulo);
        let mut axis = Axis::new(&tables).unwrap();
        let mut hardware = None;
        for &(command, table) in &commands {
            let shaped = axis.update(command, table, true);
            let hardware = hardware.get_or_insert_with(|| Clocked::new(&tables, shaped.word_in.into()).unwrap());
            let expected = hardware.sample(shaped.word_in.into(), shaped.table);
            prop_assert_eq!(i64::from(shaped.word_out), expected);
            prop_assert_eq!(shaped.position, expected as f64 / 256e3);
            prop_assert!((f64::from(shaped.word_in) - command * 256e3).abs() <= 0.5);
            prop_assert!(!shaped.clamped);
        }
    }
}

#[test]
fn the_servo_thread_allocates_and_frees_nothing() {
    let mut axis = Axis::new(&tables(false)).unwrap();
    let ends = assert_no_alloc(|| {
        let period = |n: u32| axis.update(f64::from(n) * 0.01, n / 40 % 3, !n.is_multiple_of(500));
        (0..2000).map(period).last()
    });
    assert!(ends.is_some());
}

#[test]
fn a_disabled_axis_passes_its_command_on_and_begins_anew() {
    let mut axis = Axis::new(&tables(false)).unwrap();
    for at in [3.0, -8.0, 5.0] {
        assert_eq!(axis.update(at, 0, false).position, at);
    }
    assert_eq!(
        axis.update(-1.0, 0, true).position,
        -1.0,
        "no step where it is switched on"
    );
    let step = axis.update(0.0, 0, true);
    assert!(step.position > -1.0 && step.position < 0.0, "{step:?}");
}

#[test]
fn no_command_makes_it_jump() {
    let mut axis = Axis::new(&tables(false)).unwrap();
    axis.update(1.0, 0, true);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let shaped = axis.update(bad, 0, true);
        assert!(shaped.clamped && shaped.position.is_finite(), "{bad}: {shaped:?}");
    }
    let mut axis = Axis::new(&tables(false)).unwrap();
    axis.update(1.0, 0, true);
    let held = axis.update(f64::NAN, 7, true);
    assert_eq!(
        (held.position, held.table),
        (1.0, 0),
        "the command is held, and there is no table 7"
    );
}

#[test]
fn a_rotary_axis_turns_on_past_the_end_of_its_word() {
    let tables = AxisShaperTables {
        word_bits: 18,
        ..tables(true)
    };
    let mut axis = Axis::new(&tables).unwrap();
    // A turn of the word is 2^18 / 256e3 = 1.024 units.
    let mut last = axis.update(0.0, 0, true).position;
    for n in 1..400 {
        let at = axis.update(f64::from(n) * 0.01, 0, true).position;
        assert!(at >= last && at - last < 0.02, "{n}: {last} to {at}");
        last = at;
    }
    assert!((3.9..3.99).contains(&last), "{last}");
}
