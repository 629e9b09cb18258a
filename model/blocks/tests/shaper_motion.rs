//! The motion shaper: its two models compared with each other, and with what a handover and a modulo axis guarantee.

use posicast_blocks::shaper::{Inputs, MotionShaper, Shaper, ShaperConfig, ShaperMotion, swap_how};
use posicast_taps::{Tap, TapTable};
use proptest::prelude::*;
use std::collections::BTreeMap;

const FRACTION: u32 = 14;

/// Returns tables of up to 8 taps whose coefficients sum to one.
fn tables(longest: u32) -> impl Strategy<Value = TapTable> {
    prop::collection::btree_map(0..=longest, -9000..9000i32, 1..8).prop_map(|taps| complete(taps).unwrap())
}

fn complete(mut taps: BTreeMap<u32, i32>) -> Option<TapTable> {
    taps.values_mut().filter(|c| **c == 0).for_each(|c| *c = 1);
    let missing = (1 << FRACTION) - taps.values().sum::<i32>();
    *taps.values_mut().next()? += missing;
    let list = taps.into_iter().filter(|(_, coefficient)| *coefficient != 0);
    let list = list.map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    TapTable::new(FRACTION, list.collect()).ok()
}

fn config(word_bits: u32, table: TapTable, channels: u32, modulo: bool) -> ShaperConfig {
    ShaperConfig::new(word_bits, table)
        .and_then(|config| config.for_motion(ShaperMotion { channels, modulo }))
        .unwrap()
}

#[derive(Debug, Clone)]
enum Event {
    Sample([i64; 3]),
    /// This many samples that repeat the last one.
    Hold(u32),
    Start([i64; 3]),
    Swap(TapTable, u8, u8),
}

fn events() -> impl Strategy<Value = Vec<Event>> {
    let near = prop::array::uniform3(-2000..2000i64);
    let event = prop_oneof![
        30 => near.prop_map(Event::Sample),
        6 => prop::array::uniform3(any::<i64>()).prop_map(Event::Sample),
        3 => (1..40u32).prop_map(Event::Hold),
        1 => prop::array::uniform3(any::<i64>()).prop_map(Event::Start),
        6 => (tables(20), 1..3u8, 0..3u8).prop_map(|(table, bank, how)| Event::Swap(table, bank, how)),
    ];
    prop::collection::vec(event, 1..150)
}

/// A shaper at its ports and its fast path, which must agree.
struct Both {
    clocked: Shaper,
    fast: MotionShaper,
    last: [i64; 3],
}

impl Both {
    fn new(config: &ShaperConfig) -> Self {
        Self {
            clocked: Shaper::new(config, 5),
            fast: MotionShaper::new(config),
            last: [0; 3],
        }
    }

    fn sample(&mut self, words: [i64; 3]) -> [i64; 3] {
        self.last = words;
        let [x, x_rates @ ..] = words;
        self.clocked.step(&Inputs {
            strobe: true,
            x,
            x_rates,
            ..Inputs::default()
        });
        let done = (0..1000).find(|_| {
            self.clocked.step(&Inputs::default());
            self.clocked.outputs().valid
        });
        let shown = self.clocked.outputs();
        assert!(done.is_some() && !shown.overrun);
        let expected = self.fast.push(words);
        let [velocity, acceleration] = shown.y_rates;
        assert_eq!([shown.y, velocity, acceleration], expected);
        assert_eq!(shown.swap_pending, self.fast.changes());
        assert_eq!(shown.saturated, self.fast.saturated());
        expected
    }

