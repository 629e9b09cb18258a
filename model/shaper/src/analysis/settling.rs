//! Settling: when a deviation has come to rest.

/// Index of the first sample from which on every deviation stays within ± `band`; `None` where the last one does not.
///
/// ```
/// use posicast_shaper::analysis::settled_from;
///
/// assert_eq!(settled_from(&[9.0, -3.0, 1.5, -0.8, 0.4], 1.0), Some(3));
/// assert_eq!(settled_from(&[0.1, 0.2], 1.0), Some(0));
/// assert_eq!(settled_from(&[0.1, 2.0], 1.0), None);
/// ```
pub fn settled_from(deviations: &[f64], band: f64) -> Option<usize> {
    let outside = deviations.iter().rposition(|deviation| deviation.abs() > band);
    let first = outside.map_or(0, |last| last + 1);
    (first < deviations.len()).then_some(first)
}
