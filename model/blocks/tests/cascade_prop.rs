//! The cascade compared with its table, and its two models with each other.

use posicast_blocks::cascade::{Cascade, CascadeConfig, Inputs, SampleCascade, WORD_BITS, pass_clocks};
use posicast_blocks::shaper::{SampleShaper, ShaperConfig};
use proptest::prelude::*;

fn cascade() -> impl Strategy<Value = CascadeConfig> {
    // Delays are few or equal, so that the table of 2^n impulses has no more taps than a shaper holds.
    let any_delays = proptest::collection::vec(1u32..100, 1..=8);
    let equal_delays = (1u32..100, 1usize..=16).prop_map(|(delay, stages)| vec![delay; stages]);
    let multiples = proptest::collection::vec(prop_oneof![Just(3u32), Just(6), Just(9)], 1..=16);
    (WORD_BITS, prop_oneof![any_delays, equal_delays, multiples])
        .prop_map(|(word_bits, delays)| CascadeConfig::new(word_bits, delays).unwrap())
}

proptest! {
    #[test]
    fn prop_equal_to_its_table_sample_by_sample(
        config in cascade(),
        finer in 0u32..=15,
        start: i64,
        commands in proptest::collection::vec(any::<i64>(), 1..600),
        steady: bool,
    ) {
        let fraction = (config.stages() + finer).min(16);
        let table = config.tap_table(fraction).unwrap();
        let mut shaper = SampleShaper::new(&ShaperConfig::new(config.word_bits(), table).unwrap());
        let mut cascade = SampleCascade::new(&config);
        for restart in [false, true] {
            if restart {
                prop_assert_eq!(cascade.start(start), shaper.start(start));
            }
            for &x in &commands {
                // The input is full scale for long times, or noise.
                let x = if steady { x >> 63 ^ (1 << (config.word_bits() - 1)) } else { x };
                prop_assert_eq!(cascade.push(x), shaper.push(x));
            }
        }
        prop_assert!(!shaper.saturated());
    }

    #[test]
    fn prop_a_constant_stays_what_it_is(config in cascade(), x: i64) {
        let mut cascade = SampleCascade::new(&config);
        let word = cascade.start(x);
        prop_assert!((0..300).all(|_| cascade.push(x) == word));
    }

    #[test]
    fn prop_samples_and_clocks_agree(
        config in cascade(),
        seed: u64,
        steps in proptest::collection::vec((any::<i64>(), 0u32..5, 0u32..20), 1..300),
    ) {
        let mut clocked = Cascade::new(&config, seed);
        let mut fast = SampleCascade::new(&config);
        for (x, pause, start) in steps {
            let start = start == 0;
            if start {
                fast.start(x);
            }
            let expected = fast.push(x);
            clocked.step(&Inputs { strobe: true, start, x, ..Inputs::default() });
            for _ in 1..pass_clocks(config.stages()) {
                let shown = clocked.step(&Inputs::default());
                prop_assert!(shown.busy && !shown.valid);
            }
            prop_assert!(clocked.outputs().valid && !clocked.outputs().busy && !clocked.outputs().overrun);
            prop_assert_eq!(clocked.outputs().y, expected);
            for _ in 0..pause {
                clocked.step(&Inputs::default());
            }
        }
    }

    #[test]
    fn prop_no_output_shows_what_the_memory_held(
        config in cascade(),
        inputs in proptest::collection::vec((any::<i64>(), 0u32..100), 1..2000),
    ) {
        let mut one = Cascade::new(&config, 1);
        let mut other = Cascade::new(&config, 2);
        for (x, dice) in inputs {
            let inputs = Inputs {
                rst: dice == 0,
                start: dice % 7 == 1,
                strobe: dice % 5 < 2,
                clear_flags: dice == 50,
                x,
            };
            prop_assert_eq!(one.step(&inputs), other.step(&inputs));
        }
    }
}

fn idle(cascade: &mut Cascade, clocks: u32) {
    for _ in 0..clocks {
        cascade.step(&Inputs::default());
    }
}

#[test]
fn a_strobe_in_a_pass_is_lost_and_flagged() {
    let config = CascadeConfig::new(16, vec![1, 1]).unwrap();
    let mut cascade = Cascade::new(&config, 1);
    let strobe = |x| Inputs {
        strobe: true,
        x,
        ..Inputs::default()
    };
    cascade.step(&strobe(400));
    cascade.step(&strobe(-8000));
    idle(&mut cascade, 8);
    assert_eq!((cascade.outputs().y, cascade.outputs().overrun), (100, true));
    // The flag is set although it is cleared in the same clock, and the history has no trace of the lost sample.
    cascade.step(&Inputs {
        clear_flags: true,
        ..strobe(400)
    });
    assert!(!cascade.outputs().overrun);
    cascade.step(&Inputs {
        clear_flags: true,
        ..strobe(7)
    });
    idle(&mut cascade, 8);
    assert_eq!((cascade.outputs().y, cascade.outputs().overrun), (300, true));
}
