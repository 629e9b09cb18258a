//! Rounds real taps to integers whose sum is exactly `2^F`.
//!
//! ```text
//! c_i = ⌊a_i·2^F⌋, then +1 to the largest fractions until Σ c_i = 2^F; ties to the smaller delay; zeros dropped
//! ```
//!
//! The sum is exact so that a shaper at rest passes the position through to the last bit. There is one `F` per
//! machine: it is a constant of the hardware, shared by all axes. Where the file does not fix it, it is the largest
//! up to 16 at which every *rounded* coefficient of all tables fits 18 bits.

use super::{DigitiseError, DigitiseMethod, Digitised, RealTap, TAPS_MAX};
use posicast_taps::{COEFFICIENT_FRACTION_MAX, COEFFICIENT_MAX, COEFFICIENT_MIN, Tap, TapTable};

/// Values this close to a whole number, and fractions this close to each other, count as equal: weights that are
/// equal on paper differ by rounding, which must not decide a tie.
const EQUAL: f64 = 1e-9;

/// Rounds the taps of all axes of a machine, given with the axes' names, to tables with one common `F`.
///
/// # Errors
/// [`DigitiseError::Fraction`] if the coefficients do not fit with the `F` asked for; it names the largest that fits.
/// [`DigitiseError::Weight`] if none fits. [`DigitiseError::Taps`] for more taps than a table holds.
pub fn quantise(axes: &[(&str, &Digitised)], fraction: Option<u32>) -> Result<Vec<TapTable>, DigitiseError> {
    let largest = largest_fraction(axes)?;
    let fraction = match fraction {
        None => largest,
        Some(requested) if (1..=largest).contains(&requested) => requested,
        Some(requested) => return Err(DigitiseError::Fraction { requested, largest }),
    };
    axes.iter()
        .map(|(axis, digitised)| {
            let taps: Vec<Tap> = integers(&digitised.taps, fraction)
                .into_iter()
                .zip(&digitised.taps)
                .filter(|(coefficient, _)| *coefficient != 0)
                .map(|(coefficient, real)| Tap {
                    delay_samples: real.delay_samples,
                    coefficient: i32::try_from(coefficient).unwrap_or(i32::MAX),
                })
                .collect();
            if digitised.method_used == DigitiseMethod::HalfSums {
                check_half_sums(axis, digitised, fraction)?;
            } else if taps.len() > TAPS_MAX {
                return Err(DigitiseError::Taps {
                    axis: (*axis).to_owned(),
                    found: taps.len(),
                });
            }
            TapTable::new(fraction, taps).map_err(|cause| DigitiseError::Table {
                axis: (*axis).to_owned(),
                cause,
            })
        })
        .collect()
}

/// The largest `F` at which every rounded coefficient fits.
fn largest_fraction(axes: &[(&str, &Digitised)]) -> Result<u32, DigitiseError> {
    let range = i64::from(COEFFICIENT_MIN)..=i64::from(COEFFICIENT_MAX);
    let fits = |taps: &[RealTap], fraction| integers(taps, fraction).iter().all(|c| range.contains(c));
    let mut largest = COEFFICIENT_FRACTION_MAX;
    for (axis, digitised) in axes {
        while !fits(&digitised.taps, largest) {
            if largest == 1 {
                let weights = digitised.taps.iter().map(|t| t.weight);
                return Err(DigitiseError::Weight {
                    axis: (*axis).to_owned(),
                    weight: weights.fold(0.0, |most: f64, w| if w.abs() > most.abs() { w } else { most }),
                });
            }
            largest -= 1;
        }
    }
    Ok(largest)
}

/// Largest-remainder rounding of the weights times `2^fraction`.
fn integers(taps: &[RealTap], fraction: u32) -> Vec<i64> {
    let scale = f64::from(1u32 << fraction);
    let mut coefficients = Vec::with_capacity(taps.len());
    let mut remainders = Vec::with_capacity(taps.len());
    for (index, tap) in taps.iter().enumerate() {
        let scaled = tap.weight * scale;
        let whole = if (scaled - scaled.round()).abs() <= EQUAL {
            scaled.round()
        } else {
            scaled.floor()
        };
        coefficients.push(whole as i64);
        // Fractions are put on a grid of `EQUAL`, so that equal ones compare equal.
        remainders.push((((scaled - whole).max(0.0) / EQUAL).round() as i64, index));
    }
    let floors: i64 = coefficients.iter().fold(0, |sum, c| sum.saturating_add(*c));
    let missing = usize::try_from((1i64 << fraction).saturating_sub(floors)).unwrap_or(0);
    remainders.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
    for (_, index) in remainders.into_iter().take(missing) {
        coefficients[index] = coefficients[index].saturating_add(1);
    }
    coefficients
}

/// Checks that a cascade's weights are whole numbers of the table's steps, because the hardware does not round them.
fn check_half_sums(axis: &str, digitised: &Digitised, fraction: u32) -> Result<(), DigitiseError> {
    let is_whole = |bits: u32| {
        let mut taps = digitised.taps.iter();
        taps.all(|tap| (tap.weight * f64::from(bits).exp2()).fract() == 0.0)
    };
    if is_whole(fraction) {
        return Ok(());
    }
    Err(DigitiseError::HalfSums {
        axis: axis.to_owned(),
        fraction,
        least: (fraction..).find(|bits| is_whole(*bits)).unwrap_or(fraction),
    })
}

