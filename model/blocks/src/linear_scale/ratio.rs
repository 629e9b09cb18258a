//! The ratio of two counters as the hardware represents it: an 18-bit mantissa and a right shift.

/// Width of the mantissa in bits.
pub const MANTISSA_BITS: u32 = 18;
/// Width of the shift in bits.
pub const SHIFT_BITS: u32 = 5;
/// Largest shift.
const SHIFT_MAX: u32 = (1 << SHIFT_BITS) - 1;
/// Largest mantissa.
const MANTISSA_MAX: f64 = 131_071.0;
/// Relative error above which a ratio is refused.
pub const RELATIVE_ERROR_MAX: f64 = 1.0 / 131_072.0;

/// Counts of one counter per count of another: `mantissa · 2^−shift`.
///
/// ```
/// use posicast_blocks::linear_scale::ScaleRatio;
///
/// // 4000 counts of the motor and 1000 of the scale per unit: a scale count is four motor counts, exactly.
/// let ratio = ScaleRatio::new(4000.0, 1000.0)?;
/// assert_eq!((ratio.value(), ratio.relative_error()), (0.25, 0.0));
/// assert_eq!(ScaleRatio::for_monitor(4000.0, 1000.0)?.value(), 4.0);
/// # Ok::<(), posicast_blocks::linear_scale::ScaleRatioError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleRatio {
    mantissa: i32,
    shift: u32,
    relative_error: f64,
}

/// Why the ratio of two counters cannot be represented.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ScaleRatioError {
    /// The counts per unit are 0 or not a number.
    #[error(
        "{found} counts per unit of the {counter}: give a number other than 0; it is negative where that counter counts backward"
    )]
    Counts {
        /// Name of the counter: `motor` or `scale`.
        counter: &'static str,
        /// Value that was given.
        found: f64,
    },
    /// The ratio is outside the range of the hardware.
    #[error(
        "{motor} counts per unit of the motor and {scale} of the scale: the ratio is {found}; the hardware has 2^-15 to 131071 \
         in size; choose another resolution of one of them"
    )]
    Range {
        /// Counts of the motor per unit.
        motor: f64,
        /// Counts of the scale per unit.
        scale: f64,
        /// The ratio that is needed.
        found: f64,
    },
}

impl ScaleRatio {
    /// Scale counts per motor count, for a position loop on the scale: it converts the motor's counts to the scale's.
    ///
    /// A counter that counts backward has negative counts per unit.
    ///
    /// # Errors
    /// [`ScaleRatioError`] unless both are finite and not 0, and the magnitude of the ratio is 2^−15 to 131,071. The
    /// relative error is then at most 2^−17.
    pub fn new(motor_counts_per_unit: f64, scale_counts_per_unit: f64) -> Result<Self, ScaleRatioError> {
        let (motor, scale) = (motor_counts_per_unit, scale_counts_per_unit);
        Self::of(motor, scale, scale / motor)
    }

    /// Motor counts per scale count, for a scale that is only compared: it converts the scale's counts to the
    /// motor's.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn for_monitor(motor_counts_per_unit: f64, scale_counts_per_unit: f64) -> Result<Self, ScaleRatioError> {
        let (motor, scale) = (motor_counts_per_unit, scale_counts_per_unit);
        Self::of(motor, scale, motor / scale)
    }

    fn of(motor: f64, scale: f64, ratio: f64) -> Result<Self, ScaleRatioError> {
        for (counter, found) in [("motor", motor), ("scale", scale)] {
            if !found.is_finite() || found == 0.0 {
                return Err(ScaleRatioError::Counts { counter, found });
            }
        }
        // The largest shift that fits keeps the most bits.
        let fitting = (0..=SHIFT_MAX).rev().find_map(|shift| {
            let mantissa = (ratio * f64::from(1u32 << shift)).round();
            (mantissa.abs() <= MANTISSA_MAX).then_some((mantissa, shift))
        });
        let range = ScaleRatioError::Range {
            motor,
            scale,
            found: ratio,
        };
        let (mantissa, shift) = fitting.ok_or(range)?;
        let relative_error = ((mantissa / f64::from(1u32 << shift)) / ratio - 1.0).abs();
        // The error is NaN where the ratio itself is 0 or not a number.
        if relative_error.is_nan() || relative_error > RELATIVE_ERROR_MAX {
            return Err(range);
        }
        Ok(Self {
            mantissa: mantissa as i32,
            shift,
            relative_error,
        })
    }

    /// Value for `ratio_mantissa`.
    pub fn mantissa(&self) -> i32 {
        self.mantissa
    }

    /// Value for `ratio_shift`.
    pub fn shift(&self) -> u32 {
        self.shift
    }

    /// The ratio that the hardware uses.
    pub fn value(&self) -> f64 {
        f64::from(self.mantissa) / f64::from(1u32 << self.shift)
    }

    /// Relative error by rounding the mantissa: 0 to 2^−17. Multiplied by the travel in counts, it is the deviation
    /// that an ideal machine would show.
    pub fn relative_error(&self) -> f64 {
        self.relative_error
    }

    /// Converts a number of counts: an exact product, rounded half up once.
    pub fn apply(&self, counts: i32) -> i64 {
        scaled(counts, self.mantissa, self.shift)
    }
}

/// `counts · mantissa · 2^−shift`, rounded half up; 50 bits at most.
pub(super) fn scaled(counts: i32, mantissa: i32, shift: u32) -> i64 {
    let product = i64::from(counts) * i64::from(mantissa);
    (product + (1i64 << shift >> 1)) >> shift
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_mantissa_is_taken() {
        let third = ScaleRatio::new(3.0, 1.0).unwrap();
        assert_eq!((third.mantissa(), third.shift()), (87381, 18));
        assert!(third.relative_error() < 4e-6);
        let backward = ScaleRatio::new(4096.0, -10_000.0).unwrap();
        assert_eq!(backward.value(), -10_000.0 / 4096.0);
    }

    #[test]
    fn the_ends_of_the_ratio() {
        assert_eq!(ScaleRatio::new(1.0, 131_071.0).unwrap().shift(), 0);
        assert_eq!(ScaleRatio::new(32_768.0, 1.0).unwrap().mantissa(), 65_536);
        for (motor, scale) in [
            (1.0, 131_072.0),
            (1.0, 1e300),
            (1e300, 1e-300),
            (1e9, 1.0),
            (1e-300, 1e300),
        ] {
            let error = ScaleRatio::new(motor, scale).unwrap_err();
            assert!(matches!(error, ScaleRatioError::Range { .. }), "{error}");
        }
    }

    #[test]
    fn counts_of_zero_or_not_finite_are_errors() {
        for found in [0.0, f64::NAN, f64::INFINITY] {
            let error = ScaleRatio::for_monitor(1.0, found).unwrap_err().to_string();
            assert!(
                error.contains("of the scale") && error.contains("other than 0"),
                "{error}"
            );
            assert!(
                ScaleRatio::new(found, 1.0)
                    .unwrap_err()
                    .to_string()
                    .contains("of the motor")
            );
        }
    }

    #[test]
    fn rounding_is_half_up_on_both_sides() {
        let rounded = [-3, -1, 1, 3].map(|counts| scaled(counts, 1, 1));
        assert_eq!(rounded, [-1, 0, 1, 2]);
        assert_eq!(scaled(i32::MIN, -131_072, 0), 1 << 48);
        assert_eq!(scaled(i32::MIN, 131_071, 31), -131_071);
    }
}
