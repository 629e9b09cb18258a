//! The internal encoder compared with its datasheet, and connected to the pulse counter that it tests.

use posicast_blocks::encoder_generator::{EncoderGenerator, Inputs, LINES};
use posicast_blocks::pulse_counter::{self, PulseCounter};
use proptest::prelude::*;

fn looped(rate: i32, index_every: u16) -> Inputs {
    Inputs {
        loop_back: true,
        rate,
        index_every,
        ..Inputs::default()
    }
}

/// Generator and counter side by side; each sees what the other showed before the edge.
struct Bench {
    generator: EncoderGenerator,
    counter: PulseCounter,
    settings: pulse_counter::Inputs,
    /// Number of latched indices.
    indices: u32,
}

impl Bench {
    fn new() -> Self {
        Self {
            generator: EncoderGenerator::new(),
            counter: PulseCounter::new(),
            indices: 0,
            settings: pulse_counter::Inputs {
                index_always: true,
                differential: true,
                ..pulse_counter::Inputs::default()
            },
        }
    }

    fn run(&mut self, inputs: &Inputs, clocks: usize) {
        for _ in 0..clocks {
            let [a, b, z, a_n, b_n, z_n] = self.generator.step(inputs).lines();
            let rst = inputs.rst;
            let lines = pulse_counter::Inputs {
                rst,
                a,
                b,
                z,
                a_n,
                b_n,
                z_n,
                ..self.settings
            };
            self.indices += u32::from(self.counter.step(&lines).index_seen);
        }
    }
}

proptest! {
    #[test]
    fn prop_the_count_is_the_floor_of_the_exact_sum(
        rates in prop::collection::vec((prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), -4i32..4], 1..40u32), 1..40),
    ) {
        let mut generator = EncoderGenerator::new();
        let mut exact = 0i128;
        for (rate, clocks) in rates {
            for _ in 0..clocks {
                generator.step(&looped(rate, 0));
                exact += i128::from(rate);
                prop_assert_eq!(i128::from(generator.outputs().generated_count), exact >> 32);
            }
        }
    }

    #[test]
    fn prop_edges_are_single_and_never_in_successive_clocks(
        rates in prop::collection::vec(prop_oneof![any::<i32>(), Just(i32::MIN), Just(i32::MAX), -4i32..4], 1..400),
        hold in 1..6usize,
        index_every in 0..40u16,
    ) {
        let mut generator = EncoderGenerator::new();
        let mut before = None;
        let mut changed = false;
        for rate in rates.iter().flat_map(|rate| std::iter::repeat_n(*rate, hold)) {
            generator.step(&looped(rate, index_every));
            let [a, b, z, a_n, b_n, z_n] = generator.outputs().lines();
            prop_assert_eq!((a_n, b_n, z_n), (!a, !b, !z));
            prop_assert!(!z || !(a || b), "the index is where A and B are low");
            if let Some((a_before, b_before)) = before {
                let changes = u8::from(a != a_before) + u8::from(b != b_before);
                prop_assert!(changes <= 1 && !(changed && changes > 0));
                changed = changes > 0;
            }
            before = Some((a, b));
        }
    }

    #[test]
    fn prop_the_pulse_counter_counts_what_was_generated(
        rates in prop::collection::vec((any::<i32>(), 0..31u32, 1..200usize), 1..20),
        index_every in 1..10u16,
    ) {
        let mut bench = Bench::new();
        bench.run(&Inputs { rst: true, ..looped(0, 0) }, 3);
        bench.run(&looped(0, 4 * index_every), 10);
        // After a reset, a counter takes pairs of lines that it has not seen yet as equal.
        bench.settings.clear_flags = true;
        bench.run(&looped(0, 4 * index_every), 1);
        bench.settings.clear_flags = false;
        for (rate, shift, clocks) in rates {
            bench.run(&looped(rate >> shift, 4 * index_every), clocks);
        }
        bench.run(&looped(0, 4 * index_every), 20);
        let (counter, generated) = (bench.counter.outputs(), bench.generator.outputs().generated_count);
        prop_assert_eq!(counter.count, generated);
        prop_assert!(!counter.illegal && !counter.disagreement);
        prop_assert_eq!(counter.index_count % i32::from(4 * index_every), 0);
        prop_assert!(bench.indices > 0 || generated.unsigned_abs() < u32::from(4 * index_every));
    }
}

#[test]
fn pins_come_through_a_clock_later() {
    let mut generator = EncoderGenerator::new();
    for pattern in 0..64u8 {
        let pins: [bool; LINES] = std::array::from_fn(|line| pattern >> line & 1 != 0);
        let inputs = Inputs {
            rate: i32::MAX,
            ..Inputs::default()
        }
        .with_pins(pins);
        generator.step(&inputs);
        assert_eq!(generator.outputs().lines(), pins);
    }
    assert_eq!(generator.outputs().generated_count, 31);
}

#[test]
fn an_index_once_in_so_many_counts_both_ways() {
    // It makes 1000 counts up, then 1000 down, with an index every 40 (43 is reduced to 40): at 0, 40, …, 1000.
    for (rate, index_every, expected) in [(1 << 29, 40, 26), (1 << 29, 43, 26), (1 << 29, 3, 0), (1 << 29, 4, 251)] {
        let mut generator = EncoderGenerator::new();
        for direction in [rate, -rate] {
            let (mut indices, mut before) = (0, false);
            // It runs half a count more than 1000 up, and back to 0.
            for _ in 0..8 * 1000 + 4 {
                generator.step(&looped(direction, index_every));
                let z = generator.outputs().z;
                indices += i32::from(z && !before);
                before = z;
            }
            assert_eq!(indices, expected, "every {index_every}");
        }
    }
}

#[test]
fn a_reset_shows_no_step_to_the_counter() {
    let high = Inputs::default().with_pins([true, true, true, false, false, false]);
    for inputs in [high, looped(1 << 30, 0)] {
        for reset_clocks in 1..4 {
            let mut bench = Bench::new();
            bench.run(&inputs, 50);
            bench.run(&Inputs { rst: true, ..inputs }, reset_clocks);
            bench.run(&Inputs { rate: 0, ..inputs }, 30);
            let outputs = bench.counter.outputs();
            assert_eq!((outputs.count, outputs.illegal), (0, false));
        }
    }
}

#[test]
fn a_shorter_turn_takes_the_index_back_into_it() {
    let mut generator = EncoderGenerator::new();
    let mut run = |index_every, clocks| {
        let mut seen = 0;
        for _ in 0..clocks {
            generator.step(&looped(1 << 30, index_every));
            seen += u32::from(generator.outputs().z);
        }
        seen
    };
    run(4000, 4 * 2000);
    // 400 counts are 10 turns of 40; an index lasts for one count of 4 clocks, and is visible two clocks late.
    assert_eq!(run(40, 4 * 400), 4 * 10 - 2);
}
