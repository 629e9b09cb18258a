//! The tap table: the integers with which the hardware computes.
//!
//! The table that the model uses is also the one in the Verilog's ROM, in the report and in every document:
//! `posicast_shaper::digitise` makes it once, and nothing downstream recomputes it.

/// Width of a coefficient in bits, two's complement: the width of an 18×18 multiplier.
pub const COEFFICIENT_BITS: u32 = 18;
/// Smallest coefficient.
pub const COEFFICIENT_MIN: i32 = -(1 << (COEFFICIENT_BITS - 1));
/// Largest coefficient.
pub const COEFFICIENT_MAX: i32 = (1 << (COEFFICIENT_BITS - 1)) - 1;
/// Largest number of fraction bits of a coefficient; with 17 a coefficient of one would not fit.
pub const COEFFICIENT_FRACTION_MAX: u32 = 16;

/// One tap, which contributes `coefficient · x[n − delay_samples]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Tap {
    /// Delay in samples.
    pub delay_samples: u32,
    /// Coefficient, which stands for `coefficient / 2^F`, within [`COEFFICIENT_MIN`]..=[`COEFFICIENT_MAX`]; never
    /// zero.
    pub coefficient: i32,
}

/// Taps in order of delay. Delays are distinct, coefficients are not zero, and their sum is exactly `2^F`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct TapTable {
    coefficient_fraction: u32,
    taps: Vec<Tap>,
}

/// Why a list of taps is not a tap table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TapTableError {
    /// `F` lies outside 1..=16.
    #[error("{0} fraction bits: a coefficient has 1 to {COEFFICIENT_FRACTION_MAX}")]
    Fraction(u32),
    /// A coefficient is zero, or 18 bits cannot hold it.
    #[error("coefficient {0} is not in {COEFFICIENT_MIN}..={COEFFICIENT_MAX} without 0")]
    Coefficient(i32),
    /// Delays do not strictly increase.
    #[error("delay {0} does not lie above the delay before it")]
    Order(u32),
    /// The coefficients do not sum to `2^F`.
    #[error("the coefficients sum to {sum}, not to 2^{fraction} = {}", 1i64 << fraction)]
    Sum {
        /// Sum of the coefficients.
        sum: i64,
        /// Fraction bits `F`.
        fraction: u32,
    },
}

impl TapTable {
    /// Takes taps that already form a valid table.
    ///
    /// # Errors
    /// [`TapTableError`] names the rule that a list breaks.
    pub fn new(coefficient_fraction: u32, taps: Vec<Tap>) -> Result<Self, TapTableError> {
        if !(1..=COEFFICIENT_FRACTION_MAX).contains(&coefficient_fraction) {
            return Err(TapTableError::Fraction(coefficient_fraction));
        }
        let legal = |c: i32| c != 0 && (COEFFICIENT_MIN..=COEFFICIENT_MAX).contains(&c);
        if let Some(tap) = taps.iter().find(|t| !legal(t.coefficient)) {
            return Err(TapTableError::Coefficient(tap.coefficient));
        }
        if let Some(pair) = taps.windows(2).find(|p| p[1].delay_samples <= p[0].delay_samples) {
            return Err(TapTableError::Order(pair[1].delay_samples));
        }
        let sum: i64 = taps.iter().map(|t| i64::from(t.coefficient)).sum();
        if sum != 1 << coefficient_fraction {
            return Err(TapTableError::Sum {
                sum,
                fraction: coefficient_fraction,
            });
        }
        Ok(Self {
            coefficient_fraction,
            taps,
        })
    }

    /// The one-tap table that passes the command through unchanged.
    pub fn bypass(coefficient_fraction: u32) -> Result<Self, TapTableError> {
        let unity = Tap {
            delay_samples: 0,
            coefficient: 1 << coefficient_fraction.min(COEFFICIENT_FRACTION_MAX),
        };
        Self::new(coefficient_fraction, vec![unity])
    }

    /// Fraction bits `F`: a coefficient `c` stands for `c / 2^F`.
    pub fn coefficient_fraction(&self) -> u32 {
        self.coefficient_fraction
    }

    /// The taps, in order of delay.
    pub fn taps(&self) -> &[Tap] {
        &self.taps
    }

    /// Mean delay `Σ c_i d_i / 2^F` in samples, by which a shaped ramp lags.
    pub fn mean_delay_samples(&self) -> f64 {
        let product = |tap: &Tap| i64::from(tap.coefficient) * i64::from(tap.delay_samples);
        let sum: i128 = self.taps.iter().map(|tap| i128::from(product(tap))).sum();
        sum as f64 / f64::from(1u32 << self.coefficient_fraction)
    }

    /// Longest delay in samples.
    pub fn longest_delay_samples(&self) -> u32 {
        self.taps.last().map_or(0, |t| t.delay_samples)
    }
}
