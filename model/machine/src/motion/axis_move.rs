//! The default move of an axis where no command file is given: its distance and velocity.
//!
//! ```text
//! start = 0, or the end of the travel that is nearest to it
//! d     = v · t, in which the move just reaches its velocity v:      t = v/a + a/j, or 2·√(v/j) where v·j < a²
//!         at least 5 mm or 5 mrad, rounded up to two digits in the unit of the file
//!         at most half of the travel and half of the command word
//! ```
//!
//! It goes in the positive direction if there is room. Without `velocity` in the file, d is 5 mm or 5 mrad.

use thiserror::Error;

use super::profile::{Profile, ProfileError, motion_limits};
use crate::machine_file::{AxisSection, FixedPoint};
use crate::unit::AxisUnit;
use posicast_shaper::unit::short;

/// Smallest distance where there is room, in m or rad.
const LEAST_DISTANCE: f64 = 0.005;
/// Fraction of the travel, and of the command word, that a default move covers at most.
const PART_OF_ROOM: f64 = 0.5;
/// Rounding of a product may exceed a figure with two digits by this relative error.
const ROUNDING: f64 = 1e-9;

/// A move of an axis. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMove {
    /// Distance from the start to the end; negative in the negative direction.
    pub distance: f64,
    /// Largest velocity, positive.
    pub velocity: f64,
}

/// Why a requested move is not possible. Lengths are in m or rad, shown in the unit of the axis.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum AxisMoveError {
    /// The distance is 0 or not finite.
    #[error("a move of {distance} causes no motion: give a distance in {unit} that is not 0")]
    Nothing {
        /// The figure that was given.
        distance: f64,
        /// Unit of the axis.
        unit: AxisUnit,
    },
    /// The distance is less than a count of the encoder.
    #[error(
        "a move of {} is {:.3} counts, less than one: give at least {}, or check counts_per_unit and unit",
        .unit.as_in_file(*.distance, ""), .distance * .counts_per_unit, .unit.as_in_file(1.0 / .counts_per_unit, "")
    )]
    BelowCount {
        /// Requested distance.
        distance: f64,
        /// Counts per m or rad.
        counts_per_unit: f64,
        /// Unit of the axis.
        unit: AxisUnit,
    },
    /// The move ends beyond the travel.
    #[error(
        "a move of {} goes from {} to {}, beyond the travel of {} to {}: give a distance from {} to {}",
        .unit.as_in_file(*.distance, ""), .unit.as_in_file(*.start, ""), .unit.as_in_file(.start + .distance, ""),
        .unit.as_in_file(.travel[0], ""), .unit.as_in_file(.travel[1], ""),
        .unit.as_in_file(.travel[0] - .start, ""), .unit.as_in_file(.travel[1] - .start, "")
    )]
    BeyondTravel {
        /// Requested distance.
        distance: f64,
        /// Position at which the move starts.
        start: f64,
        /// Ends of the travel.
        travel: [f64; 2],
        /// Unit of the axis.
        unit: AxisUnit,
    },
    /// The move ends beyond the command word.
    #[error(
        "a move of {} ends at {} counts, beyond a command word of {command_bits} bits with {command_fraction} fraction bits: \
         give at most {}, or raise command_bits or lower command_fraction in [fixed_point]",
        .unit.as_in_file(*.distance, ""), short(*.counts), .unit.as_in_file(*.most, "")
    )]
    BeyondWord {
        /// Requested distance.
        distance: f64,
        /// Position at the end, in counts.
        counts: f64,
        /// Width of the word.
        command_bits: u32,
        /// Fraction bits of the word.
        command_fraction: u32,
        /// Largest distance.
        most: f64,
        /// Unit of the axis.
        unit: AxisUnit,
    },
    /// The speed is not a positive number.
    #[error("a speed of {speed} causes no motion: give a positive number in {unit}/s")]
    Still {
        /// The figure that was given.
        speed: f64,
        /// Unit of the axis.
        unit: AxisUnit,
    },
    /// The speed exceeds the velocity limit.
    #[error(
        "a speed of {} is above the axis's velocity limit of {limit}: give at most that, or raise axis.limits.velocity",
        .unit.as_in_file(*.speed, "/s"), limit = .unit.as_in_file(*.limit, "/s")
    )]
    TooFast {
        /// Requested speed.
        speed: f64,
        /// Velocity limit of the axis.
        limit: f64,
        /// Unit of the axis.
        unit: AxisUnit,
    },
}

