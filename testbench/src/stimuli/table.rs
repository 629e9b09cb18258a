//! Random tap tables that the hardware must accept: the sum is `2^F`, and every coefficient fits into 18 bits and is
//! not zero.

use posicast_taps::{COEFFICIENT_MAX, COEFFICIENT_MIN};
use rand::{Rng, RngExt};

/// Taps in the order in which they are written. The memory is kept between loads, so that a load does not allocate.
#[derive(Debug, Clone, Default)]
pub(crate) struct Table {
    pub(crate) taps: Vec<(i32, u64)>,
}

impl Table {
    /// Creates an empty table with room for the longest table.
    pub(crate) fn with_capacity(taps: usize) -> Self {
        Self {
            taps: Vec::with_capacity(taps),
        }
    }

    /// Draws a new table of `count` taps with increasing delays below 2^`ring_address_bits` − 1, as far as these
    /// suffice.
    pub(crate) fn draw(&mut self, rng: &mut impl Rng, count: usize, fraction: u32, ring_address_bits: u32) {
        let one = 1 << fraction;
        let longest = (1u64 << ring_address_bits) - 2;
        let count = count.clamp(1, longest as usize);
        // Coefficients of about one make large swings, which reach saturation.
        let swing = *pick(rng, &[one / count as i32 + 1, one, COEFFICIENT_MAX]);
        let step = longest / count as u64;
        loop {
            self.taps.clear();
            let mut rest = one;
            for index in 0..count {
                let last = index + 1 == count;
                let coefficient = if last {
                    rest
                } else {
                    // The rest must stay within reach of the last tap.
                    let low = (rest - COEFFICIENT_MAX).max(-swing).max(COEFFICIENT_MIN);
                    let high = (rest - COEFFICIENT_MIN).min(swing).min(COEFFICIENT_MAX);
                    match rng.random_range(low..=high.max(low)) {
                        0 if rest > 0 => 1,
                        0 => -1,
                        coefficient => coefficient,
                    }
                };
                rest -= coefficient;
                let delay = index as u64 * step + rng.random_range(0..step.max(1));
                self.taps.push((coefficient, delay));
            }
            if self
                .taps
                .iter()
                .all(|(c, _)| *c != 0 && (COEFFICIENT_MIN..=COEFFICIENT_MAX).contains(c))
            {
                return;
            }
        }
    }
}

/// Returns one of the choices, all equally likely. `choices` must not be empty.
pub(crate) fn pick<'a, T>(rng: &mut impl Rng, choices: &'a [T]) -> &'a T {
    &choices[rng.random_range(0..choices.len())]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    use super::*;

    proptest! {
        #[test]
        fn prop_tables_sum_to_one_and_fit(seed: u64, count in 1usize..=256, fraction in 1u32..=16, ring in 6u32..=14) {
            let mut table = Table::default();
            table.draw(&mut Xoshiro256PlusPlus::seed_from_u64(seed), count, fraction, ring);
            prop_assert_eq!(table.taps.iter().map(|(c, _)| i64::from(*c)).sum::<i64>(), 1 << fraction);
            for pair in table.taps.windows(2) {
                prop_assert!(pair[0].1 < pair[1].1);
            }
            for (coefficient, delay) in &table.taps {
                prop_assert!(*coefficient != 0 && (COEFFICIENT_MIN..=COEFFICIENT_MAX).contains(coefficient));
                prop_assert!(*delay <= (1 << ring) - 2);
            }
        }
    }
}
