//! The criterion for integer solutions of linear equations by greatest common divisors of minors.
//!
//! `A v = b` has an integer solution if and only if the minors of the largest order of `A` and of `[A b]` have the
//! same greatest common divisor. All equations here have two independent rows, so the minors are 2 by 2.

/// An equation `a·v = b` in three unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Equation {
    /// Coefficients `a`.
    pub(super) unknowns: [i64; 3],
    /// Right side `b`.
    pub(super) right: i64,
}

impl Equation {
    fn columns(&self) -> [i64; 4] {
        let [a, b, c] = self.unknowns;
        [a, b, c, self.right]
    }
}

/// Returns the greatest common divisor of all 2-by-2 minors, with or without those that include the right side.
pub(super) fn minors_divisor(equations: &[Equation], with_right_side: bool) -> u64 {
    let columns = if with_right_side { 4 } else { 3 };
    let mut divisor = 0;
    for (index, upper) in equations.iter().enumerate() {
        for lower in equations.iter().skip(index + 1) {
            let (upper, lower) = (upper.columns(), lower.columns());
            for left in 0..columns {
                for right in left + 1..columns {
                    let minor = upper[left] * lower[right] - upper[right] * lower[left];
                    divisor = greatest_common_divisor(divisor, minor.unsigned_abs());
                }
            }
        }
    }
    divisor
}

fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solvable_system_has_equal_divisors() {
        // v1 + v2 = 3 with v2 + v3 = 5 has integer solutions; 2 v1 = 1 with v2 + v3 = 5 has none.
        let equation = |unknowns, right| Equation { unknowns, right };
        let solvable = [equation([1, 1, 0], 3), equation([0, 1, 1], 5)];
        assert_eq!(minors_divisor(&solvable, false), minors_divisor(&solvable, true));
        let unsolvable = [equation([2, 0, 0], 1), equation([0, 1, 1], 5)];
        assert_eq!(minors_divisor(&unsolvable, false), 2);
        assert_eq!(minors_divisor(&unsolvable, true), 1);
    }
}
