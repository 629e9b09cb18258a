//! The shaper in RustHDL's simulator compared with its model: every output, every clock.

use crate::stimulus;

use posicast_blocks::shaper::{
    Inputs, Outputs, RING_ADDRESS_BITS, Shaper, ShaperConfig, ShaperMotion, TAP_INDEX_BITS, pass_clocks, swap_how,
};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_taps::{Tap, TapTable};
use stimulus::{Anything, Random, load, table};

/// The model and the simulated shaper, stepped together.
struct LockStep {
    config: ShaperConfig,
    model: Shaper,
    rusthdl: Box<dyn ClockedBlock>,
    clock: u64,
}

impl LockStep {
    fn new(config: &ShaperConfig) -> Self {
        let rusthdl = posicast_hdl::shaper::simulate(config).unwrap();
        let model = Shaper::new(config, 7);
        assert_eq!(rusthdl.ports(), model.ports());
        Self {
            config: config.clone(),
            model,
            rusthdl,
            clock: 0,
        }
    }

    fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.model.ports().iter().filter(|p| p.direction == Direction::Output);
        let mut shown = vec![0; outputs.count()];
        self.rusthdl.step(&inputs.to_raw(&self.config), &mut shown).unwrap();
        let expected = self.model.step(inputs);
        let actual = Outputs::from_raw(&shown, &self.config);
        assert_eq!(
            actual, expected,
            "clock {}, inputs {inputs:?}, {:?}",
            self.clock, self.config
        );
        self.clock += 1;
        expected
    }

    fn idle(&mut self, clocks: u32) -> Outputs {
        (0..clocks).map(|_| self.step(&Inputs::default())).last().unwrap()
    }

    fn strobe(&mut self, x: i64) {
        self.step(&Inputs {
            strobe: true,
            x,
            ..Inputs::default()
        });
    }
}

fn config(word_bits: u32, fraction: u32, taps: &[(u32, i32)]) -> ShaperConfig {
    let list = taps
        .iter()
        .map(|&(delay_samples, coefficient)| Tap {
            delay_samples,
            coefficient,
        })
        .collect();
    ShaperConfig::new(word_bits, TapTable::new(fraction, list).unwrap()).unwrap()
}

#[test]
fn long_lockstep_everything_at_random() {
    let mut random = Random(1);
    for (word_bits, taps, longest, fraction, gain) in [
        (16, 3, 20, 16, 1),
        (24, 9, 62, 15, 3),
        (32, 16, 40, 16, 2),
        (32, 40, 80, 9, 4),
        (16, 5, 62, 1, 1),
    ] {
        let machine = table(&mut random, fraction, taps, longest, gain);
        let config = ShaperConfig::new(word_bits, machine).unwrap();
        let mut both = LockStep::new(&config);
        let mut seen = Outputs::default();
        let mut passes = [0; 3];
        for inputs in Anything::new(&config, random.word()).take(8_000) {
            let shown = both.step(&inputs);
            seen.saturated |= shown.saturated;
            seen.overrun |= shown.overrun;
            seen.refused |= shown.refused;
            passes[usize::from(shown.bank)] += u32::from(shown.valid);
        }
        assert!(seen.overrun && seen.refused, "{config:?}");
        assert!(seen.saturated || gain == 1, "{config:?}");
        assert!(passes.iter().all(|&n| n > 5), "passes per bank {passes:?}, {config:?}");
    }
}

#[test]
fn long_lockstep_motion_with_any_channels_at_random() {
    let mut random = Random(21);
    for (word_bits, channels, modulo, taps, longest) in [
        (24, 1, false, 4, 9),
        (32, 2, false, 3, 5),
        (32, 3, true, 5, 12),
        (24, 1, true, 9, 40),
    ] {
        let machine = table(&mut random, 15, taps, longest, 2);
        let config = ShaperConfig::new(word_bits, machine)
            .and_then(|c| c.for_motion(ShaperMotion { channels, modulo }))
            .unwrap();
        let mut both = LockStep::new(&config);
        let mut seen = Outputs::default();
        let mut handovers = [0; 2];
        for inputs in Anything::new(&config, random.word()).take(12_000) {
            let shown = both.step(&inputs);
            handovers[0] += u32::from(shown.swap_pending && shown.bank != seen.bank);
            handovers[1] += u32::from(seen.swap_pending && !shown.swap_pending && shown.bank == seen.bank);
            seen.bank = shown.bank;
            seen.swap_pending = shown.swap_pending;
            seen.saturated |= shown.saturated;
            seen.overrun |= shown.overrun;
            seen.refused |= shown.refused;
        }
        assert!(seen.overrun && seen.refused && (seen.saturated || modulo), "{config:?}");
        assert!(handovers[0] > 0 && handovers[1] > 0, "{handovers:?}, {config:?}");
    }
}

#[test]
fn lockstep_motion_hands_over_sample_by_sample() {
    let config = config(32, 16, &[(0, 20_000), (7, 45_536)]);
    let config = config
        .for_motion(ShaperMotion {
            channels: 3,
            modulo: false,
        })
        .unwrap();
    let next = TapTable::new(
        16,
        [(0, 30_000), (3, -4000), (12, 39_536)]
            .map(|(delay_samples, coefficient)| Tap {
                delay_samples,
                coefficient,
            })
            .to_vec(),
    )
    .unwrap();
    let mut both = LockStep::new(&config);
    for mut inputs in load(&next, 2) {
        inputs.swap_how = swap_how::HANDOVER;
        both.step(&inputs);
    }
    // The handover lasts 12 samples, with 3 channels of 2 + 3 taps and one correction; then 3 channels have 3 taps.
    for sample in 0..16 {
        let products = if sample < 12 { 3 * (2 + 3) + 1 } else { 3 * 3 };
        both.step(&Inputs {
            strobe: true,
            x: 1000 * sample,
            x_rates: [1000, 7],
            ..Inputs::default()
        });
        let last = both.idle(config.pass_clocks(products) - 1);
        assert!(
            last.busy && !last.valid && last.swap_pending == (sample < 12),
            "sample {sample}"
        );
        assert!(both.step(&Inputs::default()).valid, "sample {sample}");
    }
}