impl AxisMove {
    /// The default move of an axis, as described above.
    pub fn of_axis(axis: &AxisSection, words: &FixedPoint) -> Self {
        let [velocity, ..] = motion_limits(axis.limits.as_ref());
        let known = axis.limits.is_some_and(|limits| limits.velocity.is_some());
        Self::default_at(axis, words, known.then_some(velocity))
    }

    /// A move with this distance and speed, both in the unit of the axis; a missing one is that of the default move.
    ///
    /// # Errors
    /// [`AxisMoveError`] for a move that does not fit travel, word, encoder or limits.
    pub fn new(
        axis: &AxisSection,
        words: &FixedPoint,
        distance: Option<f64>,
        speed: Option<f64>,
    ) -> Result<Self, AxisMoveError> {
        let speed = speed.map(|speed| checked_speed(axis, speed)).transpose()?;
        let known = axis.limits.and_then(|limits| limits.velocity);
        let by_default = Self::default_at(axis, words, speed.or(known));
        let distance = distance.map(|distance| checked_distance(axis, words, distance));
        Ok(Self {
            distance: distance.transpose()?.unwrap_or(by_default.distance),
            ..by_default
        })
    }

    /// Start of the move: 0, or the nearest end of the travel.
    pub fn start(axis: &AxisSection) -> f64 {
        let travel = axis.limits.and_then(|limits| limits.travel);
        travel.map_or(0.0, |[low, high]| 0.0f64.max(low).min(high))
    }

    /// The move's position over time, with the acceleration and jerk limits of the axis.
    ///
    /// # Errors
    /// Those of [`Profile::new`].
    pub fn profile(&self, axis: &AxisSection) -> Result<Profile, ProfileError> {
        let [_, acceleration, jerk] = motion_limits(axis.limits.as_ref());
        let start = Self::start(axis);
        Profile::new(start, start + self.distance, self.velocity, acceleration, jerk)
    }

    /// The default move at this velocity; where the velocity is `None`, that of an axis without limits.
    fn default_at(axis: &AxisSection, words: &FixedPoint, velocity: Option<f64>) -> Self {
        let [of_limits, acceleration, jerk] = motion_limits(axis.limits.as_ref());
        let reached = velocity.map_or(0.0, |velocity| distance_to_reach(velocity, acceleration, jerk));
        let wanted = if reached > LEAST_DISTANCE {
            axis.unit.to_si(two_digits_up(axis.unit.in_file(reached)))
        } else {
            LEAST_DISTANCE
        };
        let start = Self::start(axis);
        let travel = axis.limits.and_then(|limits| limits.travel);
        let [low, high] = travel.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let of_travel = PART_OF_ROOM * (high - low);
        let of_word = PART_OF_ROOM * largest_counts(words) / axis.loop_counts_per_unit();
        let distance = wanted.min(of_travel).min(of_word);
        // The longer side of the start has at least half of the travel.
        let goes_up = high - start >= distance || high - start >= start - low;
        Self {
            distance: if goes_up { distance } else { -distance },
            velocity: velocity.unwrap_or(of_limits),
        }
    }
}

/// Distance of the shortest move that reaches this velocity.
fn distance_to_reach(velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    let seconds = if velocity * jerk < acceleration * acceleration {
        2.0 * (velocity / jerk).sqrt()
    } else {
        velocity / acceleration + acceleration / jerk
    };
    velocity * seconds
}

