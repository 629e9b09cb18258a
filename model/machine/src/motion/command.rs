//! A command given as points in time, resampled to the sample grid.

use super::profile::{ProfileError, SAMPLES_MAX};
use posicast_shaper::mode::Mode;

/// A command stands still at its end for this many periods of the slowest mode, so that ringing is visible.
const SETTLE_PERIODS: f64 = 3.0;

/// Why points are not a valid command.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PointsError {
    /// The list is empty.
    #[error("no points: give at least one line `time_s,position`")]
    Empty,
    /// A time or position is NaN or infinite.
    #[error("point {point}: {value} is not a finite number")]
    NotFinite {
        /// Index of the point, from 0.
        point: usize,
        /// The value found.
        value: f64,
    },
    /// A time does not lie after the one before it.
    #[error("point {point}: time {time_s} s does not lie after {before_s} s: times must increase")]
    Order {
        /// Index of the point, from 0.
        point: usize,
        /// Its time in s.
        time_s: f64,
        /// The time before it in s.
        before_s: f64,
    },
    /// The command has more samples than a run holds.
    #[error(transparent)]
    TooLong(#[from] ProfileError),
}

/// Returns how long a command stands still at its end, in seconds: the shaper's duration and some periods of the slowest
/// mode.
pub fn settle_s(shaper_duration_s: f64, modes: impl IntoIterator<Item = Mode>) -> f64 {
    let slowest_s = modes.into_iter().map(|m| m.damped_period_s()).fold(0.0, f64::max);
    shaper_duration_s + SETTLE_PERIODS * slowest_s
}

/// Positions at the samples from the first point to `settle_s` after the last: straight lines between the points,
/// then the last position.
///
/// # Errors
/// [`PointsError`] names the invalid point.
pub fn resample(points: &[(f64, f64)], sample_hz: f64, settle_s: f64) -> Result<Vec<f64>, PointsError> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Err(PointsError::Empty);
    };
    for (point, (time_s, position)) in points.iter().enumerate() {
        if let Some(value) = [*time_s, *position].into_iter().find(|v| !v.is_finite()) {
            return Err(PointsError::NotFinite { point, value });
        }
    }
    if let Some(at) = points.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
        let (before_s, time_s) = (points[at].0, points[at + 1].0);
        return Err(PointsError::Order {
            point: at + 1,
            time_s,
            before_s,
        });
    }
    let duration_s = last.0 - first.0 + settle_s;
    let samples = (duration_s * sample_hz).ceil() + 1.0;
    if samples.is_nan() || samples > SAMPLES_MAX as f64 {
        return Err(PointsError::TooLong(ProfileError::TooLong {
            duration_s,
            samples,
            sample_hz,
        }));
    }
    let mut segment = 0;
    let sample = |index: u32| {
        let time_s = first.0 + f64::from(index) / sample_hz;
        while points.get(segment + 1).is_some_and(|next| next.0 <= time_s) {
            segment += 1;
        }
        let from = points[segment];
        points.get(segment + 1).map_or(from.1, |to| {
            from.1 + (to.1 - from.1) * ((time_s - from.0) / (to.0 - from.0))
        })
    };
    Ok((0..samples as u32).map(sample).collect())
}

/// A command may exceed a limit by this fraction of it, because its file is rounded.
const ROUNDING: f64 = 1e-6;

/// Indices of the first point beyond `travel`, and of the first point that is reached faster than with `velocity`. Points are in time order;
/// positions, travel and velocity have one unit.
pub fn beyond_limits(
    points: &[(f64, f64)],
    travel: Option<[f64; 2]>,
    velocity: Option<f64>,
) -> (Option<usize>, Option<usize>) {
    let outside = travel.and_then(|[low, high]| {
        let room = ROUNDING * (high - low);
        points
            .iter()
            .position(|(_, position)| *position < low - room || *position > high + room)
    });
    let too_fast = velocity.and_then(|limit| {
        let speeds = points
            .windows(2)
            .map(|pair| (pair[1].1 - pair[0].1).abs() / (pair[1].0 - pair[0].0));
        let first = speeds.into_iter().position(|speed| speed > limit * (1.0 + ROUNDING));
        first.map(|index| index + 1)
    });
    (outside, too_fast)
}

