//! The integrator and the planner in C compared with the model's arithmetic.

use crate::driver::support::{Driver, beside};
use posicast_blocks::segments::{ACCELERATION_BITS, CUBIC, CubicEntry, Entry, EntryMotion, Integrator, Point};
use std::io::Write;
use std::process::{Command, Stdio};

/// Returns the program's numeric answers to these lines.
fn answers(driver: &Driver, input: &str) -> Vec<Vec<i64>> {
    let program = driver.program("integers", &["-DPOSICAST_ACCESS_FUNCTIONS"], &[beside("integers.c")]);
    let mut child = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut to = child.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || to.write_all(input.as_bytes()).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success(), "{}", output.status);
    let text = String::from_utf8(output.stdout).unwrap();
    let numbers = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect();
    text.lines().map(numbers).collect()
}

/// Returns a state as the program prints it.
fn shown(fits: bool, at: &Integrator) -> Vec<i64> {
    let words = at.rounded().map(i64::from);
    [
        vec![fits.into(), at.position, at.velocity, at.acceleration],
        words.to_vec(),
    ]
    .concat()
}

/// A generator of numbers that are small, large and at the ends.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        // xorshift64
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Returns a two's complement number of up to this many bits, as often short as long.
    fn signed(&mut self, bits: u32) -> i64 {
        let length = self.next() % u64::from(bits) + 1;
        (self.next() as i64) >> (64 - length)
    }
}

#[test]
fn prop_the_integrator_in_c_gives_the_integers_of_the_model() {
    let mut numbers = Numbers(7);
    let (mut input, mut expected) = (String::new(), Vec::new());
    let mut at = Integrator::default();
    let (mut overflows, mut ends) = (0, 0);
    for case in 0..3000 {
        let ticks = numbers.next() % 20 + 1;
        let motion = match numbers.next() % 8 {
            0 => {
                let counts = numbers.signed(32);
                // In C a position is a word of the command: Q24.8.
                at = Integrator {
                    position: counts << 24,
                    ..Integrator::default()
                };
                input += &format!("0 {counts}\n");
                continue;
            }
            1 => {
                let deceleration = numbers.signed(ACCELERATION_BITS).abs();
                input += &format!("s {deceleration} {ticks}\n");
                for _ in 0..ticks {
                    at.stop(deceleration);
                    expected.push(shown(true, &at));
                }
                continue;
            }
            2 => EntryMotion::Point(Point {
                position: numbers.signed(32) as i32,
                velocity: numbers.signed(32) as i32,
                acceleration: numbers.signed(32) as i32,
            }),
            4 => EntryMotion::Cubic(CubicEntry {
                jerk: numbers.signed(32) as i32,
                velocity: numbers.signed(32) as i32,
                acceleration: numbers.signed(32) as i32,
            }),
            3 if case % 2 == 0 => EntryMotion::Jerk([(1 << 39) - 1, -(1 << 39)][numbers.next() as usize % 2]),
            _ => EntryMotion::Jerk(numbers.signed(ACCELERATION_BITS)),
        };
        let [w0, w1, w2, w3] = Entry {
            ticks: ticks as u32,
            motion,
            notify: false,
        }
        .words();
        input += &format!("e {w0} {w1} {w2} {w3} {ticks}\n");
        for tick in 0..ticks {
            let fits = at.play(&motion, tick == 0).is_ok();
            overflows += u32::from(!fits);
            ends += u32::from(at.rounded().contains(&i32::MAX));
            expected.push(shown(fits, &at));
        }
    }
    assert!(overflows > 100 && ends > 0, "{overflows} {ends}");
    let found = answers(&Driver::write(), &input);
    assert_eq!(found.len(), expected.len());
    for (line, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(found, expected, "line {line}");
    }
}

/// Moves of the planner, played by the model, end on target, at rest, within the limits.
#[test]
fn prop_a_plan_in_c_ends_at_rest_on_target_within_its_limits() {
    // The limits of the XY stage, of a slow machine, of one that reaches its velocity before its acceleration, and of
    // one that jumps.
    let limits: [[i64; 3]; 5] = [
        [107_374_182_400, 343_597_383, 1_717_986],
        [4_294_967, 42_949, 4_294],
        [1 << 30, 1 << 36, 1 << 28],
        [1 << 46, 1 << 38, 1 << 38],
        [1 << 40, 1 << 20, 1 << 30],
    ];
    let ways = [1, -1, 3, 200, -300, 5_000, 51_200, -1_000_003, 123_456_789, i32::MAX];
    let mut input = String::new();
    let mut cases = Vec::new();
    for limits in limits {
        for way in ways {
            let start = if way < 0 { 5000 } else { -17 };
            let end = i32::saturating_add(start, way);
            let [velocity, acceleration, jerk] = limits;
            input += &format!("m {start} {end} {velocity} {acceleration} {jerk}\n");
            cases.push((start, end, limits));
        }
    }
    let found = answers(&Driver::write(), &input);
    let mut lines = found.iter();
    let mut too_long = 0;
    for (start, end, limits) in cases {
        let head = lines.next().unwrap();
        if head[0] == 6 {
            too_long += 1;
            continue;
        }
        assert_eq!(head[0], 0, "{start} to {end}: {head:?}");
        let mut at = Integrator {
            position: i64::from(start) << 24,
            ..Integrator::default()
        };
        let mut largest = [0i64; 3];
        for entry in 0..head[1] {
            let words = lines.next().unwrap();
            let last = entry + 1 == head[1];
            let ticks = words[3] & 0xff_ffff;
            assert_eq!((words[3] >> 31 & 1 == 1, words[3] >> 30 & 1 == 1), (last, last));
            if last {
                // The segments leave less than half an LSB of the command word, and nothing moves.
                let missing = (i64::from(end) << 24) - at.position;
                assert!(
                    at.at_rest() && missing.abs() < 1 << 23,
                    "{start} to {end}, {limits:?}: {missing}"
                );
                let point = Point {
                    position: end,
                    ..Point::default()
                };
                assert_eq!(&words[..3], [i64::from(end as u32), 0, 0]);
                at = Integrator::at_point(&point);
            } else {
                let jerk = words[0] | i64::from(words[1] as u32 as i32) << 32;
                for _ in 0..ticks {
                    at.jerk(jerk).unwrap();
                    let now = [at.velocity, at.acceleration, jerk];
                    largest = [0, 1, 2].map(|k: usize| largest[k].max(now[k].abs()));
                }
            }
            // The program reached the same state by itself.
            assert_eq!(lines.next().unwrap(), &shown(true, &at));
        }
        for (found, limit) in largest.into_iter().zip(limits) {
            // Corrections add some LSB of jerk.
            assert!(
                found as f64 <= limit as f64 * 1.001 + 64.0,
                "{start} to {end}: {found} above {limit}"
            );
        }
    }
    assert_eq!(lines.next(), None);
    assert!(too_long < 10, "{too_long}");
}

