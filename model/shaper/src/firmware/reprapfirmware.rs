//! RepRapFirmware, `M593 P"custom"`: up to five impulses for all axes together.
//!
//! ```text
//!                  up to 3.5                                       from 3.6
//! H   sums of the amplitudes, after each impulse but the last      amplitudes of the impulses but the last, which is 1 − Σ
//! T   seconds from each impulse to the next                        seconds from the first impulse to each of the others
//! ```
//!
//! Times are rounded to step clocks from 3.6 on. Without `T` the impulses are half damped periods of `F` and `S` apart in both. From 3.6 on a `T` of one
//! number is taken for four, which fits no `H` but one of four: two impulses need `F` and `S` in its place.

/// Largest number of impulses.
pub const MOST_IMPULSES: usize = 5;
/// Clocks per second in which the firmware counts times.
pub const STEP_CLOCK_HZ: f64 = 750_000.0;
/// Frequencies that `F` takes, in Hz: a period of two times 65,535 step clocks, and the firmware's limit.
pub const FREQUENCY_HZ: [f64; 2] = [STEP_CLOCK_HZ / (2.0 * 65_535.0), 1000.0];

/// Meaning of `H` and `T` in a version.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Up to 3.5: sums and intervals.
    Sums,
    /// From 3.6: amplitudes and delays.
    Amplitudes,
}

impl Form {
    /// The time that the firmware makes of one: from 3.6 on a whole number of step clocks.
    pub fn rounded_s(self, time_s: f64) -> f64 {
        match self {
            Form::Sums => time_s,
            Form::Amplitudes => (time_s * STEP_CLOCK_HZ).round() / STEP_CLOCK_HZ,
        }
    }

    /// The numbers after `H` and `T` for impulses at `times_s`, the first at 0.
    pub fn numbers(self, times_s: &[f64], amplitudes: &[f64]) -> [Vec<f64>; 2] {
        let but_last = &amplitudes[..amplitudes.len().saturating_sub(1)];
        match self {
            Form::Sums => {
                let sums = but_last.iter().scan(0.0, |sum, amplitude| {
                    *sum += amplitude;
                    Some(*sum)
                });
                let between = times_s.windows(2).map(|pair| pair[1] - pair[0]);
                [sums.collect(), between.collect()]
            }
            Form::Amplitudes => [but_last.to_vec(), times_s.iter().skip(1).copied().collect()],
        }
    }
}
