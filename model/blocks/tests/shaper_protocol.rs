//! The shaper's protocol, one rule of the datasheet per test.

use posicast_blocks::ClockedBlock;
use posicast_blocks::shaper::{Inputs, LoadError, Outputs, SampleShaper, Shaper, ShaperConfig, pass_clocks};
use posicast_taps::{Tap, TapTable};

const ONE: i32 = 1 << 16;

fn table(taps: &[(u32, i32)]) -> TapTable {
    let tap = |&(delay_samples, coefficient): &(u32, i32)| Tap {
        delay_samples,
        coefficient,
    };
    TapTable::new(16, taps.iter().map(tap).collect()).unwrap()
}

/// Returns a shaper whose output is half the current sample plus half the one four samples ago.
fn shaper() -> Shaper {
    let config = ShaperConfig::new(16, table(&[(0, ONE / 2), (4, ONE / 2)])).unwrap();
    Shaper::new(&config, 99)
}

fn write(bank: u8, index: u16, coefficient: i32, delay: u16) -> Inputs {
    Inputs {
        tap_write: true,
        tap_bank: bank,
        tap_index: index,
        tap_coefficient: coefficient,
        tap_delay: delay,
        ..Inputs::default()
    }
}

fn swap(bank: u8) -> Inputs {
    Inputs {
        swap: true,
        swap_bank: bank,
        ..Inputs::default()
    }
}

fn strobe(x: i64) -> Inputs {
    Inputs {
        strobe: true,
        x,
        ..Inputs::default()
    }
}

fn start(x: i64) -> Inputs {
    Inputs {
        start: true,
        x,
        ..Inputs::default()
    }
}

/// Clocks `inputs`, and returns the outputs after it.
fn clock(shaper: &mut Shaper, inputs: Inputs) -> Outputs {
    shaper.step(&inputs);
    shaper.outputs()
}

fn idle(shaper: &mut Shaper, clocks: u32) -> Outputs {
    (0..clocks).for_each(|_| {
        shaper.step(&Inputs::default());
    });
    shaper.outputs()
}

/// Plays a strobe and its whole pass; returns `y`.
fn sample(shaper: &mut Shaper, x: i64) -> i64 {
    shaper.step(&strobe(x));
    let shown = (0..300).map(|_| idle(shaper, 1)).find(|shown| shown.valid);
    shown.unwrap().y
}

#[test]
fn history_before_the_start_is_the_start_value() {
    let mut shaper = shaper();
    clock(&mut shaper, start(100));
    assert_eq!([200; 6].map(|x| sample(&mut shaper, x)), [150, 150, 150, 150, 200, 200]);
}

#[test]
fn a_start_sets_y_without_valid_and_cuts_off_a_pass() {
    let mut shaper = shaper();
    sample(&mut shaper, 1000);
    clock(&mut shaper, strobe(5000));
    let shown = clock(&mut shaper, start(-7));
    assert_eq!((shown.y, shown.valid, shown.busy), (-7, false, false));
    assert!((0..50).all(|_| !idle(&mut shaper, 1).valid));
    assert_eq!(shaper.outputs().y, -7);
    assert!(!shaper.outputs().overrun);
}

#[test]
fn start_and_strobe_together_start_first() {
    let mut shaper = shaper();
    clock(&mut shaper, strobe(5000));
    let shown = clock(
        &mut shaper,
        Inputs {
            start: true,
            ..strobe(40)
        },
    );
    assert_eq!((shown.y, shown.busy, shown.overrun), (40, true, false));
    assert_eq!(
        idle(&mut shaper, pass_clocks(2) - 1),
        Outputs {
            y: 40,
            valid: true,
            ..Outputs::default()
        }
    );
    assert_eq!(sample(&mut shaper, 60), 50);
}