/// Points of a path that a controller computes become entries that the model plays: each point is reached, with its
/// velocity if one was requested, and a cubic begins where the previous one ended.
#[test]
fn prop_a_stream_meets_its_points_and_a_cubic_does_not_jump() {
    let period = 10;
    // 0.1 m/s at 1 um per count and 10 kHz, up and down at 5 Hz: up to 3 counts per tick.
    let way = |time: f64| 1000.0 * (1.0 - (std::f64::consts::TAU * time / 2000.0).cos());
    let velocity = |time: f64| 1000.0 * std::f64::consts::TAU / 2000.0 * (std::f64::consts::TAU * time / 2000.0).sin();
    let end = 200;
    let points: Vec<(i32, i32)> = (1..=end)
        .map(|nth| f64::from((nth * period).min(2000)))
        .map(|time| {
            (
                (256.0 * way(time)).round() as i32,
                (65_536.0 * velocity(time)).round() as i32,
            )
        })
        .chain([(0, 0)])
        .collect();
    for order in 0..3 {
        let lines = points
            .iter()
            .map(|(position, velocity)| format!("p {position} {velocity} {period} {order}\n"));
        let found = answers(&Driver::write(), &("0 0\n".to_owned() + &lines.collect::<String>()));
        assert_eq!(found.len(), 3 * points.len());
        let mut at = Integrator::default();
        let mut largest_jump = 0;
        for (said, (position, velocity)) in found.chunks(3).zip(&points) {
            assert_eq!(said[0], [0]);
            let words = said[1].iter().map(|word| *word as u32 as i32);
            let [jerk, first, acceleration, _] = words.collect::<Vec<_>>().try_into().unwrap();
            assert_eq!(said[1][3], i64::from(CUBIC) + i64::from(period));
            let before = at;
            let cubic = CubicEntry {
                jerk,
                velocity: first,
                acceleration,
            };
            for tick in 0..period {
                at.play(&EntryMotion::Cubic(cubic), tick == 0).unwrap();
            }
            assert_eq!(said[2], shown(true, &at));
            let missed = at.position - (i64::from(*position) << 24);
            assert!(missed.abs() <= i64::from(period) << 15, "{order}: {missed}");
            // This is the last velocity, with the rounding of the first one and of the acceleration: 2^-16 counts per
            // tick.
            let slower = at.velocity - (i64::from(*velocity) << 16);
            assert!(order == 0 || slower.abs() <= 1 << 16, "{order}: {slower}");
            // This is the jump from the end of an entry to the beginning of the next, beyond the acceleration.
            let jump = (i64::from(first) << 16) - before.velocity - (i64::from(acceleration) << 8);
            largest_jump = largest_jump.max(jump.abs());
        }
        assert_eq!(at.velocity, 0, "{order}: at rest at the end");
        // A line jumps by the change of the path's velocity in a period, a cubic by its rounding.
        assert_eq!(order == 2, largest_jump <= 1 << 16, "{order}: {largest_jump}");
    }
}

#[test]
fn points_that_no_entry_reaches_are_refused() {
    // Refused are no ticks and too many, and points that need a larger velocity or acceleration than the words hold.
    // Across the end of the position's word, a point is near.
    let input = "p 0 0 0 0\np 0 0 257 0\np 2000000000 0 1 0\np 0 2147483647 2 2\n0 -2147482648\np 2147482647 0 2 0\n";
    let found = answers(&Driver::write(), input);
    let results: Vec<&[i64]> = found[..5].iter().map(Vec::as_slice).collect();
    assert_eq!(results, [[3], [3], [3], [3], [0]]);
}

#[test]
fn invalid_limits_are_refused() {
    let input = "m 0 256 0 1 1\nm 0 256 1 -1 1\nm 0 256 1 1 0\nm 5 5 1 1 1\n";
    let found = answers(&Driver::write(), input);
    assert_eq!(found, [[3, 0], [3, 0], [3, 0], [0, 0]]);
}
