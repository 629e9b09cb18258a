//! Ratios of frequencies: common divisor, odd multiples, and classes by powers of two.
//!
//! Modes share an antiperiod `T_a = 1/(2 f_c)` where every `f_i = m_i f_c` with an odd `m_i`: each makes an odd
//! number of half swings in `T_a`, so all are inverted at once (Singh and Heppler 1993). For rational ratios that is
//! so exactly if all `m_i` contain the same power of two; the smallest partition into sets with an antiperiod is
//! therefore that into classes of equal power.
//!
//! Frequencies come as `f64`, and the damped frequency of a mode whose natural frequency the file gives is
//! irrational. So a ratio is taken to be the simplest fraction within [`ROUNDING`] of it, found by its continued
//! fraction. This is exact for decimals as written, and for equal damping. Nothing is missed by it: a multiple above
//! [`MULTIPLE_MAX`] of the lowest mode would mean an antiperiod of as many half periods, which no ring buffer holds.

use super::joint_error::{JointError, list};

/// Relative distance within which a ratio of two frequencies is taken for a fraction: some hundred units of the last
/// place, which decimals of 14 digits and the conversion to the damped frequency leave.
pub const ROUNDING: f64 = 1e-13;
/// Largest multiple of the divisor that the lowest mode may have.
pub const MULTIPLE_MAX: u64 = 16_384;
/// Number of candidates after which the search with a tolerance gives up; it takes far less than a second.
const BUDGET: u32 = 1_000_000;

/// Frequencies as whole multiples of a common divisor.
#[derive(Debug, Clone, PartialEq)]
pub struct Multiples {
    /// The common divisor `f_c`, in the unit of the frequencies, that makes the largest relative error smallest.
    pub divisor: f64,
    /// The multiple `m_i` of each frequency, in their order.
    pub multiples: Vec<u64>,
    /// Largest relative error `|f_i − m_i f_c| / f_i`.
    pub error: f64,
}

/// A set of frequencies that share an antiperiod.
#[derive(Debug, Clone, PartialEq)]
pub struct Class {
    /// Indices of its members in the list of frequencies, ascending.
    pub members: Vec<usize>,
    /// Divisor, odd multiples and error of the members.
    pub multiples: Multiples,
}

impl Multiples {
    /// Takes the multiples, and finds the divisor whose largest relative error is smallest.
    fn of(frequencies: &[f64], multiples: Vec<u64>) -> Self {
        let inverse = multiples.iter().zip(frequencies).map(|(m, f)| *m as f64 / f);
        let (least, most) = inverse.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), value| {
            (least.min(value), most.max(value))
        });
        Self {
            divisor: 2.0 / (least + most),
            multiples,
            error: (most - least) / (most + least),
        }
    }

    /// Whether all multiples are odd, so that there is an antiperiod.
    pub fn is_antisymmetric(&self) -> bool {
        self.multiples.iter().all(|m| m % 2 == 1)
    }

    /// Antiperiod `1/(2 f_c)`; `None` where there is none.
    pub fn antiperiod(&self) -> Option<f64> {
        self.is_antisymmetric().then_some(0.5 / self.divisor)
    }
}

/// The greatest common divisor of the frequencies, and their multiples of it.
///
/// # Errors
/// [`JointError::NoCommonDivisor`] where a ratio is not a fraction, or the lowest frequency is more than
/// [`MULTIPLE_MAX`] times the divisor.
pub fn common_divisor(frequencies: &[f64]) -> Result<Multiples, JointError> {
    let none = || JointError::NoCommonDivisor {
        frequencies_hz: list(frequencies),
        most: MULTIPLE_MAX,
    };
    let lowest = frequencies.iter().fold(f64::INFINITY, |least: f64, f| least.min(*f));
    let fractions = frequencies.iter().map(|f| fraction(f / lowest));
    let fractions: Vec<(u64, u64)> = fractions.collect::<Option<_>>().ok_or_else(none)?;
    // The multiple of the lowest mode is the least common multiple of the denominators.
    let lowest_multiple = fractions.iter().try_fold(1, |multiple: u64, (_, denominator)| {
        let common = multiple / gcd(multiple, *denominator) * denominator;
        (common <= MULTIPLE_MAX).then_some(common)
    });
    let lowest_multiple = lowest_multiple.ok_or_else(none)?;
    let multiples = fractions.iter().map(|(n, d)| n * (lowest_multiple / d));
    Ok(Multiples::of(frequencies, multiples.collect()))
}

/// The smallest partition into sets with an antiperiod, by the power of two in the multiples; the set with the first
/// frequency comes first.
///
/// # Errors
/// Those of [`common_divisor`].
pub fn partition(frequencies: &[f64]) -> Result<Vec<Class>, JointError> {
    let all = common_divisor(frequencies)?;
    let mut classes: Vec<(u32, Vec<usize>)> = Vec::new();
    for (index, multiple) in all.multiples.iter().enumerate() {
        let power = multiple.trailing_zeros();
        match classes.iter_mut().find(|(p, _)| *p == power) {
            Some((_, members)) => members.push(index),
            None => classes.push((power, vec![index])),
        }
    }
    let class = |members: Vec<usize>| {
        let divisor = members
            .iter()
            .fold(0, |divisor, &index| gcd(divisor, all.multiples[index]));
        let own: Vec<f64> = members.iter().map(|&index| frequencies[index]).collect();
        let multiples = members.iter().map(|&index| all.multiples[index] / divisor).collect();
        Class {
            multiples: Multiples::of(&own, multiples),
            members,
        }
    };
    Ok(classes.into_iter().map(|(_, members)| class(members)).collect())
}

