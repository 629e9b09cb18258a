//! Figures of a move from its samples: tracking error, residual vibration, and distance from a circle.
//!
//! Samples may come at any pace and in any unit; the figures have the unit of the samples.

/// Peak and root mean square of an error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorFigures {
    /// Largest magnitude of the error.
    pub peak: f64,
    /// Root mean square of the error; 0 without samples.
    pub rms: f64,
}

impl ErrorFigures {
    /// Figures of these errors. A NaN among them makes both figures NaN.
    pub fn of(errors: impl IntoIterator<Item = f64>) -> Self {
        let (mut peak, mut squares, mut samples) = (0.0f64, 0.0, 0u64);
        for error in errors {
            peak = if error.is_nan() { error } else { peak.max(error.abs()) };
            squares += error * error;
            samples += 1;
        }
        let rms = (squares / samples.max(1) as f64).sqrt();
        Self {
            peak: if rms.is_nan() { rms } else { peak },
            rms,
        }
    }
}

/// Distance of positions from their reference, sample by sample, up to the end of the shorter sequence.
pub fn tracking_error(reference: &[f64], positions: &[f64]) -> ErrorFigures {
    ErrorFigures::of(reference.iter().zip(positions).map(|(wanted, found)| wanted - found))
}

/// Motion of the load about `target` in `load`, the samples after the end of the command. The peak is the residual
/// displacement of [`response_figures`](crate::plant::response::response_figures), as seen at the samples.
pub fn residual_vibration(load: &[f64], target: f64) -> ErrorFigures {
    ErrorFigures::of(load.iter().map(|position| position - target))
}

/// Distance of points `(x, y)` from a circle, along its radius.
///
/// ```
/// use posicast_machine::plant::axis::contour_error;
///
/// let error = contour_error(&[(5.0, 0.0), (1.0, 4.0), (-3.1, 0.0)], (1.0, 0.0), 4.0);
/// assert!((error.peak - 0.1).abs() < 1e-12);
/// ```
pub fn contour_error(points: &[(f64, f64)], centre: (f64, f64), radius: f64) -> ErrorFigures {
    let distances = points.iter().map(|(x, y)| (x - centre.0).hypot(y - centre.1));
    ErrorFigures::of(distances.map(|distance| distance - radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_and_mean_square() {
        let error = tracking_error(&[1.0, 2.0, 3.0, 9.0], &[1.0, 5.0, -1.0]);
        assert_eq!(error.peak, 4.0);
        assert!((error.rms - (25.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(ErrorFigures::of([]), ErrorFigures::default());
        assert_eq!(residual_vibration(&[4.0, 7.0], 5.0).peak, 2.0);
        let bad = ErrorFigures::of([f64::NAN, 1.0]);
        assert!(bad.peak.is_nan() && bad.rms.is_nan());
    }
}
