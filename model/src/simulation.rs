//! A command on its way through the shaper to the simulated machine, sample by sample.
//!
//! ```text
//! words x ─┬─► SampleShaper (bit exact) ─► y ─► plant ─► position
//!          ├─► real taps (float design) ─► y_float        |y − y_float| ≤ bound
//!          └─────────────────────────────────► plant ─► position without shaping
//! ```
//!
//! All words and positions are in LSB of the command word. The command starts at rest at its first value.

use crate::design::AxisTables;
use crate::plant::{Plant, SampledPlant};
use crate::rtl::shaper::{SampleShaper, ShaperConfig};

/// What became of a command on one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSimulation {
    /// Shaped words, as the hardware computes them.
    pub shaped: Vec<i32>,
    /// Shaped words of the float design, clamped to the word as the hardware's are.
    pub float: Vec<f64>,
    /// Position of the machine that follows the shaped words, at the end of each sample.
    pub position: Vec<f64>,
    /// Position of the machine that follows the command itself.
    pub position_unshaped: Vec<f64>,
    /// Amplitude with which the machine rings once the shaped words stand still.
    pub vibration: f64,
    /// The same without shaping.
    pub vibration_unshaped: f64,
    /// How far the hardware may differ from the float design.
    pub bound_lsb: f64,
}

impl AxisSimulation {
    /// Largest difference of hardware and float design.
    pub fn largest_difference_lsb(&self) -> f64 {
        largest_difference(&self.shaped, &self.float)
    }
}

/// Largest difference of integer and float words of the same samples.
pub fn largest_difference(words: &[i32], float: &[f64]) -> f64 {
    words
        .iter()
        .zip(float)
        .map(|(y, f)| (f64::from(*y) - f).abs())
        .fold(0.0, f64::max)
}

/// Runs `words` through the shaper that `config` describes, its float design `tables`, and `plant`.
pub fn simulate_axis(
    config: &ShaperConfig,
    tables: &AxisTables,
    plant: &Plant,
    sample_period_s: f64,
    words: &[i32],
) -> AxisSimulation {
    let start = words.first().copied().unwrap_or(0);
    let mut shaper = SampleShaper::new(config);
    shaper.start(i64::from(start));
    // A word has at most 32 bits, so what the shaper gives fits.
    let shaped: Vec<i32> = words.iter().map(|x| shaper.push(i64::from(*x)) as i32).collect();
    let (least, most) = (config.word_min() as f64, config.word_max() as f64);
    let float = tables.digitised.shape(words);
    let follow = |words: &[i32]| follow(plant, sample_period_s, start, words);
    let (position, vibration) = follow(&shaped);
    let (position_unshaped, vibration_unshaped) = follow(words);
    AxisSimulation {
        shaped,
        float: float.into_iter().map(|y| y.clamp(least, most)).collect(),
        position,
        position_unshaped,
        vibration,
        vibration_unshaped,
        bound_lsb: tables.output_bound_lsb(words),
    }
}

/// Positions of the machine that follows `words`, and the amplitude with which it rings after the last change of them.
fn follow(plant: &Plant, sample_period_s: f64, start: i32, words: &[i32]) -> (Vec<f64>, f64) {
    let mut machine = SampledPlant::new(plant, sample_period_s, f64::from(start));
    let mut vibration = 0.0;
    let mut last = start;
    let positions = words.iter().map(|word| {
        let position = machine.step(f64::from(*word));
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
    use crate::design::design_machine;
    use crate::spec;

    const MACHINE: &str = r#"
        name = "one"
        clock = { frequency_hz = 50_000_000, sample_hz = 10_000 }
        [[axis]]
        name = "x"
        counts_per_unit = 1_000_000
        shaper = { kind = "zvd" }
        mode = [{ frequency_hz = 131.117015808451, damping = 0.157799065776 }]
    "#;

    fn simulate(words: &[i32]) -> AxisSimulation {
        let machine = spec::parse("one.toml", MACHINE).unwrap();
        let design = design_machine(&machine).unwrap();
        let config = ShaperConfig::new(32, design.axes[0].table.clone()).unwrap();
        let plant = Plant::of_axis(&machine.axes[0]).unwrap();
        simulate_axis(&config, &design.axes[0], &plant, 1e-4, words)
    }

    #[test]
    fn a_shaped_step_leaves_no_more_than_the_quantised_residual() {
        let step: Vec<i32> = std::iter::once(1000)
            .chain(std::iter::repeat_n(1_001_000, 400))
            .collect();
        let run = simulate(&step);
        assert_eq!(run.shaped.last(), Some(&1_001_000));
        assert!(run.vibration < 1e-4 * 1e6, "{}", run.vibration);
        assert!(run.vibration_unshaped > 0.8 * 1e6, "{}", run.vibration_unshaped);
        assert!(run.largest_difference_lsb() <= run.bound_lsb);
    }

    #[test]
    fn a_command_at_rest_stays_at_rest() {
        let run = simulate(&[-77; 50]);
        assert!(run.shaped.iter().all(|y| *y == -77));
        assert!(run.position.iter().all(|p| *p == -77.0));
        assert_eq!((run.vibration, run.vibration_unshaped), (0.0, 0.0));
    }
}
