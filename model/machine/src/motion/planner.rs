//! Plans moves as entries of the command FIFO: segments of constant jerk, and points.
//!
//! Lengths are in counts and times in ticks, so limits are in counts per tick, tick², tick³ ([`TickLimits`]).
//!
//! ```text
//! a jerk-limited move of seven segments: n₁ n₂ n₁ n₃ n₁ n₂ n₁ ticks with jerk j 0 −j 0 −j 0 j
//! covers exactly                         j · n₁ · (n₁ + n₂) · (2n₁ + n₂ + n₃)
//! ```
//!
//! The convolution of three boxes described there holds for sums as it does for integrals. The jerk is truncated to
//! its word of 2^−32, so some of the distance is missing: whole counts on a long move. Corrections, which are moves
//! of the same duration with a jerk of one or a few LSB (n₂ = 0), are added until less than half an LSB of the
//! command word is missing. A point of one tick at rest then sets the exact target.

use super::{Profile, ProfileError, TickLimits};
use posicast_blocks::segments::{
    ACCELERATION_BITS, Entry, EntryMotion, FRACTION_BITS, POSITION_FRACTION, Point, TICK_BITS,
};
use posicast_blocks::word::{WordError, WordFormat};
use std::collections::BTreeMap;

/// Longest interval of one entry, in ticks.
const TICKS_MAX: f64 = ((1u32 << TICK_BITS) - 1) as f64;
/// Half an LSB of a command word, in LSB of the integrator.
const HALF_A_WORD: i128 = 1 << (FRACTION_BITS - POSITION_FRACTION - 1);
/// Largest number of points of a path: 10 minutes at 1.6 kHz.
pub const POINTS_MAX: usize = 1_000_000;

/// Why a move cannot be planned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The limits or ends are invalid.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// An interval has too many ticks for one entry.
    #[error(
        "a stretch of {ticks:e} ticks: an entry holds at most {TICKS_MAX}; raise the limits, shorten the move, or lower sample_hz"
    )]
    TooLong {
        /// Ticks of the longest interval.
        ticks: f64,
    },
    /// A jerk, velocity or acceleration does not fit its word.
    #[error(
        "a jerk of {jerk:e} counts per tick³ does not fit: the limit is ±128; lower the jerk limit or raise sample_hz"
    )]
    Jerk {
        /// Jerk in counts per tick³.
        jerk: f64,
    },
    /// A point does not fit its words.
    #[error("a point of the path: {0}")]
    Word(#[from] WordError),
    /// The path has too many points.
    #[error("a path of {points} points, one per tick; at most {POINTS_MAX}: raise the limits or shorten the path")]
    Points {
        /// Number of points.
        points: usize,
    },
}

/// Plans the fastest jerk-limited move from `start`, the exact position of a command at rest (Q32.32 counts), to
/// `end` (Q24.8).
///
/// Returns segments, seven and up to eight more per correction, and the point on the target, which notifies; no
/// entries where `start` is `end`. Every interval is rounded up to whole ticks, so the limits are kept except for
/// some LSB of the jerk.
///
/// # Errors
/// [`PlanError`] for invalid limits, and for values that the entries do not hold.
pub fn plan_move(start: i64, end: i32, limits: &TickLimits) -> Result<Vec<Entry>, PlanError> {
    let target = i64::from(end) << (FRACTION_BITS - POSITION_FRACTION);
    let distance = i128::from(target) - i128::from(start);
    if distance == 0 {
        return Ok(Vec::new());
    }
    let counts = distance as f64 / (1u64 << FRACTION_BITS) as f64;
    let profile = Profile::new(0.0, counts, limits.velocity, limits.acceleration, limits.jerk)?;
    let stretches = profile.stretches_s().map(f64::ceil);
    let [jerk_ticks, constant_ticks, cruise_ticks] = stretches;
    let longest = stretches.into_iter().fold(0.0, f64::max);
    if longest > TICKS_MAX {
        return Err(PlanError::TooLong { ticks: longest });
    }
    let main = Stretches {
        jerk: jerk_ticks.max(1.0) as i128,
        constant: constant_ticks as i128,
        cruise: cruise_ticks as i128,
    };
    let jerk = distance / main.distance_per_jerk();
    if jerk.unsigned_abs() >= 1 << (ACCELERATION_BITS - 1) {
        let jerk = jerk as f64 / (1u64 << FRACTION_BITS) as f64;
        return Err(PlanError::Jerk { jerk });
    }
    let mut entries = segments(&with_corrections(&main, jerk as i64, distance));
    let target = Point {
        position: end,
        ..Point::default()
    };
    entries.push(Entry {
        ticks: 1,
        motion: EntryMotion::Point(target),
        notify: true,
    });
    Ok(entries)
}

