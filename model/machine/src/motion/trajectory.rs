//! Trajectories: commands whose position is a cubic of time between a few instants.
//!
//! ```text
//! u(t) = Σ_k  p_k + v_k·(t − t_k) + a_k·(t − t_k)²/2 + j_k·(t − t_k)³/6        over the jumps k with t_k ≤ t
//! ```
//!
//! A step is one jump of the position, a ramp one of the velocity, a trapezoidal velocity four of the acceleration,
//! and a jerk-limited move up to eight of the jerk. A shaper stays in this class: it copies every jump, multiplied by
//! `A_i` and delayed by `t_i`. Lengths are in the unit of the command, times in seconds.
//!
//! ```
//! use posicast_shaper::impulse::Impulse;
//! use posicast_machine::motion::Trajectory;
//!
//! let halves = [0.0, 0.005].map(|time_s| Impulse { time_s, amplitude: 0.5 });
//! let shaped = Trajectory::step(2.0).shaped(&halves);
//! assert_eq!((shaped.position(0.001), shaped.position(0.1)), (1.0, 2.0));
//! ```

use super::profile::{Profile, ProfileError};
use posicast_shaper::impulse::Impulse;

/// Relative size of the rest of jumps that cancel on paper; below it a derivative is set to 0. Otherwise a jerk of
/// 1e-17 would move a machine at rest away in a long simulation.
const CANCELLED: f64 = 1e-13;

/// A cubic of time, given by position, velocity, acceleration and jerk at its start.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cubic {
    /// Position.
    pub position: f64,
    /// Velocity, per second.
    pub velocity: f64,
    /// Acceleration, per second².
    pub acceleration: f64,
    /// Jerk, per second³.
    pub jerk: f64,
}

impl Cubic {
    /// The same cubic, taken `time_s` seconds later.
    pub fn after(&self, time_s: f64) -> Self {
        Self {
            position: self.position
                + time_s * (self.velocity + time_s * (self.acceleration / 2.0 + time_s * self.jerk / 6.0)),
            velocity: self.velocity + time_s * (self.acceleration + time_s * self.jerk / 2.0),
            acceleration: self.acceleration + time_s * self.jerk,
            jerk: self.jerk,
        }
    }

    fn derivatives(&self) -> [f64; 4] {
        [self.position, self.velocity, self.acceleration, self.jerk]
    }

    fn from_derivatives(derivatives: [f64; 4]) -> Self {
        let [position, velocity, acceleration, jerk] = derivatives;
        Self {
            position,
            velocity,
            acceleration,
            jerk,
        }
    }
}

/// A sudden change of position, velocity, acceleration or jerk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Time in seconds.
    pub time_s: f64,
    /// Change of position, velocity, acceleration and jerk.
    pub change: Cubic,
}

/// An interval without a jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Start in seconds.
    pub start_s: f64,
    /// The jump at its start.
    pub jump: Cubic,
    /// The command from its start on.
    pub cubic: Cubic,
}

/// A command that starts from rest at position 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    jumps: Vec<Jump>,
}

impl Trajectory {
    /// Makes the command with these jumps, which may be in any order.
    pub fn new(mut jumps: Vec<Jump>) -> Self {
        jumps.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let mut merged: Vec<Jump> = Vec::with_capacity(jumps.len());
        for jump in jumps {
            match merged.last_mut() {
                Some(last) if last.time_s == jump.time_s => {
                    let (a, b) = (last.change.derivatives(), jump.change.derivatives());
                    last.change = Cubic::from_derivatives([0, 1, 2, 3].map(|k| a[k] + b[k]));
                }
                _ => merged.push(jump),
            }
        }
        Self { jumps: merged }
    }

    /// A step of the position.
    pub fn step(position: f64) -> Self {
        Self::new(vec![Jump {
            time_s: 0.0,
            change: Cubic {
                position,
                ..Cubic::default()
            },
        }])
    }

    /// A ramp of this velocity without end.
    pub fn ramp(velocity: f64) -> Self {
        Self::new(vec![Jump {
            time_s: 0.0,
            change: Cubic {
                velocity,
                ..Cubic::default()
            },
        }])
    }

    /// A pulse: it goes to `position` at time 0, and back after `width_s` seconds.
    pub fn pulse(position: f64, width_s: f64) -> Self {
        let at = |time_s, position| Jump {
            time_s,
            change: Cubic {
                position,
                ..Cubic::default()
            },
        };
        Self::new(vec![at(0.0, position), at(width_s, -position)])
    }