#[test]
fn an_early_strobe_drops_the_pass_but_not_the_sample() {
    let mut shaper = shaper();
    sample(&mut shaper, 100);
    clock(&mut shaper, strobe(200));
    // The last clock of the pass is still an overrun: the dropped pass was about to show its result.
    idle(&mut shaper, pass_clocks(2) - 2);
    let shown = clock(&mut shaper, strobe(300));
    assert!(shown.overrun && shown.busy && !shown.valid);
    assert_eq!(shown.y, 50);
    assert_eq!(idle(&mut shaper, pass_clocks(2) - 2).y, 50);
    assert_eq!(idle(&mut shaper, 1).y, 150);
    sample(&mut shaper, 0);
    sample(&mut shaper, 0);
    assert_eq!(
        sample(&mut shaper, 0),
        100,
        "the sample of the dropped pass is in the ring"
    );
    assert!(
        !clock(
            &mut shaper,
            Inputs {
                clear_flags: true,
                ..Inputs::default()
            }
        )
        .overrun
    );
}

/// Returns what a host reads back at a place: coefficient and delay.
fn read(shaper: &mut Shaper, bank: u8, index: u16) -> (i32, u16) {
    let place = Inputs {
        tap_bank: bank,
        tap_index: index,
        ..Inputs::default()
    };
    let mut shown = clock(
        shaper,
        Inputs {
            tap_read: true,
            ..place
        },
    );
    while shown.tap_read_waits {
        shown = clock(shaper, place);
    }
    (shown.loaded_coefficient, shown.loaded_delay)
}

#[test]
fn taps_of_all_banks_are_read_back() {
    let mut shaper = shaper();
    clock(&mut shaper, write(2, 0, 2 * ONE - 1, 0));
    clock(&mut shaper, write(2, 1, 1 - ONE, 62));
    clock(&mut shaper, write(1, 0, -5, 7));
    for active in [0, 2] {
        clock(&mut shaper, swap(active));
        sample(&mut shaper, 1000);
        assert_eq!(shaper.outputs().bank, active);
        assert_eq!(
            [0, 1, 2].map(|index| read(&mut shaper, 0, index)),
            [(ONE / 2, 0), (ONE / 2, 4), (0, 0)]
        );
        assert_eq!([0, 1].map(|index| read(&mut shaper, 1, index)), [(-5, 7), (0, 0)]);
        let of_second = [(2 * ONE - 1, 0), (1 - ONE, 62), (0, 0)];
        assert_eq!([0, 1, 2].map(|index| read(&mut shaper, 2, index)), of_second);
        assert_eq!(read(&mut shaper, 3, 0), (0, 0));
    }
    // Loading begins again: taps loaded after it no longer belong to the table.
    clock(&mut shaper, swap(0));
    sample(&mut shaper, 0);
    clock(&mut shaper, write(2, 0, 3, 1));
    assert_eq!([0, 1].map(|index| read(&mut shaper, 2, index)), [(3, 1), (0, 0)]);
    let reset = Inputs {
        rst: true,
        ..Inputs::default()
    };
    let shown = clock(&mut shaper, reset);
    assert_eq!(
        (shown.loaded_coefficient, shown.loaded_delay, shown.tap_read_waits),
        (0, 0, false)
    );
    assert_eq!(read(&mut shaper, 2, 0), (0, 0));
}

#[test]
fn a_read_waits_for_a_pass_and_for_a_write_and_changes_neither() {
    let mut shaper = shaper();
    let read = Inputs {
        tap_read: true,
        ..Inputs::default()
    };
    clock(&mut shaper, start(0));
    clock(&mut shaper, strobe(100));
    clock(&mut shaper, read);
    // The strobe was clock 0: the shaper is busy until `valid`, in whose clock the read is done.
    for _ in 2..pass_clocks(2) {
        assert!(clock(&mut shaper, Inputs::default()).tap_read_waits);
    }
    assert_eq!((shaper.outputs().y, shaper.outputs().valid), (50, true));
    assert!(
        clock(&mut shaper, write(1, 0, 77, 3)).tap_read_waits,
        "a write comes first"
    );
    let place = Inputs {
        tap_bank: 1,
        ..Inputs::default()
    };
    let waits = [place, Inputs::default(), Inputs::default()].map(|inputs| clock(&mut shaper, inputs).tap_read_waits);
    assert_eq!(
        waits,
        [true, false, false],
        "the word stands two clocks after the place"
    );
    assert_eq!(
        (shaper.outputs().loaded_coefficient, shaper.outputs().loaded_delay),
        (77, 3)
    );
    assert!(!shaper.outputs().refused);
}

