//! The shaper's two models compared with each other, and with exact arithmetic.

use fixed::types::I96F32;
use posicast_blocks::shaper::{Inputs, Outputs, SampleShaper, Shaper, ShaperConfig, pass_clocks};
use posicast_taps::{COEFFICIENT_MAX, COEFFICIENT_MIN, Tap, TapTable};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Returns tables of up to 40 taps whose coefficients sum to one, of any sign and any size that fits.
fn tables(fraction: u32, longest: u32) -> impl Strategy<Value = TapTable> {
    let size = (4 << fraction).min(COEFFICIENT_MAX);
    prop::collection::btree_map(0..=longest, -size..=size, 1..40).prop_map(move |taps| complete(fraction, taps))
}

/// Makes the coefficients sum to 2^fraction by changing as few as possible, beginning with the last.
fn complete(fraction: u32, mut taps: BTreeMap<u32, i32>) -> TapTable {
    taps.values_mut().filter(|c| **c == 0).for_each(|c| *c = 1);
    let mut missing = (1i64 << fraction) - taps.values().map(|&c| i64::from(c)).sum::<i64>();
    for coefficient in taps.values_mut().rev() {
        let wanted = i64::from(*coefficient) + missing;
        let near = wanted.clamp(i64::from(COEFFICIENT_MIN), i64::from(COEFFICIENT_MAX));
        let kept = if near == 0 { 1 } else { near };
        missing = wanted - kept;
        *coefficient = kept as i32;
    }
    let list = taps.into_iter().map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    TapTable::new(fraction, list.collect()).unwrap_or_else(|_| TapTable::bypass(fraction).unwrap())
}

/// Events of a shaper: those of a sensible host, and invalid ones.
#[derive(Debug, Clone)]
enum Event {
    Sample { x: i64, pause: u32 },
    Start(i64),
    Table(TapTable, u8),
    Reset,
    Clear,
}

fn events(fraction: u32) -> impl Strategy<Value = Vec<Event>> {
    let event = prop_oneof![
        20 => (any::<i64>(), 0..5u32).prop_map(|(x, pause)| Event::Sample { x, pause }),
        5 => (prop_oneof![Just(i64::MAX), Just(i64::MIN)], 0..1u32).prop_map(|(x, pause)| Event::Sample { x, pause }),
        2 => any::<i64>().prop_map(Event::Start),
        3 => (tables(fraction, 62), 1..3u8).prop_map(|(table, bank)| Event::Table(table, bank)),
        1 => Just(Event::Reset),
        1 => Just(Event::Clear),
    ];
    prop::collection::vec(event, 1..120)
}

fn cases() -> impl Strategy<Value = (ShaperConfig, Vec<Event>)> {
    (prop::sample::select(vec![16u32, 24, 32]), 1..=16u32).prop_flat_map(|(word_bits, fraction)| {
        let config = tables(fraction, 62).prop_map(move |table| ShaperConfig::new(word_bits, table).unwrap());
        (config, events(fraction))
    })
}

