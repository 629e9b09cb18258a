//! Formats values for people: a number in its format, a wide word as a decimal number, a narrow one in hexadecimal.

use super::{Shown, View};

/// Words with at least this width are shown as numbers; narrower ones are codes and flags.
const NUMBER_BITS: usize = 16;
/// Width of the widest word that is shown as a number.
const MOST_NUMBER_BITS: usize = 64;
/// Largest number of fraction bits for which a number is written with all its decimals; with more fraction bits, it
/// gets as many decimals as distinguish two numbers.
const EXACT_FRACTION: u32 = 8;
/// Number of fraction bits above which a number is written as a power of ten.
const MOST_FRACTION: u32 = 40;

/// Returns a value in a few characters, with the bits read by `view`.
pub fn value(shown: &Shown, view: View) -> String {
    match shown {
        Shown::Bits(digits) => bits(digits, view),
        Shown::Real(real) => self::real(*real),
        Shown::Text(text) => format!("{text:?}"),
        Shown::Missing => "(none)".to_owned(),
    }
}

/// Like [`value`], followed by the hexadecimal digits if it is written as a number.
pub fn value_and_digits(shown: &Shown, view: View) -> String {
    let text = value(shown, view);
    match shown {
        Shown::Bits(digits) if digits.len() > 1 && !text.starts_with("0x") => {
            format!("{text} ({})", hexadecimal(digits))
        }
        _ => text,
    }
}

fn bits(digits: &str, view: View) -> String {
    let is_number = (NUMBER_BITS..=MOST_NUMBER_BITS).contains(&digits.len());
    let number = match view {
        View::Bits if digits.len() == 1 => return digits.to_owned(),
        View::Bits if is_number => number(digits, true, 0),
        View::Bits => None,
        View::Signed { fraction } => number(digits, true, fraction.into()),
        View::Unsigned { fraction } => number(digits, false, fraction.into()),
    };
    number.unwrap_or_else(|| hexadecimal(digits))
}

/// Converts binary digits to a number with this many bits after the point; `None` with unknown bits, and beyond 127
/// bits.
fn number(digits: &str, signed: bool, fraction: u32) -> Option<String> {
    if digits.len() > 127 {
        return None;
    }
    let raw = i128::from_str_radix(digits, 2).ok()?;
    let is_negative = signed && digits.starts_with('1');
    let whole = if is_negative { raw - (1 << digits.len()) } else { raw };
    if fraction == 0 {
        return Some(whole.to_string());
    }
    if fraction > MOST_FRACTION {
        return Some(real(whole as f64 * (-f64::from(fraction)).exp2()));
    }
    let decimals = if fraction <= EXACT_FRACTION {
        fraction
    } else {
        (f64::from(fraction) * std::f64::consts::LOG10_2).ceil() as u32 + 1
    };
    let (magnitude, power) = (whole.unsigned_abs(), 10u128.pow(decimals));
    let rounded = ((magnitude & ((1 << fraction) - 1)) * power + (1 << (fraction - 1))) >> fraction;
    let (above, below) = ((magnitude >> fraction) + rounded / power, rounded % power);
    let sign = if whole < 0 { "-" } else { "" };
    Some(format!("{sign}{above}.{below:0width$}", width = decimals as usize))
}

/// Converts binary digits to hexadecimal ones; `x` or `z` stands for four unknown bits, `X` if only some of them are
/// unknown.
fn hexadecimal(digits: &str) -> String {
    let bytes = digits.as_bytes();
    let groups = bytes.rchunks(4).rev().map(|group| {
        if let Some(digit) = std::str::from_utf8(group)
            .ok()
            .and_then(|d| u32::from_str_radix(d, 2).ok())
        {
            return char::from_digit(digit, 16).unwrap_or('X');
        }
        let all = |unknown: u8| group.iter().all(|digit| *digit == unknown);
        match (all(b'x'), all(b'z')) {
            (true, _) => 'x',
            (_, true) => 'z',
            _ => 'X',
        }
    });
    "0x".chars().chain(groups).collect()
}

fn real(real: f64) -> String {
    if real == 0.0 || (1e-4..1e15).contains(&real.abs()) || !real.is_finite() {
        format!("{real}")
    } else {
        format!("{real:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(digits: &str, view: &str) -> String {
        value_and_digits(&Shown::Bits(digits.to_owned()), View::parse(view).unwrap())
    }

    #[test]
    fn words_are_numbers_and_codes_are_hexadecimal() {
        assert_eq!(shown("1", "bits"), "1");
        assert_eq!(shown("101010", "bits"), "0x2a");
        assert_eq!(shown("1111111111111110", "bits"), "-2 (0xfffe)");
        assert_eq!(shown(&"1".repeat(65), "bits"), "0x1ffffffffffffffff");
        assert_eq!(shown("1111111111111110", "unsigned"), "65534 (0xfffe)");
        assert_eq!(shown("01xxxxzzzz", "bits"), "0x1xz");
        assert_eq!(shown("000000000000000x", "signed"), "0x000X");
    }

    #[test]
    fn a_view_shows_the_value_in_its_format() {
        assert_eq!(
            shown("00000000000100101010101101111011", "q23.8"),
            "4779.48046875 (0x0012ab7b)"
        );
        assert_eq!(
            shown("11111111111111111111111111111111", "q23.8"),
            "-0.00390625 (0xffffffff)"
        );
        assert_eq!(
            shown("11111111111111111111111111111111", "q15.16"),
            "-0.000015 (0xffffffff)"
        );
        assert_eq!(shown("01111111111111111111", "uq3.16"), "7.999985 (0x7ffff)");
        assert_eq!(shown("10", "q1"), "-1.0 (0x2)");
        assert_eq!(
            shown(&format!("{}1", "0".repeat(63)), "q60"),
            format!("{:e} (0x{}1)", (-60f64).exp2(), "0".repeat(15))
        );
    }

    #[test]
    fn long_reals_are_powers_of_ten() {
        let of = |number| value(&Shown::Real(number), View::Bits);
        assert_eq!(
            [of(-4.25), of(1e300), of(1e-300), of(0.0)],
            ["-4.25", "1e300", "1e-300", "0"]
        );
    }
}