/// Rounds a positive figure up to two digits.
fn two_digits_up(figure: f64) -> f64 {
    let power = 1 - figure.log10().floor() as i32;
    let digits = (figure * 10f64.powi(power) * (1.0 - ROUNDING)).ceil();
    // A quotient of whole numbers equals what the decimal figure reads as.
    if power >= 0 {
        digits / 10f64.powi(power)
    } else {
        digits * 10f64.powi(-power)
    }
}

/// Range of a command word in counts.
fn largest_counts(words: &FixedPoint) -> f64 {
    (f64::from(words.command_bits) - 1.0 - f64::from(words.command_fraction)).exp2()
}

fn checked_distance(axis: &AxisSection, words: &FixedPoint, distance: f64) -> Result<f64, AxisMoveError> {
    let unit = axis.unit;
    if distance == 0.0 || !distance.is_finite() {
        return Err(AxisMoveError::Nothing { distance, unit });
    }
    let distance = unit.to_si(distance);
    let counts_per_unit = axis.loop_counts_per_unit();
    if (distance * counts_per_unit).abs() < 1.0 {
        return Err(AxisMoveError::BelowCount {
            distance,
            counts_per_unit,
            unit,
        });
    }
    let start = AxisMove::start(axis);
    let end = start + distance;
    if let Some([low, high]) = axis.limits.and_then(|limits| limits.travel)
        && !(low..=high).contains(&end)
    {
        return Err(AxisMoveError::BeyondTravel {
            distance,
            start,
            travel: [low, high],
            unit,
        });
    }
    let largest = largest_counts(words);
    let counts = end * counts_per_unit;
    if counts.abs() >= largest {
        return Err(AxisMoveError::BeyondWord {
            distance,
            counts,
            command_bits: words.command_bits,
            command_fraction: words.command_fraction,
            most: (largest - 1.0) / counts_per_unit - start,
            unit,
        });
    }
    Ok(distance)
}