#[test]
fn lockstep_the_sizes_for_motion() {
    for word_bits in [18, 24, 32] {
        for channels in 1..=3 {
            for ring in RING_ADDRESS_BITS.filter(|&ring| ring <= 12 || channels == 1) {
                for index in TAP_INDEX_BITS {
                    let machine = table(&mut Random(5), 16, 4, 9, 2);
                    let modulo = ring % 2 == 0 && word_bits != 18;
                    let config = ShaperConfig::new(word_bits, machine)
                        .and_then(|c| c.with_room_for((1 << ring) - 2, 1 << index))
                        .and_then(|c| c.for_motion(ShaperMotion { channels, modulo }))
                        .unwrap();
                    let mut both = LockStep::new(&config);
                    for inputs in Anything::new(&config, u64::from(word_bits * ring * index)).take(80) {
                        both.step(&inputs);
                    }
                }
            }
        }
    }
}

#[test]
fn lockstep_a_result_stands_pass_clocks_after_its_strobe() {
    for taps in [1, 2, 16] {
        let machine = table(&mut Random(3), 16, taps, 30, 1);
        let config = ShaperConfig::new(32, machine).unwrap();
        let pass = pass_clocks(config.table().taps().len() as u32);
        let mut both = LockStep::new(&config);
        for sample in 0..50 {
            both.strobe(sample * 1000);
            // The strobe is in clock 0; the next one is in the first clock in which it does not cause an overrun.
            let last = both.idle(pass - 1);
            assert!(!last.valid && last.busy);
        }
        assert!(both.step(&Inputs::default()).valid);
        assert!(!both.idle(1).overrun);
    }
}

#[test]
fn lockstep_full_scale_saturates_at_both_ends() {
    // Σ|c|/2^F = 3. Full-scale inputs of alternating sign are the worst case for the signs +, −, + of the coefficients.
    let config = config(32, 16, &[(0, 65536), (1, -65536), (2, 65536)]);
    let (low, high) = (config.word_min(), config.word_max());
    let mut both = LockStep::new(&config);
    let mut outputs = Vec::new();
    for x in [high, low, high, high, low, high, low, low, 0] {
        both.strobe(x);
        both.idle(pass_clocks(3));
        outputs.push(both.outputs_y());
    }
    assert!(outputs.contains(&high) && outputs.contains(&low), "{outputs:?}");
    assert!(both.idle(1).saturated);
}

#[test]
fn lockstep_the_whole_ring_is_reached() {
    let config = config(16, 4, &[(0, -16), (62, 32)]);
    let mut both = LockStep::new(&config);
    for sample in 0..300 {
        both.strobe(sample % 97);
        both.idle(8);
    }
}

#[test]
fn lockstep_a_swap_takes_effect_at_its_strobe() {
    let config = config(24, 16, &[(0, 32768), (3, 32768)]);
    let bypass = TapTable::bypass(16).unwrap();
    let mut both = LockStep::new(&config);
    both.step(&Inputs {
        start: true,
        x: 100,
        ..Inputs::default()
    });
    for inputs in load(&bypass, 2) {
        both.step(&inputs);
    }
    let waiting = both.idle(1);
    assert!(waiting.swap_pending && waiting.bank == 0 && !waiting.refused);
    both.strobe(500);
    assert_eq!(both.idle(pass_clocks(1)).y, 500);
    let after = both.idle(1);
    assert!(!after.swap_pending && after.bank == 2);
}

#[test]
fn lockstep_the_sizes_of_machine_files() {
    for word_bits in [8, 17, 32] {
        for ring in RING_ADDRESS_BITS {
            for index in TAP_INDEX_BITS {
                let machine = table(&mut Random(5), 16, 4, 9, 2);
                let config = ShaperConfig::new(word_bits, machine)
                    .and_then(|c| c.with_room_for((1 << ring) - 2, 1 << index))
                    .unwrap();
                let mut both = LockStep::new(&config);
                for inputs in Anything::new(&config, u64::from(word_bits * ring * index)).take(120) {
                    both.step(&inputs);
                }
            }
        }
    }
}

#[test]
fn lockstep_sizes_that_no_machine_file_gives() {
    for (word_bits, ring, index) in [(8, 6, 5), (17, 5, 4), (18, 13, 7), (20, 6, 2), (31, 9, 3)] {
        let machine = table(&mut Random(5), 12, 4, 9, 2);
        let config = ShaperConfig::of_sizes(word_bits, ring, index, machine).unwrap();
        let mut both = LockStep::new(&config);
        for inputs in Anything::new(&config, u64::from(word_bits * ring * index)).take(1500) {
            both.step(&inputs);
        }
    }
}

#[test]
fn lockstep_a_table_of_256_taps_and_the_longest_ring() {
    let machine = table(&mut Random(11), 14, 256, 16_382, 4);
    let config = ShaperConfig::new(32, machine).unwrap();
    let pass = pass_clocks(config.table().taps().len() as u32);
    let mut both = LockStep::new(&config);
    let mut random = Random(12);
    for _ in 0..20 {
        both.strobe(random.word() as i64);
        both.idle(pass + 2);
    }
}

impl LockStep {
    fn outputs_y(&self) -> i64 {
        self.model.outputs().y
    }
}
