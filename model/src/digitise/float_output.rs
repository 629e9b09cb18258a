//! What the float design makes of command words, and how far the integers may differ from it.
//!
//! ```text
//! y[n] = Σ a_i · x[n − d_i]          a_i: the real taps, before rounding to integers
//! |y_hardware − y| ≤ (max x − min x) · Σ |c_i/2^F − a_i| + ½ LSB        saturation excluded
//! ```
//!
//! The bound holds because both sets of coefficients sum to one: only the *range* of the command is weighed by the
//! coefficients' errors, not its size. It is design.md's contract for comparing hardware with the float design.

use super::{Digitised, RealTap};

impl Digitised {
    /// The shaped words in real arithmetic, in LSB. Before its first sample the command stood at its first value.
    pub fn float_output(&self, words: &[i32]) -> Vec<f64> {
        let start = words.first().copied().unwrap_or(0);
        let sample = |n: usize, tap: &RealTap| {
            let index = n.checked_sub(tap.delay_samples as usize);
            f64::from(index.map_or(start, |i| words[i])) - f64::from(start)
        };
        let moved = |n: usize| self.taps.iter().map(|tap| tap.weight * sample(n, tap)).sum::<f64>();
        (0..words.len()).map(|n| f64::from(start) + moved(n)).collect()
    }
}

/// The bound above, in LSB, for a command of these words and `quantising_error` = `Σ |c_i/2^F − a_i|`.
pub fn float_bound_lsb(words: &[i32], quantising_error: f64) -> f64 {
    let least = words.iter().min().copied().map_or(0.0, f64::from);
    let most = words.iter().max().copied().map_or(0.0, f64::from);
    (most - least) * quantising_error + 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::digitise::Method;

    fn two_taps() -> Digitised {
        let taps = [(0, 0.25), (2, 0.75)].map(|(delay_samples, weight)| RealTap { delay_samples, weight });
        Digitised {
            method_used: Method::Linear,
            taps: taps.to_vec(),
        }
    }

    #[test]
    fn history_before_the_start_is_the_start() {
        assert_eq!(two_taps().float_output(&[8, 8, 12, 12, 12]), [8.0, 8.0, 9.0, 9.0, 12.0]);
    }

    #[test]
    fn words_at_the_ends_of_their_range_do_not_overflow() {
        let output = two_taps().float_output(&[i32::MIN, i32::MAX]);
        assert_eq!(output[1], f64::from(i32::MIN) + 0.25 * (f64::from(i32::MAX) - f64::from(i32::MIN)));
    }

    #[test]
    fn the_bound_weighs_the_range_of_the_command() {
        assert_eq!(float_bound_lsb(&[-10, 30], 0.1), 4.5);
        assert_eq!(float_bound_lsb(&[], 0.1), 0.5);
    }
}
