//! The settings that the controller reads while it computes: 16 words of 32 bits, one memory row per axis.

/// Number of words of the settings.
pub const SETTINGS: usize = 16;
/// Width of a gain's mantissa in bits.
pub const MANTISSA_BITS: u32 = 18;
/// Largest mantissa; the smallest is `-MANTISSA_MAX - 1`.
pub const MANTISSA_MAX: i32 = (1 << (MANTISSA_BITS - 1)) - 1;
/// Largest right shift.
pub const SHIFT_MAX: u32 = 31;
/// Largest command limit: Q19.12 in 31 bits.
pub const LIMIT_MAX: u32 = (1 << 31) - 1;

/// Settings by address. All but `Limit` are gains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SettingRow {
    /// Sliding mode: c·T in `s = c·e + de`.
    Surface = 0,
    /// Sliding mode: slope 1/φ of the boundary layer.
    Boundary = 1,
    /// Sliding mode: c·T, gain on `de`.
    Damping = 2,
    /// Sliding mode: k·T, gain on `s`.
    Reaching = 3,
    /// Sliding mode: ε·T², gain on the boundary layer's fraction.
    Switching = 4,
    /// Slope of the Coulomb term: 1 over the velocity at which it reaches its full value.
    Fade = 5,
    /// Command per feedback.
    Feedback = 6,
    /// Command per reference acceleration.
    Acceleration = 7,
    /// Command per reference velocity.
    Velocity = 8,
    /// Command per measured velocity.
    Viscous = 9,
    /// Command that compensates Coulomb friction.
    Coulomb = 10,
    /// Largest command: not a gain but Q19.12 in 31 bits.
    Limit = 11,
    /// Duty per command.
    Duty = 12,
    /// PD and PID: gain on `de`.
    Derivative = 13,
    /// PD and PID: gain on `e`.
    Proportional = 14,
    /// PID: gain on the integral of `e`.
    Integral = 15,
}

impl SettingRow {
    /// All rows, by address.
    pub const ALL: [Self; SETTINGS] = [
        Self::Surface,
        Self::Boundary,
        Self::Damping,
        Self::Reaching,
        Self::Switching,
        Self::Fade,
        Self::Feedback,
        Self::Acceleration,
        Self::Velocity,
        Self::Viscous,
        Self::Coulomb,
        Self::Limit,
        Self::Duty,
        Self::Derivative,
        Self::Proportional,
        Self::Integral,
    ];

    /// Exponent `x` of the row: a gain of this row stands for `mantissa · 2^(x − shift)`, in counts, ticks and
    /// command units.
    ///
    /// It is the difference between the fraction bits of the operand and those of the sum. The limit's is 0.
    pub const fn exponent(self) -> i32 {
        match self {
            Self::Surface | Self::Limit => 0,
            Self::Boundary | Self::Fade => -9,
            Self::Damping | Self::Reaching | Self::Derivative | Self::Proportional => -8,
            Self::Switching => 1,
            Self::Integral => -16,
            Self::Feedback | Self::Acceleration | Self::Duty => 12,
            Self::Velocity | Self::Viscous => 4,
            Self::Coulomb => 13,
        }
    }
}

impl SettingRow {
    /// The smallest gain of the row that is not 0; for [`SettingRow::Limit`] an LSB of the command.
    pub fn smallest(self) -> f64 {
        match self {
            Self::Limit => f64::exp2(-12.0),
            _ => f64::exp2(f64::from(self.exponent() - SHIFT_MAX as i32)),
        }
    }
}

/// A gain: signed mantissa and right shift.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Gain {
    mantissa: i32,
    shift: u32,
}

/// Why a number cannot be a gain of a row.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GainError {
    /// The gain exceeds the largest mantissa without shift.
    #[error("the gain {row:?} is {found:.3e}, but the largest in the hardware is {largest:.3e}")]
    Large {
        /// The gain.
        found: f64,
        /// Its row.
        row: SettingRow,
        /// Largest gain of the row.
        largest: f64,
    },
    /// The gain is infinite or not a number.
    #[error("the gain {row:?} is {found}, and must be a finite number")]
    NotFinite {
        /// The gain.
        found: f64,
        /// Its row.
        row: SettingRow,
    },
}

impl GainError {
    /// The row to which the error refers.
    pub fn row(&self) -> SettingRow {
        match *self {
            Self::Large { row, .. } | Self::NotFinite { row, .. } => row,
        }
    }
}

