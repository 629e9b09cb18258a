//! The error at a place: between two entries, linear, rounded once.

/// Weight with which all of an error counts: 2^10.
pub const FULL_WEIGHT: u16 = 1 << WEIGHT_BITS;
pub(super) const WEIGHT_BITS: u32 = 10;

/// The error at `place`, in 2^−`fraction_bits` of the distance of two entries from the first one. The end values hold outside.
///
/// `(E_n · 2^f + (E_n+1 − E_n) · fraction + 2^(f−1)) >> f`: half up.
pub(super) fn interpolated(entries: &[i32], place: i64, fraction_bits: u32) -> i32 {
    let last = entries.len().saturating_sub(1);
    let index = usize::try_from(place >> fraction_bits).unwrap_or(0).min(last);
    let here = entries.get(index).copied().unwrap_or(0);
    let (true, Some(next)) = (place >= 0, entries.get(index + 1)) else {
        return here;
    };
    let fraction = place & ((1 << fraction_bits) - 1);
    let slope = i64::from(*next) - i64::from(here);
    here + rounded(slope * fraction, fraction_bits)
}

/// The part of an error that counts at a weight of 0 to [`FULL_WEIGHT`].
pub(super) fn weighted(error: i32, weight: u16) -> i32 {
    rounded(i64::from(error) * i64::from(weight), WEIGHT_BITS)
}

fn rounded(product: i64, shift: u32) -> i32 {
    ((product + (1 << (shift - 1))) >> shift) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_middle_and_the_ends() {
        let entries = [10, 20, -7];
        let at = |place| interpolated(&entries, place, 4);
        assert_eq!([-100, -1, 0, 8, 15, 16].map(at), [10, 10, 10, 15, 19, 20]);
        // 20 − 27 · 8 / 16 = 6.5, half up.
        assert_eq!([24, 31, 32, 33, 1000].map(at), [7, -5, -7, -7, -7]);
    }

    proptest! {
        #[test]
        fn prop_between_the_neighbours_and_no_steeper_than_they_are(
            low in -131_071i32..=131_071,
            step in -4096i32..=4096,
            place in 0i64..(1 << 20),
        ) {
            let entries = [low, low + step];
            let [error, next] = [place, place + 1].map(|place| interpolated(&entries, place, 20));
            prop_assert!(error >= low.min(low + step) && error <= low.max(low + step));
            prop_assert!((next - error).abs() <= 1, "steps of at most 2^−8 per place are at most 1");
            prop_assert!((next - error) * step.signum() >= 0, "monotone");
        }

        #[test]
        fn prop_a_weight_scales(error in -131_071i32..=131_071, weight in 0..=FULL_WEIGHT) {
            let exact = f64::from(error) * f64::from(weight) / 1024.0;
            prop_assert!((f64::from(weighted(error, weight)) - exact).abs() <= 0.5);
        }
    }
}
