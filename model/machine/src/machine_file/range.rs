//! Ranges of numbers, as data: one value serves the check, the message and the help text.

use std::fmt;

/// Relative rounding of a decimal such as `6.5535`.
const ROUNDING: f64 = 1e-12;

/// An interval of finite numbers with its unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct NumberRange {
    low: f64,
    low_included: bool,
    high: f64,
    high_included: bool,
    unit: &'static str,
    reason: &'static str,
}

impl NumberRange {
    /// From `low` to `high`, both allowed.
    pub(super) const fn closed(low: f64, high: f64) -> Self {
        Self {
            low,
            low_included: true,
            high,
            high_included: true,
            unit: "",
            reason: "",
        }
    }

    /// From 0 to `high`; `high` is allowed, 0 is not.
    pub(super) const fn positive(high: f64) -> Self {
        Self {
            low_included: false,
            ..Self::closed(0.0, high)
        }
    }

    /// The range without its upper end.
    pub(super) const fn open_above(self) -> Self {
        Self {
            high_included: false,
            ..self
        }
    }

    /// The range in a unit that is smaller by `factor`.
    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            low: self.low * factor,
            high: self.high * factor,
            ..self
        }
    }

    /// Widens the range so that it holds its numbers in any unit of an axis, from a millionth of a unit to a million
    /// units.
    pub(super) fn in_any_unit(self) -> Self {
        let wider = self.times(1e6);
        let low = if self.low > 0.0 { self.low * 1e-6 } else { wider.low };
        Self { low, ..wider }
    }

    /// Lowers the upper end to `high`, rounded down to six digits; `reason` explains it in messages.
    pub(super) fn at_most(self, high: f64, reason: &'static str) -> Self {
        let digits = 10f64.powf(5.0 - high.log10().floor());
        let high = (high * digits * (1.0 + ROUNDING)).floor() / digits;
        if high < self.high {
            Self { high, reason, ..self }
        } else {
            self
        }
    }

    /// The range with a unit for messages.
    pub(super) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Whether its upper end is lower than that of the quantity itself, by [`NumberRange::at_most`].
    pub(super) const fn is_shortened(&self) -> bool {
        !self.reason.is_empty()
    }

    /// The name of its unit; empty where it has none.
    pub(super) const fn unit_name(&self) -> &'static str {
        self.unit
    }

    /// The lower end, and whether it is allowed.
    pub(super) const fn low(&self) -> (f64, bool) {
        (self.low, self.low_included)
    }

    /// The upper end, and whether it is allowed.
    pub(super) const fn high(&self) -> (f64, bool) {
        (self.high, self.high_included)
    }

    /// Whether the number lies inside; NaN and the infinities never do.
    pub(super) fn contains(&self, value: f64) -> bool {
        let above = if self.low_included {
            value >= self.low
        } else {
            value > self.low
        };
        let below = if self.high_included {
            value <= self.high
        } else {
            value < self.high
        };
        value.is_finite() && above && below
    }
}

impl fmt::Display for NumberRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low = if self.low_included { "at least" } else { "above" };
        let high = if self.high_included { "at most" } else { "below" };
        write!(f, "{low} {}, {high} {}", end(self.low), end(self.high))?;
        for (mark, words) in [(" ", self.unit), (", ", self.reason)] {
            if !words.is_empty() {
                write!(f, "{mark}{words}")?;
            }
        }
        Ok(())
    }
}

/// Writes an end of a range, `1e9` for example without its ten digits.
fn end(value: f64) -> String {
    let (plain, power) = (value.to_string(), format!("{value:e}"));
    if plain.len() > 7 && power.len() < plain.len() {
        power
    } else {
        plain
    }
}

/// Range of counts per m or rad: up to one count per picometre.
pub(super) const COUNTS_PER_UNIT: NumberRange = NumberRange::positive(1e12);
/// Largest relative distance from a whole number that the decimals of a frequency may leave.
pub(super) const RATIO_ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_belong_to_the_range_as_its_text_says() {
        let damping = NumberRange::closed(0.0, 1.0).open_above();
        assert_eq!(damping.to_string(), "at least 0, below 1");
        assert!(damping.contains(0.0) && !damping.contains(1.0));
        let frequency = NumberRange::positive(10.0).unit("Hz");
        assert_eq!(frequency.to_string(), "above 0, at most 10 Hz");
        assert!(!frequency.contains(0.0) && frequency.contains(10.0));
        assert!(!frequency.contains(f64::NAN) && !frequency.contains(f64::INFINITY));
        let time = NumberRange::closed(0.0, 60.0).unit("s");
        let ticks = |sample_hz: f64| time.at_most(65_535.0 / sample_hz, "65,535 ticks");
        assert_eq!(ticks(10e3).to_string(), "at least 0, at most 6.5535 s, 65,535 ticks");
        assert_eq!(ticks(7e3).to_string(), "at least 0, at most 9.36214 s, 65,535 ticks");
        assert_eq!(ticks(100.0).to_string(), "at least 0, at most 60 s");
        assert_eq!(
            frequency.times(1e3).unit("mHz").to_string(),
            "above 0, at most 10000 mHz"
        );
    }
}
