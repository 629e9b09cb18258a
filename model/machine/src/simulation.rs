//! Simulates a command on its way through the shaper to the machine, sample by sample.
//!
//! ```text
//! words x ─┬─► shaper (bit exact) ─► y ───────► plant ─► position
//!          ├─► real taps (float design) ─► y_float        |y − y_float| ≤ bound
//!          └─────────────────────────────────► plant ─► position without shaping
//! ```
//!
//! All words and positions are in LSB of the command word. The command starts at rest at its first value. Those of a
//! modulo axis include its whole turns here; the hardware has only the lowest bits of each
//! ([`AxisSimulation::float_words`]).

use crate::plan::AxisTables;
use crate::plant::{Plant, SampledPlant};
use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::cascade::SampleCascade;
use posicast_blocks::shaper::{CHANNELS_MAX, MotionShaper, SampleShaper, ShaperConfig, wrap};

/// Result of a command on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSimulation {
    /// Shaped words as the hardware computes them; for a modulo axis with the whole turns that its word leaves out.
    pub shaped: Vec<i64>,
    /// Shaped words of the float design, clamped to the word as the hardware's are; for a modulo axis with whole
    /// turns.
    pub float: Vec<f64>,
    /// Position of the machine that follows the shaped words, at the end of each sample.
    pub position: Vec<f64>,
    /// Position of the machine that follows the command itself.
    pub position_unshaped: Vec<f64>,
    /// Amplitude with which the machine rings once the shaped words stand still.
    pub vibration: f64,
    /// Amplitude with which the machine rings after the unshaped command.
    pub vibration_unshaped: f64,
    /// Largest difference allowed between the hardware and the float design, in LSB.
    pub bound_lsb: f64,
}

impl AxisSimulation {
    /// Largest difference between the hardware and the float design, in LSB.
    pub fn largest_difference_lsb(&self) -> f64 {
        largest_difference(&self.shaped, &self.float)
    }

    /// The float design without the whole turns that words of `word_bits` bits leave out, to show it beside the
    /// hardware's words. It may then lie a fraction beyond the word.
    pub fn float_words(&self, word_bits: u32) -> Vec<f64> {
        let shown = |(float, shaped): (&f64, &i64)| float - (shaped - wrap(*shaped, word_bits)) as f64;
        self.float.iter().zip(&self.shaped).map(shown).collect()
    }
}

/// Largest difference between integer and float words of the same samples.
pub fn largest_difference(words: &[i64], float: &[f64]) -> f64 {
    let differences = words.iter().zip(float).map(|(y, f)| (*y as f64 - f).abs());
    differences.fold(0.0, f64::max)
}

/// Runs `words` through the shaper that `config` describes, its float design `tables`, and `plant`.
pub fn simulate_axis(
    config: &AxisShaperConfig,
    tables: &AxisTables,
    plant: &Plant,
    sample_period_s: f64,
    words: &[i64],
) -> AxisSimulation {
    let start = words.first().copied().unwrap_or(0);
    let float = tables.digitised.shape(words);
    let (shaped, float) = match config {
        AxisShaperConfig::Taps(config) if config.motion().is_some_and(|motion| motion.modulo) => {
            (turned(config, words, &float), float)
        }
        AxisShaperConfig::Taps(config) => {
            let mut shaper = SampleShaper::new(config);
            shaper.start(start);
            let shaped = words.iter().map(|x| shaper.push(*x)).collect();
            let (least, most) = (config.word_min() as f64, config.word_max() as f64);
            (shaped, float.into_iter().map(|y| y.clamp(least, most)).collect())
        }
        AxisShaperConfig::Cascade(config) => {
            let mut cascade = SampleCascade::new(config);
            cascade.start(start);
            (words.iter().map(|x| cascade.push(*x)).collect(), float)
        }
    };
    let follow = |words: &[i64]| follow(plant, sample_period_s, start, words);
    let (position, vibration) = follow(&shaped);
    let (position_unshaped, vibration_unshaped) = follow(words);
    AxisSimulation {
        shaped,
        float,
        position,
        position_unshaped,
        vibration,
        vibration_unshaped,
        bound_lsb: tables.output_bound_lsb(words),
    }
}

