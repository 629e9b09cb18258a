//! Counts and times in sentences for people.

/// Returns a count with its noun: `1 signal`, `2 signals`, `0 matches`, `2 axes`.
pub fn counted(count: u64, noun: &str) -> String {
    if count == 1 {
        return format!("1 {noun}");
    }
    if let Some(stem) = noun.strip_suffix("is") {
        return format!("{count} {stem}es");
    }
    let hisses = ["s", "x", "ch", "sh"].iter().any(|end| noun.ends_with(end));
    format!("{count} {noun}{}", if hisses { "es" } else { "s" })
}

/// Units of time, with the number of decimal places down to a femtosecond.
const UNITS: [(&str, usize); 6] = [("s", 15), ("ms", 12), ("us", 9), ("ns", 6), ("ps", 3), ("fs", 0)];

/// Formats a time in femtoseconds with all its digits: `40.68904 ms`.
pub fn time(fs: u128) -> String {
    times(&[fs]).concat()
}

/// Formats times in one unit, which suits the last of them; all have as many digits as the finest needs.
pub fn times(all_fs: &[u128]) -> Vec<String> {
    let last = all_fs.last().copied().unwrap_or(0);
    let power = |places: usize| 10u128.pow(places as u32);
    let fitting = UNITS.into_iter().find(|(_, places)| last >= power(*places));
    let (unit, places) = fitting.unwrap_or(("s", 15));
    let part = |fs: &u128| format!("{:0places$}", fs % power(places));
    let needed = |fs: &u128| part(fs).trim_end_matches('0').len();
    let decimals = if places == 0 {
        0
    } else {
        all_fs.iter().map(needed).max().unwrap_or(0)
    };
    let text = |fs: &u128| {
        let whole = fs / power(places);
        if decimals == 0 {
            format!("{whole} {unit}")
        } else {
            format!("{whole}.{} {unit}", &part(fs)[..decimals])
        }
    };
    all_fs.iter().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_singular() {
        let text = |count| counted(count, "signal") + ", " + &counted(count, "mismatch");
        assert_eq!(text(0), "0 signals, 0 mismatches");
        assert_eq!(text(1), "1 signal, 1 mismatch");
        assert_eq!(text(2), "2 signals, 2 mismatches");
        assert_eq!(counted(1, "axis"), "1 axis");
        assert_eq!(counted(2, "axis"), "2 axes");
        assert_eq!(counted(0, "tap"), "0 taps");
    }

    #[test]
    fn times_have_a_unit_and_the_digits_they_need() {
        for (fs, expected) in [
            (0, "0 s"),
            (1, "1 fs"),
            (25_000_000, "25 ns"),
            (40_689_040_000_000, "40.68904 ms"),
            (1_000_000_000_000_001, "1.000000000000001 s"),
        ] {
            assert_eq!(time(fs), expected);
        }
        let row = [980_000_000, 998_020_000_000, 999_500_000_000];
        assert_eq!(times(&row), ["0.98 us", "998.02 us", "999.50 us"].map(str::to_owned));
    }
}