#[test]
fn a_flag_that_is_set_and_cleared_at_once_is_set() {
    let mut shaper = shaper();
    clock(&mut shaper, strobe(1));
    let shown = clock(
        &mut shaper,
        Inputs {
            clear_flags: true,
            ..strobe(2)
        },
    );
    assert!(shown.overrun);
    let shown = clock(
        &mut shaper,
        Inputs {
            clear_flags: true,
            ..swap(3)
        },
    );
    assert!(shown.refused && !shown.overrun);
}

#[test]
fn a_loaded_table_is_active_from_the_next_strobe_on() {
    let mut shaper = shaper();
    clock(&mut shaper, start(100));
    clock(&mut shaper, write(1, 0, 2 * ONE - 1, 0));
    assert!(clock(&mut shaper, swap(1)).refused, "the sum is not one yet");
    clock(
        &mut shaper,
        Inputs {
            clear_flags: true,
            ..write(1, 1, 1 - ONE, 1)
        },
    );
    let shown = clock(&mut shaper, swap(1));
    assert_eq!((shown.swap_pending, shown.bank, shown.refused), (true, 0, false));
    assert_eq!(sample(&mut shaper, 200), 300);
    let shown = shaper.outputs();
    assert_eq!((shown.swap_pending, shown.bank), (false, 1));
    clock(&mut shaper, swap(0));
    assert_eq!(sample(&mut shaper, 200), 150, "the history stays");
}

#[test]
fn a_swap_in_the_clock_of_a_strobe_waits_for_the_next() {
    let mut shaper = shaper();
    clock(&mut shaper, write(2, 0, ONE, 0));
    let shown = clock(
        &mut shaper,
        Inputs {
            swap: true,
            swap_bank: 2,
            ..strobe(50)
        },
    );
    assert_eq!((shown.bank, shown.swap_pending), (0, true));
    assert_eq!(idle(&mut shaper, pass_clocks(2) - 1).y, 25);
    assert_eq!(sample(&mut shaper, 60), 60);
}

#[test]
fn writes_that_are_refused() {
    let bypass = write(1, 0, ONE, 0);
    let refused: [(&str, Vec<Inputs>); 7] = [
        ("bank 0", vec![write(0, 0, ONE, 0)]),
        ("bank 3", vec![write(3, 0, ONE, 0)]),
        ("does not begin with 0", vec![write(1, 1, ONE, 0)]),
        ("leaves one out", vec![bypass, write(1, 2, 5, 0)]),
        ("delay of all ones", vec![write(1, 0, ONE, 63)]),
        ("while a swap waits", vec![bypass, swap(1), write(2, 0, ONE, 0)]),
        (
            "in the clock of a swap",
            vec![
                bypass,
                Inputs {
                    swap: true,
                    swap_bank: 1,
                    ..write(1, 1, 5, 1)
                },
            ],
        ),
    ];
    for (what, clocks) in refused {
        let mut shaper = shaper();
        let (last, before) = clocks.split_last().unwrap();
        assert!(
            !before
                .iter()
                .map(|&inputs| clock(&mut shaper, inputs))
                .any(|shown| shown.refused),
            "{what}"
        );
        assert!(clock(&mut shaper, *last).refused, "{what}");
    }
    let mut shaper = shaper();
    clock(&mut shaper, bypass);
    clock(&mut shaper, swap(1));
    sample(&mut shaper, 0);
    assert!(clock(&mut shaper, bypass).refused, "the active bank");
}

#[test]
fn a_refused_write_changes_nothing() {
    let mut shaper = shaper();
    clock(&mut shaper, write(1, 0, ONE, 0));
    for refused in [
        write(1, 5, 1, 0),
        write(1, 0, 7, 63),
        write(1, 1, 7, 63),
        write(0, 0, 7, 0),
    ] {
        assert!(clock(&mut shaper, refused).refused);
    }
    assert!(clock(&mut shaper, swap(1)).swap_pending);
    assert_eq!(sample(&mut shaper, 77), 77);
}