    /// A move over `distance` (of either sign) with a trapezoidal velocity, or a triangular one where the distance is
    /// too short to reach the velocity limit.
    ///
    /// # Errors
    /// [`ProfileError`] for limits that are not positive and finite, or a distance that is not finite.
    pub fn trapezoid(distance: f64, velocity: f64, acceleration: f64) -> Result<Self, ProfileError> {
        for (limit, value) in [("velocity", velocity), ("acceleration", acceleration)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(ProfileError::Limit { limit, value });
            }
        }
        if !distance.is_finite() {
            return Err(ProfileError::Ends {
                start: 0.0,
                end: distance,
            });
        }
        let size = distance.abs();
        let rise_s = (velocity / acceleration).min((size / acceleration).sqrt());
        let cruise_s = if rise_s > 0.0 {
            (size / (acceleration * rise_s) - rise_s).max(0.0)
        } else {
            0.0
        };
        let signed = acceleration.copysign(distance);
        let changes = [
            (0.0, signed),
            (rise_s, -signed),
            (rise_s + cruise_s, -signed),
            (2.0 * rise_s + cruise_s, signed),
        ];
        Ok(Self::new(
            changes
                .map(|(time_s, acceleration)| Jump {
                    time_s,
                    change: Cubic {
                        acceleration,
                        ..Cubic::default()
                    },
                })
                .to_vec(),
        ))
    }

    /// A jerk-limited move, relative to its start.
    pub fn of_profile(profile: &Profile) -> Self {
        let jumps = profile.jerk_changes().map(|(time_s, jerk)| Jump {
            time_s,
            change: Cubic {
                jerk,
                ..Cubic::default()
            },
        });
        Self::new(jumps.to_vec())
    }

    /// The command after a shaper.
    pub fn shaped(&self, impulses: &[Impulse]) -> Self {
        let copies = impulses.iter().flat_map(|impulse| {
            self.jumps.iter().map(|jump| Jump {
                time_s: jump.time_s + impulse.time_s,
                change: Cubic::from_derivatives(jump.change.derivatives().map(|d| d * impulse.amplitude)),
            })
        });
        Self::new(copies.collect())
    }

    /// The jumps in order of time.
    pub fn jumps(&self) -> &[Jump] {
        &self.jumps
    }

    /// Time of the last jump, from which on the command rests (or continues its ramp).
    pub fn end_s(&self) -> f64 {
        self.jumps.last().map_or(0.0, |j| j.time_s)
    }

    /// The pieces between the jumps, the last one without end.
    pub fn pieces(&self) -> Vec<Piece> {
        let mut cubic = Cubic::default();
        let mut largest = [0.0f64; 4];
        let mut before_s = self.jumps.first().map_or(0.0, |j| j.time_s);
        let jumps = self.jumps.iter();
        jumps
            .map(|jump| {
                let (arrived, change) = (
                    cubic.after(jump.time_s - before_s).derivatives(),
                    jump.change.derivatives(),
                );
                let mut next = [0.0; 4];
                for k in 0..4 {
                    largest[k] = largest[k].max(arrived[k].abs()).max(change[k].abs());
                    let sum = arrived[k] + change[k];
                    // Only derivatives are set to 0: a position near 0 is as good as any other.
                    next[k] = if k > 0 && sum.abs() <= CANCELLED * largest[k] {
                        0.0
                    } else {
                        sum
                    };
                }
                cubic = Cubic::from_derivatives(next);
                before_s = jump.time_s;
                Piece {
                    start_s: jump.time_s,
                    jump: jump.change,
                    cubic,
                }
            })
            .collect()
    }

    /// Position at `time_s`; 0 before the first jump.
    pub fn position(&self, time_s: f64) -> f64 {
        let pieces = self.pieces();
        let index = pieces.partition_point(|p| p.start_s <= time_s);
        let piece = index.checked_sub(1).and_then(|i| pieces.get(i));
        piece.map_or(0.0, |p| p.cubic.after(time_s - p.start_s).position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trapezoid_ends_on_its_distance_within_its_limits() {
        for (distance, velocity, acceleration) in
            [(0.005, 0.2, 8.0), (-3.0, 0.2, 8.0), (1e-9, 0.2, 8.0), (0.0, 1.0, 1.0)]
        {
            let trapezoid = Trajectory::trapezoid(distance, velocity, acceleration).unwrap();
            let end = trapezoid.pieces().last().unwrap().cubic;
            assert!((end.position - distance).abs() <= 1e-12 * distance.abs());
            assert_eq!((end.velocity, end.acceleration, end.jerk), (0.0, 0.0, 0.0));
            for piece in trapezoid.pieces() {
                assert!(piece.cubic.velocity.abs() <= velocity * (1.0 + 1e-12));
            }
        }
        assert!(Trajectory::trapezoid(1.0, 0.0, 1.0).is_err());
        assert!(Trajectory::trapezoid(f64::NAN, 1.0, 1.0).is_err());
    }

    #[test]
    fn a_profile_and_its_trajectory_agree() {
        for distance in [0.005, -1.0, 1e-5] {
            let profile = Profile::new(0.25, 0.25 + distance, 0.25, 8.0, 400.0).unwrap();
            let trajectory = Trajectory::of_profile(&profile);
            for k in 0..=1100 {
                let time_s = profile.duration_s() * f64::from(k) / 1000.0;
                let difference = trajectory.position(time_s) + 0.25 - profile.position(time_s);
                assert!(difference.abs() < 1e-12, "{distance} at {time_s}: {difference}");
            }
        }
    }

    #[test]
    fn a_shaped_move_ends_where_the_move_ends_for_ever() {
        let impulses =
            [(0.0, 1.0), (0.031, -2.0), (0.05, 2.0)].map(|(time_s, amplitude)| Impulse { time_s, amplitude });
        let profile = Profile::new(0.0, 0.3, 0.25, 8.0, 400.0).unwrap();
        let shaped = Trajectory::of_profile(&profile).shaped(&impulses);
        assert!((shaped.position(1e6) - 0.3).abs() < 1e-12);
        assert!((shaped.end_s() - profile.duration_s() - 0.05).abs() < 1e-15);
    }
}
