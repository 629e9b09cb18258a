//! The band in which a slow sensor aliases the third harmonic of a sweep onto the sweep itself.
//!
//! Samples at the rate `r` show `3f` at `|r − 3f|`, which is `f` if `f = r/4`: there the third harmonic looks like the sweep at the same
//! time. Elsewhere it comes earlier or later, and counts as noise. Subtracting the aliased part leaves about a thousandth of the sweep,
//! which would look like narrow modes.

use super::transfer::Band;
use crate::modal::{Fit, ResponsePoint};

/// Half the width of the band, as a fraction of its frequency.
const HALF_WIDTH: f64 = 0.04;
/// Root mean square of the residual, over the noise, above which it is more than noise.
const LEFT: f64 = 1.3;

/// Returns the band for a sensor with `fine_s` seconds between its samples.
pub(super) fn crossing(fine_s: f64) -> Band {
    let middle_hz = 0.25 / fine_s;
    Band {
        low_hz: middle_hz * (1.0 - HALF_WIDTH),
        high_hz: middle_hz * (1.0 + HALF_WIDTH),
    }
}

fn is_within(band: &Band, point: &ResponsePoint) -> bool {
    (band.low_hz..=band.high_hz).contains(&point.frequency_hz)
}

/// The points outside of the band.
pub(super) fn outside(points: &[ResponsePoint], band: &Band) -> Vec<ResponsePoint> {
    points.iter().filter(|point| !is_within(band, point)).copied().collect()
}

/// Counts the residual of a fit of the other points as noise within the band.
pub(super) fn weighed(points: &mut [ResponsePoint], band: &Band, fit: &Fit) {
    let within = points
        .iter()
        .zip(&fit.values)
        .filter(|(point, _)| is_within(band, point));
    let (sum, count) = within.fold((0.0, 0usize), |(sum, count), (point, value)| {
        (sum + ((point.value - value) / point.deviation).norm_sqr(), count + 1)
    });
    let ratio = (0.5 * sum / count.max(1) as f64).sqrt();
    if ratio > LEFT {
        for point in points.iter_mut().filter(|point| is_within(band, point)) {
            point.deviation *= ratio;
        }
    }
}