impl Gain {
    /// The gain of `row` nearest to `value`: the largest shift at which the mantissa fits its 18 bits.
    ///
    /// ```
    /// use posicast_blocks::sliding_mode::{Gain, SettingRow};
    ///
    /// let gain = Gain::nearest(13531.0172, SettingRow::Feedback)?;
    /// assert_eq!((gain.mantissa(), gain.shift()), (108248, 15)); // 108248 · 2^(12 − 15)
    /// assert_eq!(gain.value(SettingRow::Feedback), 13531.0);
    /// # Ok::<(), posicast_blocks::sliding_mode::GainError>(())
    /// ```
    ///
    /// # Errors
    /// [`GainError`] if it is too large for the row, or not finite.
    pub fn nearest(value: f64, row: SettingRow) -> Result<Self, GainError> {
        if !value.is_finite() {
            return Err(GainError::NotFinite { found: value, row });
        }
        let unshifted = value * f64::exp2(f64::from(-row.exponent()));
        let fits = |shift: &u32| (unshifted * f64::exp2(f64::from(*shift))).round().abs() <= f64::from(MANTISSA_MAX);
        let shift = (0..=SHIFT_MAX).rev().find(fits).ok_or(GainError::Large {
            found: value,
            row,
            largest: f64::from(MANTISSA_MAX) * f64::exp2(f64::from(row.exponent())),
        })?;
        Ok(Self {
            mantissa: (unshifted * f64::exp2(f64::from(shift))).round() as i32,
            shift,
        })
    }

    /// Mantissa, 18 bits, signed.
    pub fn mantissa(self) -> i32 {
        self.mantissa
    }

    /// Right shift, 0 to 31.
    pub fn shift(self) -> u32 {
        self.shift
    }

    /// The gain's value in `row`.
    pub fn value(self, row: SettingRow) -> f64 {
        f64::from(self.mantissa) * f64::exp2(f64::from(row.exponent() - self.shift as i32))
    }

    /// Packs the gain into a word of the settings: the mantissa in bits 17 to 0, the shift in bits 22 to 18.
    pub fn to_word(self) -> u32 {
        (self.mantissa as u32 & 0x3_ffff) | self.shift << MANTISSA_BITS
    }

    /// Unpacks a gain from a word of the settings; bits 31 to 23 are ignored.
    pub fn from_word(word: u32) -> Self {
        Self {
            mantissa: ((word << 14) as i32) >> 14,
            shift: word >> MANTISSA_BITS & SHIFT_MAX,
        }
    }
}

/// The words of one axis, by address.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Settings(pub [u32; SETTINGS]);

impl Settings {
    /// The word at an address; only its lowest four bits count.
    pub fn word(&self, address: usize) -> u32 {
        self.0[address % SETTINGS]
    }

    /// The gain of a row.
    pub fn gain(&self, row: SettingRow) -> Gain {
        Gain::from_word(self.0[row as usize])
    }

    /// Sets the gain of a row.
    pub fn set_gain(&mut self, row: SettingRow, gain: Gain) {
        self.0[row as usize] = gain.to_word();
    }

    /// The largest command in Q19.12.
    pub fn limit(&self) -> u32 {
        self.0[SettingRow::Limit as usize] & LIMIT_MAX
    }

    /// Sets the largest command in Q19.12; a value beyond 31 bits becomes the largest that fits.
    pub fn set_limit(&mut self, limit: u32) {
        self.0[SettingRow::Limit as usize] = limit.min(LIMIT_MAX);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_stands_at_its_address() {
        for (address, row) in SettingRow::ALL.into_iter().enumerate() {
            assert_eq!(row as usize, address);
        }
    }

    #[test]
    fn gains_survive_encoding() {
        for mantissa in [-131_072, -1, 0, 1, 131_071] {
            for shift in [0, 1, 30, 31] {
                let gain = Gain { mantissa, shift };
                assert_eq!(Gain::from_word(gain.to_word() | 0xff80_0000), gain);
            }
        }
    }

    #[test]
    fn the_nearest_gain_is_within_half_a_mantissa() {
        for value in [0.015, -0.005, 4.210_448, 1e-12, -3e-7, 0.0] {
            let gain = Gain::nearest(value, SettingRow::Surface).unwrap();
            let half = 0.5 * f64::exp2(-f64::from(gain.shift()));
            assert!(
                (gain.value(SettingRow::Surface) - value).abs() <= half,
                "{value}: {gain:?}"
            );
        }
        // It rounds up to a mantissa that no longer fits, so the shift is one less.
        let gain = Gain::nearest(131_071.6, SettingRow::Surface);
        assert!(matches!(gain, Err(GainError::Large { .. })), "{gain:?}");
        assert_eq!(Gain::nearest(131_071.4, SettingRow::Surface).unwrap().shift(), 0);
        assert_eq!(Gain::nearest(131_071.6 / 2.0, SettingRow::Surface).unwrap().shift(), 0);
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(
                Gain::nearest(value, SettingRow::Surface),
                Err(GainError::NotFinite { .. })
            ));
        }
        assert!(matches!(
            Gain::nearest(f64::MAX, SettingRow::Duty),
            Err(GainError::Large { .. })
        ));
    }
}
