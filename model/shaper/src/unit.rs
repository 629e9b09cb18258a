//! Writes figures for people: in the largest unit that leaves a number before the point.

/// Figures smaller than this fraction of the smallest unit are written as powers of ten.
pub const LEAST: f64 = 1e-3;

/// A unit for figures: its symbol, and its number per SI unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShownUnit {
    symbol: &'static str,
    per_si: f64,
}

const TIMES: [ShownUnit; 4] = [
    ShownUnit::new("ns", 1e9),
    ShownUnit::new("µs", 1e6),
    ShownUnit::new("ms", 1e3),
    ShownUnit::new("s", 1.0),
];

impl ShownUnit {
    /// A unit with this symbol; `per_si` of it make one SI unit.
    pub const fn new(symbol: &'static str, per_si: f64) -> Self {
        Self { symbol, per_si }
    }

    /// Symbol of the unit.
    pub fn symbol(self) -> &'static str {
        self.symbol
    }

    /// Converts a figure in m or rad to this unit.
    pub fn of(self, figure: f64) -> f64 {
        figure * self.per_si
    }

    /// Writes a figure in m or rad with `digits` significant digits and the unit.
    pub fn show(self, figure: f64, digits: usize) -> String {
        format!(
            "{}{}{}",
            significant(self.of(figure), digits),
            self.space(),
            self.symbol
        )
    }

    /// Space between a number and the symbol.
    pub fn space(self) -> &'static str {
        space(self.symbol)
    }
}

/// The unit that shows a time of this size with a number before the point; seconds for a time of 0.
pub fn time_unit(time_s: f64) -> ShownUnit {
    let fits = |unit: &&ShownUnit| (time_s * unit.per_si).abs() >= 1.0;
    let largest_that_fits = TIMES.iter().rev().find(fits);
    *largest_that_fits.unwrap_or(&TIMES[if time_s == 0.0 { 3 } else { 0 }])
}

/// Writes a time with `digits` significant digits, for example `152 µs`, `1.35 ms`, `30.0 s`.
pub fn show_seconds(time_s: f64, digits: usize) -> String {
    time_unit(time_s).show(time_s, digits)
}

/// Writes a number for a message: a whole one as it is, any other with at most six significant digits.
pub fn short(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        value.to_string()
    } else {
        trimmed(value, 6)
    }
}

/// Space between number and symbol: none before the degree sign.
pub fn space(symbol: &str) -> &'static str {
    match symbol {
        "°" => "",
        _ => " ",
    }
}

/// Writes a number with this many significant digits, but with all of those before the point.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    if value.abs() < LEAST {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    // The value is rounded first, because 9.996 gains a digit before the point.
    let rounded: f64 = format!("{value:.*e}", digits.saturating_sub(1))
        .parse()
        .unwrap_or(value);
    let before_the_point = rounded.abs().log10().floor() as i32 + 1;
    let after = usize::try_from(digits as i32 - before_the_point).unwrap_or(0);
    format!("{value:.after$}")
}

/// Writes a number with at most this many significant digits, without zeros at its end.
pub fn trimmed(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits.saturating_sub(1))
        .parse()
        .unwrap_or(value);
    match rounded.abs() {
        size if size != 0.0 && !(LEAST / 1e3..1e12).contains(&size) => format!("{rounded:e}"),
        _ => rounded.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_shown_in_the_unit_of_their_size() {
        for (time_s, text) in [
            (152.4e-6, "152 µs"),
            (1.354e-3, "1.35 ms"),
            (30.0, "30.0 s"),
            (107e-9, "107 ns"),
            (0.0, "0 s"),
        ] {
            assert_eq!(show_seconds(time_s, 3), text);
        }
    }

    #[test]
    fn a_number_has_the_digits_that_it_deserves() {
        let texts = [0.18, 131.117, 1234.5, -0.004_567, 10.0, 0.0].map(|value| trimmed(value, 3));
        assert_eq!(texts, ["0.18", "131", "1230", "-0.00457", "10", "0"]);
    }

    #[test]
    fn numbers_of_messages_are_short_and_grammatical() {
        for (value, text) in [
            (131.117_015_808_451, "131.117"),
            (50e6, "50000000"),
            (1_234.567_89, "1234.57"),
            (0.000_012_5, "0.0000125"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
