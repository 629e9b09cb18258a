//! Motion along a stretch of path from one speed to another, with limited acceleration and jerk.
//!
//! ```text
//! speed      ╭──────╮              up: from `from` to `peak`,  cruise,  down: from `peak` to `to`
//!           ╱        ╲
//!   from ──╯          ╰── to       the acceleration is 0 at both ends and while cruising
//! ```
//!
//! A change of the speed by `Δ` takes `2·√(Δ/j)` where the acceleration stays below `a`, else `Δ/a + a/j`; the mean
//! speed of it is that of its two ends.

/// Rounds in which the peak speed is narrowed down; each at least halves the interval of every second one.
const ROUNDS: u32 = 100;
/// Relative width at which the peak speed counts as found.
const FOUND: f64 = 1e-13;

/// Limits along the path, in m/s² and m/s³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Along {
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
}

impl Along {
    /// Time in which the speed changes by `change`.
    fn change_s(&self, change: f64) -> f64 {
        let change = change.abs();
        if change * self.jerk <= self.acceleration * self.acceleration {
            2.0 * (change / self.jerk).sqrt()
        } else {
            change / self.acceleration + self.acceleration / self.jerk
        }
    }

    /// Length of the path on which the speed changes from one value to the other.
    pub(super) fn change_length(&self, from: f64, to: f64) -> f64 {
        f64::midpoint(from, to) * self.change_s(to - from)
    }

    /// The largest speed, up to `most`, that is reached from `from` within this length.
    pub(super) fn reach(&self, from: f64, length: f64, most: f64) -> f64 {
        if most <= from || self.change_length(from, most) <= length {
            return most;
        }
        narrowed(from, most, |speed| self.change_length(from, speed) - length)
    }

    /// Length of the path that a change from `from` to the higher `to` takes to reach `speed`, which lies between them.
    fn length_until(&self, from: f64, to: f64, speed: f64) -> f64 {
        let (gained, left) = ((speed - from).max(0.0), (to - speed).max(0.0));
        let peak = self.acceleration.min((self.jerk * (to - from)).sqrt());
        let rounded = peak * peak / (2.0 * self.jerk);
        let climb = Climb::new(from, to, self);
        let time_s = if gained <= rounded {
            (2.0 * gained / self.jerk).sqrt()
        } else if left <= rounded {
            climb.duration_s() - (2.0 * left / self.jerk).sqrt()
        } else {
            climb.jerk_s + (gained - rounded) / peak
        };
        climb.after(time_s).0
    }
}

/// The argument between `low` and `high` at which a rising function is 0; the larger values that round to it are left
/// out, so that the function is not positive there.
fn narrowed(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (mut at_low, mut at_high) = (function(low), function(high));
    if at_low >= 0.0 {
        return low;
    }
    // The secant, with half of the value at an end that stays (the Illinois method), and a bisection every third time.
    for round in 0..ROUNDS {
        if high - low <= FOUND * high.abs() {
            break;
        }
        let secant = low + (high - low) * (at_low / (at_low - at_high));
        let middle = match round % 3 {
            2 => f64::midpoint(low, high),
            _ if secant > low && secant < high => secant,
            _ => f64::midpoint(low, high),
        };
        let found = function(middle);
        if found <= 0.0 {
            (low, at_low, at_high) = (middle, found.min(-f64::MIN_POSITIVE), at_high / 2.0);
        } else {
            (high, at_high, at_low) = (middle, found, at_low / 2.0);
        }
    }
    low
}

/// A rise of the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Climb {
    from: f64,
    jerk: f64,
    jerk_s: f64,
    constant_s: f64,
}

impl Climb {
    fn new(from: f64, to: f64, along: &Along) -> Self {
        let change = (to - from).max(0.0);
        let jerk_s = (along.acceleration / along.jerk).min((change / along.jerk).sqrt());
        let peak = along.jerk * jerk_s;
        let constant_s = if peak > 0.0 {
            (change / peak - jerk_s).max(0.0)
        } else {
            0.0
        };
        Self {
            from,
            jerk: along.jerk,
            jerk_s,
            constant_s,
        }
    }

    fn duration_s(&self) -> f64 {
        2.0 * self.jerk_s + self.constant_s
    }

    /// Length and speed after a time from 0 to the duration.
    fn after(&self, time_s: f64) -> (f64, f64) {
        let (jerk, peak) = (self.jerk, self.jerk * self.jerk_s);
        let rise_s = time_s.min(self.jerk_s);
        let mut length = (self.from + jerk * rise_s * rise_s / 6.0) * rise_s;
        let mut speed = self.from + jerk * rise_s * rise_s / 2.0;
        let hold_s = (time_s - self.jerk_s).clamp(0.0, self.constant_s);
        length += (speed + peak * hold_s / 2.0) * hold_s;
        speed += peak * hold_s;
        let fall_s = (time_s - self.jerk_s - self.constant_s).clamp(0.0, self.jerk_s);
        length += (speed + (peak / 2.0 - jerk * fall_s / 6.0) * fall_s) * fall_s;
        speed += (peak - jerk * fall_s / 2.0) * fall_s;
        (length, speed)
    }
}

