//! Limits of moves in counts and ticks, the units of the motion commands.

use super::axis_move::AxisMove;
use super::profile::motion_limits;
use crate::machine_file::{AxisSection, ClockSection};

/// Limits in counts and ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickLimits {
    /// Largest velocity, counts per tick.
    pub velocity: f64,
    /// Largest acceleration, counts per tick².
    pub acceleration: f64,
    /// Largest jerk, counts per tick³.
    pub jerk: f64,
}

impl TickLimits {
    /// Converts limits per second, second², second³ in a unit of `counts_per_unit` counts.
    pub fn new(velocity: f64, acceleration: f64, jerk: f64, counts_per_unit: f64, tick_hz: f64) -> Self {
        Self {
            velocity: velocity * counts_per_unit / tick_hz,
            acceleration: acceleration * counts_per_unit / tick_hz.powi(2),
            jerk: jerk * counts_per_unit / tick_hz.powi(3),
        }
    }

    /// Limits of an axis: those of its file, else 0.25 m/s, 8 m/s², 400 m/s³.
    pub fn of_axis(axis: &AxisSection, clock: &ClockSection) -> Self {
        let [velocity, acceleration, jerk] = motion_limits(axis.limits.as_ref());
        Self::new(
            velocity,
            acceleration,
            jerk,
            axis.loop_counts_per_unit(),
            clock.sample_hz,
        )
    }

    /// Limits of an axis for a move that may be slower than the velocity limit.
    pub fn of_move(axis: &AxisSection, clock: &ClockSection, of: &AxisMove) -> Self {
        let [_, acceleration, jerk] = motion_limits(axis.limits.as_ref());
        Self::new(
            of.velocity,
            acceleration,
            jerk,
            axis.loop_counts_per_unit(),
            clock.sample_hz,
        )
    }
}
