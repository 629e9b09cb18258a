//! Exact integration of one tick: `a += j; v += a; p += v`; the first tick of a point or a cubic, and what comes where entries are missing.
//!
//! All quantities are integers in LSB of 2^−32 counts per tick³, tick², tick, and counts, so nothing is ever rounded:
//! adding the same numbers in hardware, here or in C gives the same position.

use super::entry::{ACCELERATION_BITS, CubicEntry, EntryMotion, Point};

/// Fraction bits of jerk, acceleration, velocity and position.
pub const FRACTION_BITS: u32 = 32;
/// Width of the velocity in bits: Q16.32.
pub const VELOCITY_BITS: u32 = 48;

/// Fraction bits of the rounded position: Q24.8 counts.
pub const POSITION_FRACTION: u32 = 8;
/// Fraction bits of the rounded velocity: Q16.16 counts per tick.
pub const VELOCITY_FRACTION: u32 = 16;
/// Fraction bits of the rounded acceleration: Q8.24 counts per tick².
pub const ACCELERATION_FRACTION: u32 = 24;

/// Range of a command that is not modulo, in counts: beyond ±2^23 less a 32nd of that, a motion outwards is stopped.
pub const REACH_COUNTS: i32 = (1 << 23) - (1 << 18);
/// Position in counts beyond which such a stop does not slow down but is immediate: no velocity passes the end of the
/// word from here.
pub const STAND_COUNTS: i32 = (1 << 23) - (1 << 17);

/// A sum does not fit its word: the integrator stays as it was, and the move cannot continue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("acceleration or velocity does not fit its word: 128 counts per tick² and 32768 counts per tick are the ends")]
pub struct Overflow;

/// State of a command: position, velocity and acceleration in LSB of 2^−32.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Integrator {
    /// Position in counts, Q32.32, modulo 2^64.
    pub position: i64,
    /// Velocity in counts per tick, Q16.32.
    pub velocity: i64,
    /// Acceleration in counts per tick², Q8.32.
    pub acceleration: i64,
}

impl Integrator {
    /// A command at rest at this position in counts.
    pub fn resting_at(counts: i32) -> Self {
        Self {
            position: i64::from(counts) << FRACTION_BITS,
            ..Self::default()
        }
    }

    /// One tick of an entry, its first one or another.
    ///
    /// # Errors
    /// As [`jerk`](Self::jerk).
    pub fn play(&mut self, motion: &EntryMotion, is_first: bool) -> Result<(), Overflow> {
        match motion {
            EntryMotion::Jerk(jerk) => self.jerk(*jerk)?,
            EntryMotion::Point(point) => *self = Self::at_point(point),
            EntryMotion::Cubic(cubic) if is_first => self.begin_cubic(cubic),
            EntryMotion::Cubic(cubic) => self.jerk(cubic.jerk.into())?,
        }
        Ok(())
    }

    /// Exactly at a point.
    pub fn at_point(point: &Point) -> Self {
        Self {
            position: i64::from(point.position) << (FRACTION_BITS - POSITION_FRACTION),
            velocity: i64::from(point.velocity) << (FRACTION_BITS - VELOCITY_FRACTION),
            acceleration: i64::from(point.acceleration) << (FRACTION_BITS - ACCELERATION_FRACTION),
        }
    }

    /// The first tick of a cubic. The others are those of its jerk.
    fn begin_cubic(&mut self, cubic: &CubicEntry) {
        self.velocity = i64::from(cubic.velocity) << (FRACTION_BITS - VELOCITY_FRACTION);
        self.acceleration = i64::from(cubic.acceleration) << (FRACTION_BITS - ACCELERATION_FRACTION);
        self.position = self.position.wrapping_add(self.velocity);
    }

    /// One tick without an entry: on at the same velocity.
    pub fn extrapolate(&mut self) {
        self.acceleration = 0;
        self.position = self.position.wrapping_add(self.velocity);
    }

    /// One tick with this jerk (Q8.32).
    ///
    /// # Errors
    /// [`Overflow`] for an acceleration or velocity that does not fit. If only the velocity does not fit, the new
    /// acceleration is kept and the velocity stays, as in hardware.
    pub fn jerk(&mut self, jerk: i64) -> Result<(), Overflow> {
        self.acceleration = fitting(self.acceleration + jerk, ACCELERATION_BITS)?;
        self.velocity = fitting(self.velocity + self.acceleration, VELOCITY_BITS)?;
        self.position = self.position.wrapping_add(self.velocity);
        Ok(())
    }

    /// Integrates one tick of a quick stop: the velocity approaches 0 by at most `deceleration` (Q8.32, not
    /// negative); 0 stands for an immediate stop.
    pub fn stop(&mut self, deceleration: i64) {
        if deceleration == 0 {
            (self.velocity, self.acceleration) = (0, 0);
            return;
        }
        self.acceleration = (-self.velocity).clamp(-deceleration, deceleration);
        self.velocity += self.acceleration;
        self.position = self.position.wrapping_add(self.velocity);
    }

    /// Whether the position is beyond ±`counts` (in the lower 24 bits of its counts) and not moving back.
    pub fn leaves(&self, counts: i32) -> bool {
        // Outputs and hardware have the position modulo 2^24 counts.
        let position = self.position << 8 >> 8;
        let ends = -(i64::from(counts) << FRACTION_BITS)..i64::from(counts) << FRACTION_BITS;
        !ends.contains(&position) && (self.velocity < 0) == (position < 0)
    }