/// Motion along a stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ramps {
    /// Length of the stretch, m.
    length: f64,
    along: Along,
    from: f64,
    peak: f64,
    to: f64,
    up: Climb,
    /// The fall, backwards in time.
    down: Climb,
    cruise_s: f64,
}

impl Ramps {
    /// The fastest motion along `length` from one speed to another, at most `most`.
    ///
    /// Where the length is too short for the change of speed, which rounding can cause, the limits are exceeded.
    pub(super) fn new(length: f64, [from, to]: [f64; 2], most: f64, limits: &Along) -> Self {
        let least = limits.change_length(from, to);
        let mut along = *limits;
        if least > length && length > 0.0 {
            let faster = least / length;
            along.acceleration *= faster;
            along.jerk *= faster * faster;
        }
        let used = |peak: f64| along.change_length(from, peak) + along.change_length(peak, to);
        let slowest = from.max(to);
        let most = most.max(slowest);
        let peak = if used(most) <= length {
            most
        } else {
            narrowed(slowest, most, |peak| used(peak) - length)
        };
        let cruise = (length - used(peak)).max(0.0);
        Self {
            length,
            along,
            from,
            peak,
            to,
            up: Climb::new(from, peak, &along),
            down: Climb::new(to, peak, &along),
            cruise_s: if peak > 0.0 { cruise / peak } else { 0.0 },
        }
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.up.duration_s() + self.cruise_s + self.down.duration_s()
    }

    /// Length and speed after a time; before the start and after the end those of the ends.
    pub(super) fn after(&self, time_s: f64) -> (f64, f64) {
        let (up_s, left_s) = (self.up.duration_s(), self.duration_s() - time_s);
        if time_s <= 0.0 {
            (0.0, self.from)
        } else if left_s <= 0.0 {
            (self.length, self.to)
        } else if left_s < self.down.duration_s() {
            let (left, speed) = self.down.after(left_s);
            (self.length - left, speed)
        } else {
            let (length, speed) = self.up.after(time_s.min(up_s));
            (length + self.peak * (time_s - up_s).max(0.0), speed)
        }
    }

    /// Whether the motion is faster than `speed` at this length.
    pub(super) fn exceeds(&self, length: f64, speed: f64) -> bool {
        let speed = speed * (1.0 + 1e-9);
        if self.peak <= speed {
            return false;
        }
        let until = |end: f64| {
            if speed <= end {
                0.0
            } else {
                self.along.length_until(end, self.peak, speed)
            }
        };
        length > until(self.from) && self.length - length > until(self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Profile;
    use proptest::prelude::*;

    const LIMITS: Along = Along {
        acceleration: 5.0,
        jerk: 300.0,
    };

    /// A stretch from rest to rest equals the move of an axis, which another planner computes.
    #[test]
    fn from_rest_to_rest_it_is_the_profile_of_an_axis() {
        for length in [1e-7, 1e-3, 0.01, 0.1, 3.0] {
            let ramps = Ramps::new(length, [0.0, 0.0], 0.2, &LIMITS);
            let profile = Profile::new(0.0, length, 0.2, LIMITS.acceleration, LIMITS.jerk).unwrap();
            assert!((ramps.duration_s() - profile.duration_s()).abs() < 1e-9 * profile.duration_s());
            for step in 0..=100 {
                let time_s = profile.duration_s() * f64::from(step) / 100.0;
                let (found, expected) = (ramps.after(time_s).0, profile.position(time_s));
                assert!((found - expected).abs() < 1e-9 * length, "{length} {step}");
            }
        }
    }

    proptest! {
        #[test]
        fn prop_a_stretch_keeps_its_limits_and_ends(from in 0.0..0.3f64, to in 0.0..0.3f64, more in 0.0..0.2f64, spare in 0.0..0.1f64) {
            let most = from.max(to) + more;
            let length = LIMITS.change_length(from, to) + spare + 1e-6;
            let ramps = Ramps::new(length, [from, to], most, &LIMITS);
            let steps = 2000;
            let step_s = ramps.duration_s() / f64::from(steps);
            let at: Vec<(f64, f64)> = (0..=steps).map(|k| ramps.after(f64::from(k) * step_s)).collect();
            prop_assert!((at[0].1 - from).abs() < 1e-9 && (at[steps as usize].1 - to).abs() < 1e-9);
            for pair in at.windows(2) {
                let ((before, speed), (after, next)) = (pair[0], pair[1]);
                prop_assert!(next <= most * (1.0 + 1e-9) + 1e-12);
                prop_assert!((next - speed).abs() <= LIMITS.acceleration * step_s * (1.0 + 1e-6) + 1e-12);
                prop_assert!((after - before - f64::midpoint(speed, next) * step_s).abs() < LIMITS.jerk * step_s.powi(3) + 1e-12);
                let middle = f64::midpoint(before, after);
                prop_assert!(!ramps.exceeds(middle, speed.max(next) + 1e-6));
                prop_assert!(speed.min(next) < 1e-3 || ramps.exceeds(middle, speed.min(next) - 1e-4 - 1e-3 * speed));
            }
        }
    }
}