fn load(shaper: &mut Shaper, table: &TapTable, bank: u8) {
    for (index, tap) in table.taps().iter().enumerate() {
        shaper.step(&Inputs {
            tap_write: true,
            tap_bank: bank,
            tap_index: index as u16,
            tap_coefficient: tap.coefficient,
            tap_delay: tap.delay_samples as u16,
            ..Inputs::default()
        });
    }
    shaper.step(&Inputs {
        swap: true,
        swap_bank: bank,
        ..Inputs::default()
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn prop_clock_by_clock_gives_the_samples_of_the_fast_path((config, events) in cases()) {
        let mut clocked = Shaper::new(&config, 1);
        let mut fast = SampleShaper::new(&config);
        let mut active_taps = config.table().taps().len() as u32;
        let mut next_table: Option<(TapTable, u8)> = None;
        for event in events {
            match event {
                Event::Sample { x, pause } => {
                    if let Some((table, _)) = next_table.take() {
                        active_taps = table.taps().len() as u32;
                        fast.swap(&table).unwrap();
                    }
                    let expected = fast.push(x);
                    clocked.step(&Inputs { strobe: true, x, ..Inputs::default() });
                    for _ in 1..pass_clocks(active_taps) {
                        prop_assert!(!clocked.step(&Inputs::default()).valid);
                    }
                    let shown = clocked.outputs();
                    prop_assert!(shown.valid && !shown.busy && !shown.overrun);
                    prop_assert_eq!(shown.y, expected);
                    for _ in 0..pause {
                        clocked.step(&Inputs::default());
                    }
                }
                Event::Start(x) => {
                    clocked.step(&Inputs { start: true, x, ..Inputs::default() });
                    prop_assert_eq!(clocked.outputs().y, fast.start(x));
                }
                Event::Table(table, bank) => {
                    // A host loads a bank at rest: the hardware would refuse another, so that one is not requested.
                    if next_table.is_none() && clocked.outputs().bank != bank {
                        load(&mut clocked, &table, bank);
                        prop_assert!(clocked.outputs().swap_pending && !clocked.outputs().refused);
                        next_table = Some((table, bank));
                    }
                }
                Event::Reset => {
                    clocked.step(&Inputs { rst: true, ..Inputs::default() });
                    prop_assert_eq!(clocked.outputs(), Outputs::default());
                    fast = SampleShaper::new(&config);
                    active_taps = config.table().taps().len() as u32;
                    next_table = None;
                }
                Event::Clear => {
                    clocked.step(&Inputs { clear_flags: true, ..Inputs::default() });
                    prop_assert!(!clocked.outputs().saturated);
                }
            }
        }
    }

    #[test]
    fn prop_the_fast_path_is_exact_arithmetic_rounded_once(
        (config, samples) in (prop::sample::select(vec![16u32, 24, 32]), 1..=16u32).prop_flat_map(|(bits, fraction)| {
            let x = prop_oneof![Just(i64::MAX), Just(i64::MIN), any::<i64>()].prop_map(move |x| x >> (64 - bits));
            let config = tables(fraction, 62).prop_map(move |table| ShaperConfig::new(bits, table).unwrap());
            (config, prop::collection::vec(x, 1..150))
        })
    ) {
        let mut fast = SampleShaper::new(&config);
        let start = samples[0];
        fast.start(start);
        for n in 0..samples.len() {
            let x = |delay: u32| n.checked_sub(delay as usize).map_or(start, |place| samples[place]);
            let weight = |tap: &Tap| {
                I96F32::from_bits(i128::from(tap.coefficient) << (32 - config.coefficient_fraction()))
            };
            let exact: I96F32 = config.table().taps().iter().map(|t| weight(t) * I96F32::from_num(x(t.delay_samples))).sum();
            let rounded: i64 = (exact + I96F32::ONE / 2).floor().to_num();
            prop_assert_eq!(fast.push(samples[n]), rounded.clamp(config.word_min(), config.word_max()));
        }
    }

    #[test]
    fn prop_many_samples_at_once_are_the_same_in_pieces_of_any_length(
        table in prop_oneof![tables(14, 40), tables(14, 5000)],
        lengths in prop::collection::vec(prop_oneof![0usize..70, 2000usize..9000], 1..5),
        seed: u32,
    ) {
        let config = ShaperConfig::new(32, table).unwrap();
        let (mut each, mut many) = (SampleShaper::new(&config), SampleShaper::new(&config));
        let mut word = seed as i32;
        for length in lengths {
            let command: Vec<i32> = (0..length).map(|_| {
                word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                word
            }).collect();
            let expected: Vec<i32> = command.iter().map(|x| each.push(i64::from(*x)) as i32).collect();
            let mut shaped = vec![0; length];
            many.shape(&command, &mut shaped).unwrap();
            prop_assert_eq!(shaped, expected);
            prop_assert_eq!(many.push(7), each.push(7));
            prop_assert_eq!(many.saturated(), each.saturated());
        }
        prop_assert!(many.shape(&[1i64, 2], &mut [0; 3]).is_err());
    }

    #[test]
    fn prop_a_constant_goes_through_unchanged((config, _) in cases(), x: i64) {
        let mut fast = SampleShaper::new(&config);
        let started = fast.start(x);
        for _ in 0..80 {
            prop_assert_eq!(fast.push(x), started);
        }
        prop_assert!(!fast.saturated());
    }

    #[test]
    fn prop_no_output_shows_what_the_memories_held((config, events) in cases(), noise in prop::collection::vec(any::<u64>(), 300)) {
        let mut one = Shaper::new(&config, 1);
        let mut other = Shaper::new(&config, 0x1234_5678);
        let both = |one: &mut Shaper, other: &mut Shaper, inputs: Inputs| {
            prop_assert_eq!(one.step(&inputs), other.step(&inputs));
            Ok(())
        };
        for event in events {
            match event {
                Event::Sample { x, pause } => {
                    both(&mut one, &mut other, Inputs { strobe: true, x, ..Inputs::default() })?;
                    for _ in 0..pause * 10 {
                        both(&mut one, &mut other, Inputs::default())?;
                    }
                }
                Event::Start(x) => both(&mut one, &mut other, Inputs { start: true, x, ..Inputs::default() })?,
                Event::Table(table, bank) => {
                    load(&mut one, &table, bank);
                    load(&mut other, &table, bank);
                }
                Event::Reset => both(&mut one, &mut other, Inputs { rst: true, ..Inputs::default() })?,
                Event::Clear => both(&mut one, &mut other, Inputs { clear_flags: true, ..Inputs::default() })?,
            }
        }
        for word in noise {
            let bit = |place: u32| word >> place & 1 != 0;
            both(&mut one, &mut other, Inputs {
                rst: word.is_multiple_of(97),
                strobe: bit(0),
                start: bit(1) && bit(2),
                x: word as i64,
                clear_flags: bit(3),
                tap_write: bit(4),
                tap_bank: (word >> 5) as u8,
                tap_index: (word >> 13 & 3) as u16,
                tap_coefficient: (word >> 15) as i32,
                tap_delay: (word >> 33) as u16,
                swap: bit(50),
                swap_bank: (word >> 51) as u8,
                ..Inputs::default()
            })?;
        }
    }
}