/// Ticks of the intervals of a move: of jerk, of constant acceleration, of constant velocity.
#[derive(Debug, Clone, Copy)]
struct Stretches {
    jerk: i128,
    constant: i128,
    cruise: i128,
}

impl Stretches {
    fn distance_per_jerk(&self) -> i128 {
        let ramp = self.jerk + self.constant;
        self.jerk * ramp * (ramp + self.jerk + self.cruise)
    }

    fn duration(&self) -> i128 {
        4 * self.jerk + 2 * self.constant + self.cruise
    }

    /// Ticks at which the jerk changes, each with its change as a multiple of the jerk.
    fn jerk_changes(&self) -> [(i128, i64); 8] {
        let lengths = [
            self.jerk,
            self.constant,
            self.jerk,
            self.cruise,
            self.jerk,
            self.constant,
            self.jerk,
        ];
        let mut at = 0;
        let mut changes = [(0, 1); 8];
        for (index, length) in lengths.into_iter().enumerate() {
            at += length;
            changes[index + 1] = (at, [-1, -1, 1, -1, 1, 1, -1][index]);
        }
        changes
    }
}

/// The move and its corrections, each with its jerk.
fn with_corrections(main: &Stretches, jerk: i64, distance: i128) -> Vec<(Stretches, i64)> {
    let mut moves = vec![(*main, jerk)];
    let duration = main.duration();
    let mut missing = distance - i128::from(jerk) * main.distance_per_jerk();
    while missing.abs() >= HALF_A_WORD {
        let of = |ticks: i128| Stretches {
            jerk: ticks,
            constant: 0,
            cruise: duration - 4 * ticks,
        };
        // The interval of jerk is as long as one LSB allows: the distance grows with it.
        let (mut fits, mut beyond) = (1, duration / 4 + 1);
        while beyond - fits > 1 {
            let middle = (fits + beyond) / 2;
            if of(middle).distance_per_jerk() <= missing.abs() {
                fits = middle;
            } else {
                beyond = middle;
            }
        }
        let per_jerk = of(fits).distance_per_jerk();
        let jerk = missing / per_jerk;
        if jerk == 0 {
            break;
        }
        missing -= jerk * per_jerk;
        // This is below the jerk of the main move, which fits.
        moves.push((of(fits), jerk as i64));
    }
    moves
}

/// The sum of the moves, as segments.
fn segments(moves: &[(Stretches, i64)]) -> Vec<Entry> {
    let mut changes: BTreeMap<i128, i64> = BTreeMap::new();
    for (stretches, jerk) in moves {
        for (tick, times) in stretches.jerk_changes() {
            *changes.entry(tick).or_default() += times * jerk;
        }
    }
    changes.retain(|_, change| *change != 0);
    let mut jerk = 0;
    let ends = changes.keys().skip(1).copied().collect::<Vec<_>>();
    changes
        .iter()
        .zip(ends)
        .map(|((start, change), end)| {
            jerk += change;
            Entry {
                ticks: (end - start) as u32,
                motion: EntryMotion::Jerk(jerk),
                notify: false,
            }
        })
        .collect()
}

/// Plans moves from `start` (Q24.8, at rest) to `end` and back, `times` times.
///
/// # Errors
/// Those of [`plan_move`].
pub fn plan_to_and_fro(start: i32, end: i32, times: usize, limits: &TickLimits) -> Result<Vec<Entry>, PlanError> {
    let exact = |position: i32| i64::from(position) << (FRACTION_BITS - POSITION_FRACTION);
    let mut entries = plan_move(exact(start), end, limits)?;
    entries.extend(plan_move(exact(end), start, limits)?);
    Ok(entries.repeat(times))
}

/// Plans a circle as points, one per tick and axis: it starts at rest at `start` (Q24.8, both axes), its rightmost
/// point, goes `turns` times round counter-clockwise, and ends at rest. The limits hold along the path; its
/// centripetal acceleration v²/r is not included in them.
///
/// # Errors
/// [`PlanError`] for invalid limits, and for points that do not fit.
pub fn plan_circle(
    start: [i32; 2],
    radius_counts: f64,
    turns: f64,
    limits: &TickLimits,
) -> Result<[Vec<Entry>; 2], PlanError> {
    let length = std::f64::consts::TAU * radius_counts * turns;
    let profile = Profile::new(0.0, length, limits.velocity, limits.acceleration, limits.jerk)?;
    let ticks = profile.duration_s().ceil() + 1.0;
    if ticks.is_nan() || ticks > POINTS_MAX as f64 {
        let points = ticks as usize;
        return Err(PlanError::Points { points });
    }
    let place = |tick: i64| {
        let angle = profile.position(tick as f64) / radius_counts;
        [radius_counts * (angle.cos() - 1.0), radius_counts * angle.sin()]
    };
    points(start, ticks as i64, place)
}