    /// Whether velocity and acceleration are both 0, without which the position does not stay.
    pub fn at_rest(&self) -> bool {
        self.velocity == 0 && self.acceleration == 0
    }

    /// Position (Q24.8, modulo 2^32), velocity (Q16.16) and acceleration (Q8.24), each rounded once, half up.
    /// Velocity and acceleration saturate at the upper end of their word instead of wrapping.
    pub fn rounded(&self) -> [i32; 3] {
        [
            self.position
                .wrapping_add(1 << (FRACTION_BITS - POSITION_FRACTION - 1))
                .wrapping_shr(FRACTION_BITS - POSITION_FRACTION) as i32,
            half_up(self.velocity, FRACTION_BITS - VELOCITY_FRACTION),
            half_up(self.acceleration, FRACTION_BITS - ACCELERATION_FRACTION),
        ]
    }
}

fn fitting(sum: i64, bits: u32) -> Result<i64, Overflow> {
    let half = 1i64 << (bits - 1);
    if (-half..half).contains(&sum) {
        Ok(sum)
    } else {
        Err(Overflow)
    }
}

fn half_up(value: i64, shift: u32) -> i32 {
    let rounded = (value + (1 << (shift - 1))) >> shift;
    rounded.min(i64::from(i32::MAX)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_is_its_closed_form() {
        // n ticks of jerk j from rest: a = n·j, v = j·n(n+1)/2, p = j·n(n+1)(n+2)/6.
        let mut at = Integrator::default();
        let (jerk, n) = (-12_345, 1000i64);
        for _ in 0..n {
            at.jerk(jerk).unwrap();
        }
        assert_eq!(at.acceleration, n * jerk);
        assert_eq!(at.velocity, jerk * n * (n + 1) / 2);
        assert_eq!(at.position, jerk * (n * (n + 1) * (n + 2) / 6));
    }

    #[test]
    fn a_cubic_is_its_closed_form_and_goes_on_straight() {
        // p = n·v + a·n(n−1)/2 + j·(n−1)n(n+1)/6 from the present position, whatever the velocity was before.
        let cubic = CubicEntry {
            jerk: -77,
            velocity: 1_234,
            acceleration: 56,
        };
        let (start, n) = (9i64 << 32, 10i64);
        let mut at = Integrator {
            position: start,
            velocity: -5,
            acceleration: 3,
        };
        for tick in 0..n {
            at.play(&EntryMotion::Cubic(cubic), tick == 0).unwrap();
        }
        let (v, a, j) = (1_234i64 << 16, 56i64 << 8, -77i64);
        assert_eq!(at.acceleration, a + (n - 1) * j);
        assert_eq!(at.velocity, v + (n - 1) * a + j * (n - 1) * n / 2);
        assert_eq!(
            at.position,
            start + n * v + a * n * (n - 1) / 2 + j * (n - 1) * n * (n + 1) / 6
        );
        let before = at;
        at.extrapolate();
        assert_eq!((at.velocity, at.acceleration), (before.velocity, 0));
        assert_eq!(at.position, before.position + before.velocity);
    }

    #[test]
    fn an_overflow_leaves_the_state_unchanged() {
        let largest = (1 << (ACCELERATION_BITS - 1)) - 1;
        let mut at = Integrator {
            acceleration: largest,
            ..Integrator::default()
        };
        let before = at;
        assert_eq!(at.jerk(1), Err(Overflow));
        assert_eq!(at, before);
        at.velocity = (1 << (VELOCITY_BITS - 1)) - 1;
        assert_eq!(at.jerk(0), Err(Overflow));
        assert_eq!(at.velocity, (1 << (VELOCITY_BITS - 1)) - 1);
    }

    #[test]
    fn a_stop_ends_at_rest_on_both_sides() {
        for velocity in [10_000_000_007, -10_000_000_007, 3, 0, -(1 << 47)] {
            let mut at = Integrator {
                velocity,
                acceleration: 99,
                ..Integrator::default()
            };
            let deceleration = 1 << 32;
            let ticks = (velocity.unsigned_abs().div_ceil(1 << 32)) as usize + 1;
            for _ in 0..ticks {
                let before = at.velocity;
                at.stop(deceleration);
                assert!((at.velocity - before).abs() <= deceleration && at.velocity.abs() <= before.abs());
            }
            assert!(at.at_rest(), "{velocity}: {at:?}");
        }
    }

    #[test]
    fn only_a_way_outwards_leaves_the_reach() {
        let at = |counts: i64, velocity: i64| Integrator {
            position: counts << FRACTION_BITS,
            velocity,
            acceleration: 0,
        };
        let reach = i64::from(REACH_COUNTS);
        assert!(!at(reach - 1, 1).leaves(REACH_COUNTS) && at(reach, 1).leaves(REACH_COUNTS));
        assert!(!at(-reach, -1).leaves(REACH_COUNTS) && at(-reach - 1, -1).leaves(REACH_COUNTS));
        assert!(!at(reach + 9, -1).leaves(REACH_COUNTS) && !at(-reach - 9, 1).leaves(REACH_COUNTS));
        assert!(at((1 << 23) - 1, 1).leaves(STAND_COUNTS) && at(-(1 << 23), -1).leaves(STAND_COUNTS));
    }

    #[test]
    fn the_ends_are_rounded_without_wrapping() {
        let at = Integrator {
            position: -(1 << 23),
            velocity: (1 << 47) - 1,
            acceleration: -(1 << 39),
        };
        assert_eq!(at.rounded(), [0, i32::MAX, i32::MIN]);
    }
}