#[test]
fn index_0_begins_a_table_anew() {
    let mut shaper = shaper();
    clock(&mut shaper, write(2, 0, 12345, 9));
    clock(&mut shaper, write(2, 1, -5, 3));
    clock(&mut shaper, write(2, 0, ONE, 0));
    assert!(clock(&mut shaper, swap(2)).swap_pending);
    assert_eq!(sample(&mut shaper, 31), 31);
}

#[test]
fn swaps_that_are_refused() {
    let mut shaper = shaper();
    for (bank, what) in [(1, "nothing loaded"), (2, "nothing loaded"), (3, "no bank")] {
        assert!(clock(&mut shaper, swap(bank)).refused, "bank {bank}: {what}");
        assert!(
            !clock(
                &mut shaper,
                Inputs {
                    clear_flags: true,
                    ..Inputs::default()
                }
            )
            .refused
        );
    }
    assert!(!clock(&mut shaper, swap(0)).refused);
    assert!(clock(&mut shaper, swap(0)).refused, "one is pending");
}

#[test]
fn a_full_table_takes_no_more() {
    let mut shaper = shaper();
    for index in 0..64 {
        assert!(
            !clock(&mut shaper, write(1, index, ONE / 64, index % 63)).refused,
            "{index}"
        );
    }
    // An index of six bits cannot continue from here; only 0 is in sequence, and begins again.
    assert!(clock(&mut shaper, write(1, 63, 1, 0)).refused);
    assert!(clock(&mut shaper, swap(1)).swap_pending);
    assert_eq!((0..64).map(|_| sample(&mut shaper, 6400)).last(), Some(6400));
}

#[test]
fn reset_forgets_all_but_not_during_it() {
    let mut shaper = shaper();
    clock(&mut shaper, write(1, 0, ONE, 0));
    clock(&mut shaper, strobe(9999));
    clock(&mut shaper, swap(1));
    let everything = Inputs {
        rst: true,
        swap: true,
        swap_bank: 1,
        start: true,
        ..strobe(5)
    };
    assert_eq!(clock(&mut shaper, everything), Outputs::default());
    assert!(clock(&mut shaper, swap(1)).refused);
    assert_eq!(sample(&mut shaper, 100), 50);
}

#[test]
fn words_wrap_to_the_width_of_the_port() {
    let mut shaper = shaper();
    assert_eq!(clock(&mut shaper, start(0x1_8000)).y, -0x8000);
    assert_eq!(clock(&mut shaper, start(i64::MAX)).y, -1);
}

#[test]
fn raw_ports_are_the_typed_ones() {
    let mut typed = shaper();
    let mut raw = shaper();
    let config = typed.config().clone();
    let mut shown = [0; 11];
    let read = Inputs {
        tap_read: true,
        tap_bank: 1,
        ..Inputs::default()
    };
    let waits = Inputs {
        tap_read: false,
        ..read
    };
    let begin = [start(-3), write(1, 0, -9, 5), read, waits, waits, swap(2)];
    for inputs in begin.into_iter().chain([strobe(-4), Inputs::default()]) {
        let bits = inputs.to_raw(&config);
        assert_eq!(Inputs::from_raw(&bits, &config).to_raw(&config), bits);
        ClockedBlock::step(&mut raw, &bits, &mut shown).unwrap();
        let expected = typed.step(&inputs);
        let mut raw_outputs = [0; 11];
        expected.write_raw(&config, &mut raw_outputs);
        assert_eq!(shown, raw_outputs);
        assert_eq!(Outputs::from_raw(&shown, &config), expected);
    }
    let error = ClockedBlock::step(&mut raw, &[0; 3], &mut shown).unwrap_err();
    assert!(error.to_string().contains("3 inputs"), "{error}");
}

#[test]
fn the_fast_path_refuses_what_the_hardware_cannot_hold() {
    let config = ShaperConfig::new(16, table(&[(0, ONE)])).unwrap();
    let mut fast = SampleShaper::new(&config);
    assert!(matches!(fast.swap(&table(&[(63, ONE)])), Err(LoadError::Size(_))));
    assert!(matches!(
        fast.swap(&TapTable::bypass(15).unwrap()),
        Err(LoadError::Fraction { found: 15, allowed: 16 })
    ));
    assert_eq!(fast.push(5), 5);
}