/// Plans a path from its places, which are in counts from `start` (Q24.8, both axes). The first place is where it
/// begins at rest; there is a point per tick and axis for each later place, and the last is at rest.
///
/// # Errors
/// [`PlanError`] for more places than [`POINTS_MAX`], and for points that do not fit.
pub fn plan_places(start: [i32; 2], places: &[[f64; 2]]) -> Result<[Vec<Entry>; 2], PlanError> {
    if places.len() > POINTS_MAX {
        return Err(PlanError::Points { points: places.len() });
    }
    let place = |tick: i64| {
        let at = places.get(tick.max(0) as usize).or(places.last());
        at.copied().unwrap_or_default()
    };
    points(start, places.len().saturating_sub(1) as i64, place)
}

/// Points for the ticks 1 to `ticks`, one per tick and axis. `place` gives the path in counts from `start`, also for
/// tick 0 and earlier.
fn points(start: [i32; 2], ticks: i64, place: impl Fn(i64) -> [f64; 2]) -> Result<[Vec<Entry>; 2], PlanError> {
    let position = WordFormat::new(32, POSITION_FRACTION)?;
    let of_axis = |axis: usize| {
        let offset = position.to_counts(i64::from(start[axis]));
        let at = |tick: i64| place(tick)[axis];
        let entries = (1..=ticks).map(|tick| {
            let (now, before, earlier) = (at(tick), at(tick - 1), at(tick - 2));
            // These are the differences that the integrator's sums stand for; after the last point the axis is at
            // rest.
            let (velocity, acceleration) = if tick == ticks {
                (0.0, 0.0)
            } else {
                (now - before, now - 2.0 * before + earlier)
            };
            Ok(Entry {
                ticks: 1,
                motion: EntryMotion::Point(point(offset + now, velocity, acceleration)?),
                notify: tick == ticks,
            })
        });
        entries.collect::<Result<Vec<_>, PlanError>>()
    };
    Ok([of_axis(0)?, of_axis(1)?])
}