/// The smallest odd multiples with `|f_i − m_i f_c| ≤ tolerance · f_i` for one `f_c`. The multiple of the lowest
/// frequency is made as small as possible, then that of the first in the list, and so on.
///
/// # Errors
/// [`JointError::NoCommonDivisor`] where the lowest frequency would be more than [`MULTIPLE_MAX`] times the divisor.
pub fn nearest_odd(frequencies: &[f64], tolerance: f64) -> Result<Multiples, JointError> {
    let lowest = frequencies.iter().fold(f64::INFINITY, |least: f64, f| least.min(*f));
    let mut search = OddSearch {
        frequencies,
        // Decimals whose distance on paper equals the tolerance count as within it.
        tolerance: tolerance + ROUNDING,
        left: BUDGET,
    };
    let found = (1..=MULTIPLE_MAX).step_by(2).find_map(|multiple| {
        let start = search.within(lowest, multiple);
        search.extend(start, Vec::new())
    });
    let multiples = found.map(|multiples| Multiples::of(frequencies, multiples));
    multiples.ok_or_else(|| JointError::NoCommonDivisor {
        frequencies_hz: list(frequencies),
        most: MULTIPLE_MAX,
    })
}

/// Depth-first search over the multiples; the divisor is known to an interval.
struct OddSearch<'a> {
    frequencies: &'a [f64],
    tolerance: f64,
    left: u32,
}

impl OddSearch<'_> {
    /// Interval of divisors for which `multiple` is close enough.
    fn within(&self, frequency: f64, multiple: u64) -> (f64, f64) {
        let exact = frequency / multiple as f64;
        (exact * (1.0 - self.tolerance), exact * (1.0 + self.tolerance))
    }

    /// Adds multiples of the remaining frequencies, for a divisor in `interval`.
    fn extend(&mut self, interval: (f64, f64), multiples: Vec<u64>) -> Option<Vec<u64>> {
        let Some(&frequency) = self.frequencies.get(multiples.len()) else {
            return Some(multiples);
        };
        let (low, high) = interval;
        let first = (frequency * (1.0 - self.tolerance) / high).max(1.0).ceil() as u64 | 1;
        let last = frequency * (1.0 + self.tolerance) / low;
        for multiple in (first..=last as u64).step_by(2) {
            self.left = self.left.checked_sub(1)?;
            let own = self.within(frequency, multiple);
            let both = (low.max(own.0), high.min(own.1));
            if both.0 <= both.1 {
                let longer = multiples.iter().copied().chain([multiple]).collect();
                if let Some(found) = self.extend(both, longer) {
                    return Some(found);
                }
            }
        }
        None
    }
}

/// The simplest fraction within [`ROUNDING`] of `ratio` ≥ 1, by its continued fraction; `None` above [`MULTIPLE_MAX`].
fn fraction(ratio: f64) -> Option<(u64, u64)> {
    let (mut before, mut now) = ((0u64, 1u64), (1u64, 0u64));
    let mut rest = ratio;
    loop {
        let whole = rest.floor();
        // The numerators grow fastest; past 2^53 they are not exact in f64.
        if whole.is_nan() || whole >= 9e15 {
            return None;
        }
        let next = |n: u64, b: u64| (whole as u64).checked_mul(n)?.checked_add(b);
        let longer = (next(now.0, before.0)?, next(now.1, before.1)?);
        if longer.1 > MULTIPLE_MAX {
            return None;
        }
        (before, now) = (now, longer);
        if (now.0 as f64 / now.1 as f64 - ratio).abs() <= ROUNDING * ratio {
            return Some(now);
        }
        rest = 1.0 / (rest - whole);
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_found_or_refused() {
        assert_eq!(fraction(1.0), Some((1, 1)));
        assert_eq!(fraction(0.3 / 0.1), Some((3, 1)));
        assert_eq!(fraction(2.1 / 1.414), Some((1050 / 7, 707 / 7)));
        assert_eq!(fraction(std::f64::consts::PI), None);
        for absurd in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(fraction(absurd), None);
        }
    }

    #[test]
    fn nearby_odd_multiples_are_the_smallest_within_the_tolerance() {
        let found = nearest_odd(&[30.2, 10.0], 0.01).unwrap();
        assert_eq!(found.multiples, [3, 1]);
        let (a, b) = (3.0 / 30.2, 0.1);
        assert!((found.error - (b - a) / (b + a)).abs() < 1e-15);
        for (f, m) in [30.2, 10.0].iter().zip([3.0, 1.0]) {
            assert!(((f - m * found.divisor) / f).abs() <= found.error * (1.0 + 1e-9));
        }
        // The ratio 2 : 1 has no odd pair; within 2 % the first one is 51 : 25 in lowest terms.
        let found = nearest_odd(&[1.0, 2.0], 0.02).unwrap();
        let ratio = found.multiples[1] as f64 / found.multiples[0] as f64;
        assert!(found.is_antisymmetric() && (ratio - 2.0).abs() <= 0.08, "{found:?}");
    }

    #[test]
    fn searches_without_an_answer_end() {
        assert!(nearest_odd(&[1.0, 2.0, std::f64::consts::E, 7.77, 31.4], 1e-9).is_err());
        assert!(common_divisor(&[1.0, f64::NAN]).is_err());
        assert!(common_divisor(&[1.0, 1.0001234567]).is_err());
    }
}