/// The words of a modulo axis's shaper, each with as many whole turns as bring it nearest to the float design's.
fn turned(config: &ShaperConfig, words: &[i64], float: &[f64]) -> Vec<i64> {
    let channels = |x: i64| {
        let mut channels = [0; CHANNELS_MAX];
        channels[0] = x;
        channels
    };
    let mut shaper = MotionShaper::new(config);
    shaper.start(channels(words.first().copied().unwrap_or(0)));
    let word = |(x, float): (&i64, &f64)| {
        let (y, near) = (shaper.push(channels(*x))[0], float.round() as i64);
        near + wrap(y - near, config.word_bits())
    };
    words.iter().zip(float).map(word).collect()
}

/// Positions of the machine that follows `words`, and the amplitude with which it rings after their last change.
fn follow(plant: &Plant, sample_period_s: f64, start: i64, words: &[i64]) -> (Vec<f64>, f64) {
    let mut machine = SampledPlant::new(plant, sample_period_s, start as f64);
    let mut vibration = 0.0;
    let mut last = start;
    let positions = words.iter().map(|word| {
        let position = machine.step(*word as f64);
        if *word != last {
            vibration = machine.vibration();
            last = *word;
        }
        position
    });
    let positions = positions.collect();
    (positions, vibration)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine_file;
    use crate::plan::design_machine;
    use posicast_blocks::shaper::ShaperMotion;

    const MACHINE: &str = r#"
        name = "one"
        clock = { frequency_hz = 50_000_000, sample_hz = 10_000 }
        [[axis]]
        name = "x"
        counts_per_unit = 1_000_000
        shaper = { kind = "zvd" }
        mode = [{ frequency_hz = 131.117015808451, damping = 0.157799065776 }]
    "#;

    fn simulate(words: &[i64]) -> AxisSimulation {
        let machine = machine_file::parse("one.toml", MACHINE).unwrap();
        let design = design_machine(&machine).unwrap();
        let config = AxisShaperConfig::Taps(ShaperConfig::new(32, design.axes[0].table.clone()).unwrap());
        let plant = Plant::of_axis(&machine.axes[0]).unwrap();
        simulate_axis(&config, &design.axes[0], &plant, 1e-4, words)
    }

    #[test]
    fn a_shaped_step_leaves_no_more_than_the_quantised_residual() {
        let step: Vec<i64> = std::iter::once(1000)
            .chain(std::iter::repeat_n(1_001_000, 400))
            .collect();
        let run = simulate(&step);
        assert_eq!(run.shaped.last(), Some(&1_001_000));
        assert!(run.vibration < 1e-4 * 1e6, "{}", run.vibration);
        assert!(run.vibration_unshaped > 0.8 * 1e6, "{}", run.vibration_unshaped);
        assert!(run.largest_difference_lsb() <= run.bound_lsb);
    }

    #[test]
    fn a_modulo_axis_turns_on_where_its_word_wraps() {
        let machine = machine_file::parse(
            "one.toml",
            &MACHINE.replace("1_000_000\n", "1_000_000\nmodulo = true\n"),
        )
        .unwrap();
        let design = design_machine(&machine).unwrap();
        let plain = ShaperConfig::new(24, design.axes[0].table.clone()).unwrap();
        let modulo = ShaperMotion {
            channels: 1,
            modulo: true,
        };
        let config = AxisShaperConfig::Taps(plain.for_motion(modulo).unwrap());
        let plant = Plant::of_axis(&machine.axes[0]).unwrap();
        // Two and a half turns of the word in one direction and a bit back, at 0.002 turns per sample at most.
        let turn = f64::from(24).exp2();
        let words: Vec<i64> = (0..5000)
            .map(|n| (turn * (2.5 - 2.5 * (f64::from(n.min(4000)) * 0.0008).cos())) as i64)
            .collect();
        let run = simulate_axis(&config, &design.axes[0], &plant, 1e-4, &words);
        assert_eq!(run.shaped.last(), words.last());
        assert!(run.shaped.last().unwrap() > &(4 << 24));
        assert!(
            run.largest_difference_lsb() <= run.bound_lsb,
            "{}",
            run.largest_difference_lsb()
        );
        let wrapped: Vec<i64> = run.shaped.iter().map(|y| wrap(*y, 24)).collect();
        assert!(largest_difference(&wrapped, &run.float_words(24)) <= run.bound_lsb);
        assert!(wrapped.iter().all(|y| y.abs() <= 1 << 23));
    }

    #[test]
    fn a_command_at_rest_stays_at_rest() {
        let run = simulate(&[-77; 50]);
        assert!(run.shaped.iter().all(|y| *y == -77));
        assert!(run.position.iter().all(|p| *p == -77.0));
        assert_eq!((run.vibration, run.vibration_unshaped), (0.0, 0.0));
    }
}