fn point(position: f64, velocity: f64, acceleration: f64) -> Result<Point, PlanError> {
    use posicast_blocks::segments::{ACCELERATION_FRACTION, VELOCITY_FRACTION};
    let word = |value, fraction| Ok::<i32, PlanError>(WordFormat::new(32, fraction)?.to_word(value)? as i32);
    Ok(Point {
        position: word(position, POSITION_FRACTION)?,
        velocity: word(velocity, VELOCITY_FRACTION)?,
        acceleration: word(acceleration, ACCELERATION_FRACTION)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_blocks::segments::Integrator;

    /// Limits of the XY stage: 0.25 m/s, 8 m/s² and 400 m/s³, at 1 µm per count and 10 kHz.
    fn stage() -> TickLimits {
        TickLimits::new(0.25, 8.0, 400.0, 1e6, 1e4)
    }

    /// Plays entries, and returns the largest velocity, acceleration and jerk of the segments.
    fn play(at: &mut Integrator, entries: &[Entry]) -> [i64; 3] {
        let mut largest = [0; 3];
        for entry in entries {
            for tick in 0..entry.ticks {
                at.play(&entry.motion, tick == 0).unwrap();
                if let EntryMotion::Jerk(jerk) = entry.motion {
                    let found = [at.velocity, at.acceleration, jerk];
                    largest = [0, 1, 2].map(|k: usize| largest[k].max(found[k].abs()));
                }
            }
        }
        largest
    }

    #[test]
    fn a_move_ends_at_rest_on_target_within_its_limits() {
        let limits = stage();
        let lsb = (1u64 << FRACTION_BITS) as f64;
        for counts in [1, -1, 7, 500, -5_000, 123_457, 8_000_000] {
            let mut at = Integrator::resting_at(17);
            let end = (17 + counts) << POSITION_FRACTION;
            let entries = plan_move(at.position, end, &limits).unwrap();
            assert!(entries.len() <= 24, "{counts}: {} entries", entries.len());
            let (segments, point) = entries.split_at(entries.len() - 1);
            let largest = play(&mut at, segments);
            assert!(at.at_rest(), "{counts}");
            let missing = (i64::from(end) << 24) - at.position;
            assert!(
                missing.abs() < 1 << 28,
                "{counts}: {} counts missing",
                missing as f64 / lsb
            );
            for (found, limit) in largest
                .into_iter()
                .zip([limits.velocity, limits.acceleration, limits.jerk])
            {
                assert!(
                    found as f64 / lsb <= limit * (1.0 + 1e-9),
                    "{counts}: {found} above {limit}"
                );
            }
            play(&mut at, point);
            assert_eq!(at.rounded(), [end, 0, 0]);
        }
    }

    #[test]
    fn a_move_is_as_long_as_its_profile_but_for_whole_ticks() {
        let entries = plan_move(0, 5_000 << 8, &stage()).unwrap();
        let ticks: u32 = entries.iter().map(|entry| entry.ticks).sum();
        let profile = Profile::new(0.0, 0.005, 0.25, 8.0, 400.0).unwrap();
        let exact = profile.duration_s() * 1e4;
        assert!((exact..exact + 9.0).contains(&f64::from(ticks)), "{ticks} of {exact}");
    }

    #[test]
    fn no_distance_no_entries_and_a_tiny_one_is_a_point() {
        assert_eq!(plan_move(0, 0, &stage()).unwrap(), []);
        let nearly = plan_move(1, 0, &stage()).unwrap();
        assert!(
            matches!(
                nearly[..],
                [Entry {
                    ticks: 1,
                    motion: EntryMotion::Point(_),
                    ..
                }]
            ),
            "{nearly:?}"
        );
    }

    #[test]
    fn moving_to_and_fro_ends_at_the_start() {
        let mut at = Integrator::default();
        let entries = plan_to_and_fro(0, 1_000 << 8, 3, &stage()).unwrap();
        play(&mut at, &entries);
        assert_eq!(at, Integrator::default());
    }

    #[test]
    fn a_circle_is_round_and_closes() {
        let radius = 5_000.0;
        let [x, y] = plan_circle([0, 0], radius, 2.0, &stage()).unwrap();
        assert_eq!(x.len(), y.len());
        let counts = |entry: &Entry| match entry.motion {
            EntryMotion::Point(point) => f64::from(point.position) / 256.0,
            EntryMotion::Jerk(_) | EntryMotion::Cubic(_) => f64::NAN,
        };
        for (x, y) in x.iter().zip(&y) {
            let distance = (counts(x) + radius).hypot(counts(y));
            assert!((distance - radius).abs() < 0.01, "{distance}");
        }
        for entries in [&x, &y] {
            let last = entries.last().unwrap();
            let rest = Point::default();
            assert_eq!((last.motion, last.notify), (EntryMotion::Point(rest), true));
            // Velocities equal the differences of the positions, except for their rounding.
            for pair in entries[..entries.len() - 1].windows(2) {
                let [EntryMotion::Point(before), EntryMotion::Point(now)] = [pair[0].motion, pair[1].motion] else {
                    panic!("only points are planned");
                };
                let step = f64::from(now.position - before.position) / 256.0;
                assert!((step - f64::from(now.velocity) / 65536.0).abs() < 0.005);
            }
        }
    }

    #[test]
    fn moves_that_do_not_fit_are_errors() {
        let limits = |velocity, acceleration, jerk| TickLimits {
            velocity,
            acceleration,
            jerk,
        };
        assert!(matches!(
            plan_move(0, 1, &limits(0.0, 1.0, 1.0)),
            Err(PlanError::Profile(_))
        ));
        let creep = limits(1e-12, 1e-12, 1e-12);
        assert!(matches!(plan_move(0, i32::MAX, &creep), Err(PlanError::TooLong { .. })));
        let sudden = limits(1e9, 1e9, 1e9);
        assert!(matches!(
            plan_move(i64::MIN, i32::MAX, &sudden),
            Err(PlanError::Jerk { .. })
        ));
        assert!(plan_circle([0, 0], 1e12, 1.0, &limits(1e9, 1e9, 1e9)).is_err());
        assert!(matches!(
            plan_circle([0, 0], 1e6, 1e9, &stage()),
            Err(PlanError::Points { .. })
        ));
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            assert!(plan_move(0, 9, &limits(bad, 1.0, 1.0)).is_err());
            assert!(plan_circle([0, 0], 1e3, 1.0, &limits(1.0, bad, 1.0)).is_err());
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(plan_circle([0, 0], bad, 1.0, &stage()).is_err());
        }
    }
}