/// `Σ |c_i/2^F − a_i|` over all delays of both: multiplied by the range of the command, the largest error of the
/// output that rounding causes.
pub fn quantising_error(digitised: &Digitised, table: &TapTable) -> f64 {
    let scale = f64::from(1u32 << table.coefficient_fraction());
    let coefficient_at = |delay_samples| {
        let found = table.taps().binary_search_by_key(&delay_samples, |t| t.delay_samples);
        found.map_or(0.0, |index| f64::from(table.taps()[index].coefficient) / scale)
    };
    let real = digitised.taps.iter();
    let of_real: f64 = real
        .map(|tap| (coefficient_at(tap.delay_samples) - tap.weight).abs())
        .sum();
    let is_real = |delay_samples| {
        let found = digitised.taps.binary_search_by_key(&delay_samples, |t| t.delay_samples);
        found.is_ok()
    };
    let of_table_alone = table.taps().iter().filter(|t| !is_real(t.delay_samples));
    of_real
        + of_table_alone
            .map(|t| f64::from(t.coefficient).abs() / scale)
            .sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digitised(weights: &[f64]) -> Digitised {
        let taps = weights.iter().enumerate().map(|(delay, &weight)| RealTap {
            delay_samples: delay as u32,
            weight,
        });
        Digitised {
            method_used: DigitiseMethod::Linear,
            taps: taps.collect(),
        }
    }

    fn table(weights: &[f64], fraction: Option<u32>) -> Result<TapTable, DigitiseError> {
        quantise(&[("x", &digitised(weights))], fraction).map(|mut tables| tables.remove(0))
    }

    fn coefficients(table: &TapTable) -> Vec<i32> {
        table.taps().iter().map(|t| t.coefficient).collect()
    }

    #[test]
    fn largest_remainders_get_the_missing_ones() {
        // Times 4: 1.2, 0.9, 1.9; floors 1 0 1, two are missing.
        assert_eq!(coefficients(&table(&[0.3, 0.225, 0.475], Some(2)).unwrap()), [1, 1, 2]);
        // Thirds of 2^16 have equal fractions; the missing unit goes to the smallest delay.
        let third = 1.0 / 3.0;
        let noise = 1.0 + 4.0 * f64::EPSILON;
        let tied = table(&[third, third * noise, third], None).unwrap();
        assert_eq!(coefficients(&tied), [21846, 21845, 21845]);
    }

    #[test]
    fn negative_weights_floor_downwards() {
        // Times 4: -1.7, 1.3, 4.4; floors -2 1 4, one is missing.
        assert_eq!(
            coefficients(&table(&[-0.425, 0.325, 1.1], Some(2)).unwrap()),
            [-2, 1, 5]
        );
    }

    #[test]
    fn zero_coefficients_are_dropped() {
        let table = table(&[0.5, 1e-7, 0.5 - 1e-7], None).unwrap();
        let delays: Vec<u32> = table.taps().iter().map(|t| t.delay_samples).collect();
        assert_eq!(delays, [0, 2]);
    }

    #[test]
    fn one_fraction_serves_all_axes() {
        let (small, large) = (digitised(&[0.5, 0.5]), digitised(&[5.0, -4.0]));
        let tables = quantise(&[("x", &small), ("y", &large)], None).unwrap();
        // 5 · 2^14 = 81920 fits in 131071, twice that does not.
        assert_eq!(tables[0].coefficient_fraction(), 14);
        assert_eq!(tables[1].coefficient_fraction(), 14);
    }

    #[test]
    fn the_edge_is_judged_after_rounding() {
        // 131071.4 rounds down to the largest coefficient, 131071.6 up and out.
        let at = |scaled: f64| {
            let weight = scaled / 65536.0;
            table(&[weight, 1.0 - weight], None).unwrap().coefficient_fraction()
        };
        assert_eq!(at(131_071.4), 16);
        assert_eq!(at(131_071.6), 15);
    }

    #[test]
    fn what_does_not_fit_names_what_does() {
        assert_eq!(
            table(&[5.0, -4.0], Some(16)),
            Err(DigitiseError::Fraction {
                requested: 16,
                largest: 14
            })
        );
        assert!(matches!(
            table(&[0.5, 0.5], Some(0)),
            Err(DigitiseError::Fraction { largest: 16, .. })
        ));
        for weight in [70_000.0, -70_000.0, 1e300, f64::MAX, f64::INFINITY, f64::NAN] {
            assert!(table(&[weight, 1.0 - weight], None).is_err(), "{weight}");
        }
    }

    #[test]
    fn more_taps_than_a_table_holds() {
        let weights = vec![1.0 / 257.0; 257];
        assert!(matches!(
            table(&weights, None),
            Err(DigitiseError::Taps { found: 257, .. })
        ));
    }

    #[test]
    fn quantising_error_counts_taps_of_the_table_alone() {
        let other = table(&[0.25, 0.25, 0.5], None).unwrap();
        assert_eq!(quantising_error(&digitised(&[0.5, 0.5]), &other), 1.0);
    }

    #[test]
    fn quantising_error_counts_dropped_taps() {
        let weights = [0.5, 1e-7, 0.5 - 1e-7];
        let error = quantising_error(&digitised(&weights), &table(&weights, None).unwrap());
        assert!((error - 2e-7).abs() < 1e-15);
    }
}
