//! Columns of a sensor that is dead, or that reached the end of its range.

use super::Remark;
use super::columns::{Column, Lines};
use super::names::Meaning;

/// Returns the value of a constant column.
pub(super) fn dead(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    values.iter().all(|value| *value == first).then_some(first)
}

/// Number of consecutive samples at an extreme that is too large for a coincidence.
const ROW_AT_EXTREME: usize = 4;

/// Finds runs of a response at its largest or smallest value, far from where it rests.
pub(super) fn saturated(column: &Column, lines: &Lines, range: std::ops::Range<usize>) -> Option<Remark> {
    let values = &column.values[range.clone()];
    if matches!(column.meaning, Meaning::Command | Meaning::Drive) || dead(values).is_some() {
        return None;
    }
    let rest = values.iter().sum::<f64>() / values.len() as f64;
    let (low, high) = values
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
    // A response that rests at its extreme, as before a step, is not saturated; a clipped one leaves the extreme and
    // comes back.
    let extremes = [high, low].map(|value| (value, runs(values, value)));
    let (value, runs) = extremes
        .into_iter()
        .filter(|(value, _)| (value - rest).abs() > 0.25 * (high - low))
        .max_by_key(|(_, runs)| runs.len())?;
    let samples: usize = runs.iter().map(|(_, length)| length).sum();
    (runs.len() >= 3).then(|| Remark::Saturated {
        column: column.name.clone(),
        value,
        samples,
        line: lines.of(range.start + runs[0].0),
    })
}

/// Start and length of each run of a value.
fn runs(values: &[f64], value: f64) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut length = 0;
    for (n, v) in values.iter().chain([&f64::NAN]).enumerate() {
        if *v == value {
            length += 1;
        } else {
            if length >= ROW_AT_EXTREME {
                runs.push((n - length, length));
            }
            length = 0;
        }
    }
    runs
}