/// Fraction of the largest velocity that counts as rest at the end of a command.
const REST: f64 = 0.01;

/// Velocity with which a command arrives at its last point, in the unit of the points per second; 0 where it comes to rest there. Points
/// are in time order. Velocities are those in the middle of the lines between points, continued to the end, so that a command
/// which brakes evenly into its last point comes to rest.
pub fn end_velocity(points: &[(f64, f64)]) -> f64 {
    let lines: Vec<(f64, f64)> = points
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0, (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)))
        .collect();
    let Some((&(time_s, velocity), before)) = lines.split_last() else {
        return 0.0;
    };
    let end = match before.last() {
        Some((before_s, before)) => velocity + (velocity - before) * time_s / (time_s + before_s),
        None => velocity,
    };
    let largest = lines.iter().map(|(_, velocity)| velocity.abs()).fold(0.0, f64::max);
    if end * velocity > 0.0 && end.abs() > REST * largest {
        end
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_that_brakes_into_its_last_point_comes_to_rest_and_one_that_is_cut_does_not() {
        // Even braking from 2 per second over 1 s, and a move without jumps of acceleration, at several sample rates.
        for samples in [4, 10, 1000] {
            let times = (0..=samples).map(|n| f64::from(n) / f64::from(samples));
            let braking: Vec<_> = times.clone().map(|t| (t, 2.0 * t - t * t)).collect();
            assert_eq!(end_velocity(&braking), 0.0, "{samples}");
            let smooth: Vec<_> = times
                .map(|t| (t, t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)))
                .collect();
            assert_eq!(end_velocity(&smooth), 0.0, "{samples}");
            let (braking, smooth) = (&braking[..braking.len() / 2 + 1], &smooth[..smooth.len() / 2 + 1]);
            assert!(end_velocity(braking) > 0.9 && end_velocity(smooth) > 1.5, "{samples}");
        }
        assert_eq!(end_velocity(&[(0.0, 0.0), (2.0, -3.0)]), -1.5);
        assert_eq!(end_velocity(&[(0.0, 0.0), (2.0, -3.0), (2.1, -3.0)]), 0.0);
        assert_eq!(end_velocity(&[(0.0, 1.0)]), 0.0);
        assert_eq!(end_velocity(&[]), 0.0);
    }

    #[test]
    fn points_are_joined_by_straight_lines_and_the_last_is_held() {
        let positions = resample(&[(1.0, 0.0), (1.2, 2.0), (1.3, 2.0)], 10.0, 0.2).unwrap();
        let expected = [0.0, 1.0, 2.0, 2.0, 2.0, 2.0];
        assert_eq!(positions.len(), expected.len());
        assert!(
            positions.iter().zip(expected).all(|(p, e)| (p - e).abs() < 1e-9),
            "{positions:?}"
        );
    }

    #[test]
    fn the_first_point_beyond_a_limit_is_found() {
        let points = [(0.0, 0.0), (1.0, 1.0), (1.5, 2.0), (3.0, -1.0)];
        assert_eq!(beyond_limits(&points, Some([0.0, 2.0]), Some(2.0)), (Some(3), None));
        assert_eq!(beyond_limits(&points, Some([-1.0, 1.9]), Some(1.9)), (Some(2), Some(2)));
        assert_eq!(beyond_limits(&points, Some([-1.0, 2.0]), Some(0.9)), (None, Some(1)));
        assert_eq!(beyond_limits(&points, None, None), (None, None));
    }

    #[test]
    fn wrong_points_are_named() {
        assert_eq!(resample(&[], 10.0, 0.0), Err(PointsError::Empty));
        let error = resample(&[(0.0, 0.0), (0.0, 1.0)], 10.0, 0.0).unwrap_err();
        assert!(matches!(error, PointsError::Order { point: 1, .. }));
        let error = resample(&[(0.0, f64::NAN)], 10.0, 0.0).unwrap_err();
        assert!(matches!(error, PointsError::NotFinite { point: 0, .. }));
        let error = resample(&[(0.0, 0.0), (1e300, 1.0)], 10.0, 0.0).unwrap_err();
        assert!(matches!(error, PointsError::TooLong(_)));
    }
}