fn checked_speed(axis: &AxisSection, speed: f64) -> Result<f64, AxisMoveError> {
    let unit = axis.unit;
    if !(speed > 0.0 && speed.is_finite()) {
        return Err(AxisMoveError::Still { speed, unit });
    }
    let speed = unit.to_si(speed);
    match axis.limits.and_then(|limits| limits.velocity) {
        Some(limit) if speed > limit => Err(AxisMoveError::TooFast { speed, limit, unit }),
        _ => Ok(speed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine_file::{self, Machine};

    /// A machine with one axis and this text in `[axis.limits]`.
    fn machine(unit: &str, counts_per_unit: f64, limits: &str) -> Machine {
        let text = format!(
            "name = \"one\"\n[clock]\nfrequency_hz = 50e6\nsample_hz = 10e3\n[[axis]]\nname = \"x\"\nunit = \"{unit}\"\n\
             counts_per_unit = {counts_per_unit:?}\n[axis.shaper]\nkind = \"none\"\n[axis.limits]\n{limits}\n"
        );
        machine_file::parse("machine.toml", &text).unwrap_or_else(|error| panic!("{error:?}\n{text}"))
    }

    const STAGE: &str = "velocity = 0.25\nacceleration = 8.0\njerk = 400.0\n";

    fn by_default(machine: &Machine) -> f64 {
        AxisMove::of_axis(&machine.axes[0], &machine.fixed_point).distance
    }

    #[test]
    fn a_default_move_reaches_the_velocity_where_that_fits() {
        let of = |limits: &str| by_default(&machine("m", 1e6, limits));
        // v/a + a/j = 51.25 ms; 12.8 mm.
        assert_eq!(of(STAGE), 0.013);
        assert_eq!(of(&format!("{STAGE}travel = [-0.1, 0.1]")), 0.013);
        assert_eq!(of(&format!("{STAGE}travel = [-0.1, 0.0]")), -0.013);
        assert_eq!(of(&format!("{STAGE}travel = [-0.1, 0.01]")), -0.013);
        assert_eq!(of(&format!("{STAGE}travel = [-0.01, 0.01]")), 0.01);
        assert_eq!(of(&format!("{STAGE}travel = [0.0, 0.01]")), 0.005);
        assert_eq!(of("velocity = 1.0\nacceleration = 10.0\njerk = 500.0"), 0.12);
        // Without a velocity, or a slow one: 5 mm.
        for limits in ["", "acceleration = 1.0", "velocity = 1e-3"] {
            assert_eq!(of(limits), 0.005, "{limits}");
        }
        let profile = AxisMove::of_axis(&machine("m", 1e6, STAGE).axes[0], &machine("m", 1e6, STAGE).fixed_point);
        let profile = profile.profile(&machine("m", 1e6, STAGE).axes[0]).unwrap();
        assert!(profile.stretches_s()[2] > 0.0, "it is at its velocity for a while");
    }

    #[test]
    fn a_default_move_is_round_in_the_unit_of_the_axis_and_fits_the_word() {
        let in_mm = "velocity = 250.0\nacceleration = 8e3\njerk = 400e3\n";
        assert_eq!(by_default(&machine("mm", 1e3, in_mm)), 0.013);
        let degrees = by_default(&machine(
            "deg",
            1e3,
            "velocity = 90.0\nacceleration = 900.0\njerk = 9e4\n",
        ));
        assert_eq!(format!("{:.9}", degrees.to_degrees()), "9.900000000");
        let crane = "velocity = 1.0\nacceleration = 0.5\njerk = 2.0\ntravel = [0.0, 20.0]";
        assert_eq!(by_default(&machine("m", 1e4, crane)), 2.3);
        // 32 bits with 8 fraction bits reach 2^23 counts.
        let fine = "velocity = 1.0\nacceleration = 0.5\njerk = 2.0";
        assert_eq!(by_default(&machine("m", 1e7, fine)), 4_194_304.0 / 1e7);
    }

    #[test]
    fn a_move_that_does_not_fit_says_what_does() {
        let machine = machine("mm", 1e3, "velocity = 250.0\ntravel = [-100, 50]");
        let axis = &machine.axes[0];
        let new = |distance, speed| AxisMove::new(axis, &machine.fixed_point, distance, speed);
        let refused = |distance, speed| new(distance, speed).unwrap_err().to_string();
        assert_eq!(
            new(Some(-40.0), Some(100.0)),
            Ok(AxisMove {
                distance: -0.04,
                velocity: 0.1
            })
        );
        assert_eq!(new(None, None), Ok(AxisMove::of_axis(axis, &machine.fixed_point)));
        assert_eq!(
            refused(Some(60.0), None),
            "a move of 60 mm goes from 0 mm to 60 mm, beyond the travel of -100 mm to 50 mm: give a distance from -100 mm to 50 mm"
        );
        assert!(refused(Some(0.0), None).contains("a move of 0 causes no motion"));
        assert!(refused(Some(f64::NAN), None).contains("causes no motion"));
        assert!(refused(Some(1e-4), None).contains("0.100 counts, less than one: give at least 0.001 mm"));
        assert!(refused(None, Some(300.0)).contains("300 mm/s is above the axis's velocity limit of 250 mm/s"));
        for still in [0.0, -1.0, f64::INFINITY] {
            assert!(refused(None, Some(still)).contains("causes no motion"));
        }
    }

    #[test]
    fn a_move_beyond_the_word_says_how_far_it_may_go() {
        let machine = machine("m", 1e6, "");
        let refused = AxisMove::new(&machine.axes[0], &machine.fixed_point, Some(9.0), None).unwrap_err();
        let text = refused.to_string();
        assert!(
            text.contains("9000000 counts, beyond a command word of 32 bits with 8 fraction bits"),
            "{text}"
        );
        assert!(text.contains("give at most 8.388607 m"), "{text}");
    }
}