    /// Loads a table and requests a swap, unless a swap is pending or the bank is in use; returns whether it did.
    fn swap(&mut self, table: &TapTable, bank: u8, how: u8) -> bool {
        if self.clocked.outputs().swap_pending || self.clocked.outputs().bank == bank {
            return false;
        }
        for (index, tap) in table.taps().iter().enumerate() {
            self.clocked.step(&Inputs {
                tap_write: true,
                tap_bank: bank,
                tap_index: index as u16,
                tap_coefficient: tap.coefficient,
                tap_delay: tap.delay_samples as u16,
                ..Inputs::default()
            });
        }
        self.clocked.step(&Inputs {
            swap: true,
            swap_bank: bank,
            swap_how: how,
            ..Inputs::default()
        });
        self.fast.swap(table, how).unwrap();
        assert!(self.clocked.outputs().swap_pending && !self.clocked.outputs().refused);
        true
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn prop_motion_clock_by_clock_gives_the_samples_of_the_fast_path(
        table in tables(30), wide: bool, channels in 1..=3u32, modulo: bool, events in events()
    ) {
        let config = config(if wide { 32 } else { 24 }, table, channels, modulo);
        let mut both = Both::new(&config);
        for event in events {
            match event {
                Event::Sample(words) => { both.sample(words); }
                Event::Hold(samples) => (0..samples).for_each(|_| { both.sample(both.last); }),
                Event::Start(words) => {
                    let [x, x_rates @ ..] = words;
                    both.clocked.step(&Inputs { start: true, x, x_rates, ..Inputs::default() });
                    prop_assert_eq!(both.fast.start(words)[0], both.clocked.outputs().y);
                    both.last = words;
                }
                Event::Swap(table, bank, how) => { both.swap(&table, bank, how); }
            }
        }
    }

    /// This checks not the formula of the datasheet but its basis: every increment passes through one table as a
    /// whole.
    #[test]
    fn prop_in_a_handover_each_increment_goes_through_exactly_one_table(
        old in tables(30), new in tables(30), samples in prop::collection::vec(-100_000..100_000i64, 80), change in 1..50usize
    ) {
        let mut shaper = MotionShaper::new(&config(32, old.clone(), 1, false));
        shaper.start([samples[0], 0, 0]);
        for (n, x) in samples.iter().enumerate() {
            if n == change {
                shaper.swap(&new, swap_how::HANDOVER).unwrap();
            }
            let mut sum = samples[0] << FRACTION;
            for k in 1..=n {
                let table = if k < change { &old } else { &new };
                let arrived = table.taps().iter().filter(|tap| tap.delay_samples as usize <= n - k);
                let arrived: i64 = arrived.map(|tap| i64::from(tap.coefficient)).sum();
                sum += (samples[k] - samples[k - 1]) * arrived;
            }
            prop_assert_eq!(shaper.push([*x, 0, 0])[0], (sum + (1 << (FRACTION - 1))) >> FRACTION);
        }
    }

    #[test]
    fn prop_the_velocity_stays_the_positions_derivative_through_a_handover(
        old in tables(30), new in tables(30), samples in prop::collection::vec(-100_000..100_000i64, 120), change in 2..60usize
    ) {
        let mut shaper = MotionShaper::new(&config(32, old, 2, false));
        let mut x = 0;
        let (mut position, mut summed) = (0, 0);
        for (n, next) in samples.iter().enumerate() {
            if n == change {
                shaper.swap(&new, swap_how::HANDOVER).unwrap();
            }
            let [y, y_velocity, _] = shaper.push([*next, next - x, 0]);
            x = *next;
            // Both positions and the velocity are rounded by at most half an LSB each, so that integers differ by one
            // at most.
            prop_assert!((y - position - y_velocity).abs() <= 1, "sample {}", n);
            summed += y_velocity;
            prop_assert!((y - summed).abs() <= (n as i64 + 3) / 2, "sample {}", n);
            position = y;
        }
    }

    #[test]
    fn prop_a_constant_goes_through_a_handover_unchanged(old in tables(30), new in tables(30), x: i32, modulo: bool) {
        let mut shaper = MotionShaper::new(&config(32, old, 2, modulo));
        let words = [i64::from(x), 0, 0];
        shaper.start(words);
        for n in 0..80 {
            if n == 20 {
                shaper.swap(&new, swap_how::HANDOVER).unwrap();
            }
            prop_assert_eq!(shaper.push(words), words);
        }
        prop_assert!(!shaper.saturated());
    }

    #[test]
    fn prop_a_swap_when_settled_takes_effect_without_a_jump(
        old in tables(30), new in tables(30), samples in prop::collection::vec(-100_000..100_000i64, 1..20)
    ) {
        let mut shaper = MotionShaper::new(&config(32, old, 1, false));
        let mut handed_over = shaper.clone();
        for (n, x) in samples.iter().chain(&[samples[samples.len() - 1]; 60]).enumerate() {
            if n == 1 {
                shaper.swap(&new, swap_how::WHEN_SETTLED).unwrap();
            }
            let waits = shaper.changes();
            let y = shaper.push([*x, 0, 0]);
            if waits && !shaper.changes() {
                handed_over.swap(&new, swap_how::HANDOVER).unwrap();
            }
            prop_assert_eq!(y, handed_over.push([*x, 0, 0]));
        }
        prop_assert!(!shaper.changes());
    }

    #[test]
    fn prop_a_rotary_axis_does_the_same_wherever_it_stands(
        old in tables(30), new in tables(30), steps in prop::collection::vec(-20_000..20_000i64, 100), shift: i32, change in 1..60usize
    ) {
        let wrap = |x: i64| i64::from(x as i32);
        let run = |shift: i64| {
            let mut shaper = MotionShaper::new(&config(32, old.clone(), 2, true));
            shaper.start([shift, 0, 0]);
            let mut x = shift;
            let mut outputs = Vec::new();
            for (n, step) in steps.iter().enumerate() {
                if n == change {
                    shaper.swap(&new, swap_how::HANDOVER).unwrap();
                }
                x = wrap(x + step);
                outputs.push(shaper.push([x, *step, 0]));
            }
            assert!(!shaper.saturated());
            outputs
        };
        let here = run(0);
        for shift in [i64::from(shift), i64::from(i32::MAX), i64::from(i32::MIN), 1 << 30] {
            for (there, here) in run(shift).iter().zip(&here) {
                prop_assert_eq!(there[0], wrap(here[0] + shift));
                prop_assert_eq!(there[1], here[1]);
            }
        }
    }

    #[test]
    fn prop_away_from_the_ends_a_rotary_axis_is_a_linear_one(
        table in tables(30), samples in prop::collection::vec(-1_000_000..1_000_000i64, 100)
    ) {
        let mut rotary = MotionShaper::new(&config(32, table.clone(), 1, true));
        let mut linear = MotionShaper::new(&config(32, table, 1, false));
        for x in samples {
            prop_assert_eq!(rotary.push([x, 0, 0]), linear.push([x, 0, 0]));
        }
    }
}

#[test]
fn a_handover_takes_two_passes_and_refuses_what_comes_in_it() {
    let half = |delay_samples| Tap {
        delay_samples,
        coefficient: 1 << (FRACTION - 1),
    };
    let table = TapTable::new(FRACTION, vec![half(0), half(4)]).unwrap();
    let config = config(32, table, 2, false);
    assert_eq!(config.most_products(), 2 * 2 * 2 + 1);
    assert!(config.fits(20).is_ok() && config.fits(19).unwrap_err().needed == 20);
    let mut both = Both::new(&config);
    let bypass = TapTable::bypass(FRACTION).unwrap();
    assert!(both.swap(&bypass, 1, swap_how::HANDOVER));
    for (sample, pending) in [(100, true), (200, true), (300, true), (400, true), (500, false)] {
        both.sample([sample, 0, 0]);
        assert_eq!(
            (both.clocked.outputs().swap_pending, both.clocked.outputs().bank),
            (pending, 1)
        );
        let write = Inputs {
            tap_write: true,
            tap_bank: 2,
            ..Inputs::default()
        };
        let swap = Inputs {
            swap: true,
            swap_bank: 0,
            ..Inputs::default()
        };
        for refused in [write, swap].into_iter().filter(|_| pending) {
            both.clocked.step(&refused);
            assert!(both.clocked.outputs().refused);
            both.clocked.step(&Inputs {
                clear_flags: true,
                ..Inputs::default()
            });
            assert!(!both.clocked.outputs().refused);
        }
    }
    both.clocked.step(&Inputs {
        swap: true,
        swap_bank: 0,
        swap_how: 3,
        ..Inputs::default()
    });
    assert!(both.clocked.outputs().refused, "there is no such way");
}

#[test]
fn what_no_shaper_for_motion_can_be_is_named() {
    let bypass = || TapTable::bypass(FRACTION).unwrap();
    let motion = |channels| ShaperMotion {
        channels,
        modulo: false,
    };
    let refused = |word_bits, delay, channels| {
        let config = ShaperConfig::new(word_bits, bypass()).and_then(|c| c.with_room_for(delay, 1));
        config
            .and_then(|c| c.for_motion(motion(channels)))
            .unwrap_err()
            .to_string()
    };
    assert!(refused(32, 0, 0).contains("0 channels") && refused(32, 0, 4).contains("4 channels"));
    assert!(refused(17, 0, 1).contains("18 to 32"));
    assert!(refused(32, 5000, 2).contains("4094"));
    let late = ShaperConfig::new(32, bypass())
        .and_then(|c| c.for_motion(motion(3)))
        .unwrap();
    assert!(late.with_room_for(4095, 1).is_err());
}
