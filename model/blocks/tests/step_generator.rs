//! The step generator against independent arithmetic: what a drive reads from its lines, and exact fractions of the time.

use posicast_blocks::step_generator::{
    Inputs, LATENCY_CLOCKS, Outputs, StepGenerator, StepGeneratorConfig, StepGeneratorConfigError, StepMode, StepTimes,
    StepTimesInSeconds, ideal_steps,
};
use proptest::prelude::*;

const TIMES: StepTimes = StepTimes {
    pulse_clocks: 3,
    space_clocks: 4,
    direction_setup_clocks: 20,
    direction_hold_clocks: 10,
};

fn config(tick_clocks: u64, fraction_bits: u32, mode: StepMode) -> StepGeneratorConfig {
    StepGeneratorConfig::new(tick_clocks, fraction_bits, mode, TIMES, 1000).unwrap()
}

/// A drive: it knows only its two lines.
struct Drive {
    mode: StepMode,
    a: bool,
    b: bool,
    steps: i128,
}

impl Drive {
    /// Reads the lines of a clock; returns the step in them, +1, −1 or 0.
    fn reads(&mut self, shown: Outputs) -> i128 {
        let (rises_a, rises_b) = (shown.a && !self.a, shown.b && !self.b);
        let step = match self.mode {
            StepMode::StepDirection if rises_a => {
                if shown.b {
                    1
                } else {
                    -1
                }
            }
            StepMode::StepDirection => 0,
            StepMode::UpDown => i128::from(rises_a) - i128::from(rises_b),
            // A leads B upwards: B, A = 00, 01, 11, 10.
            StepMode::Quadrature => match (self.b, self.a, shown.b, shown.a) {
                (false, false, false, true)
                | (false, true, true, true)
                | (true, true, true, false)
                | (true, false, false, false) => 1,
                (false, true, false, false)
                | (true, true, false, true)
                | (true, false, true, true)
                | (false, false, true, false) => -1,
                (b, a, new_b, new_a) if (a, b) == (new_a, new_b) => 0,
                _ => panic!("both lines at once"),
            },
        };
        (self.a, self.b) = (shown.a, shown.b);
        self.steps += step;
        step
    }
}

/// ⌊p + 1/2⌋ of a position in units of 2^−bits.
fn rounded(position: i128, bits: u32) -> i128 {
    (2 * position + (1 << bits)).div_euclid(2 << bits)
}

/// Runs the positions, one per tick; returns the clock and sign of every step, and what the drive has read.
fn run(config: &StepGeneratorConfig, positions: &[i32], extra_clocks: u64) -> (Vec<(u64, i128)>, i128) {
    let tick_clocks = u64::from(config.tick_clocks());
    let mut generator = StepGenerator::new(config);
    let mut drive = Drive {
        mode: config.mode(),
        a: false,
        b: false,
        steps: 0,
    };
    let mut steps = Vec::new();
    for clock in 0..(positions.len() as u64) * tick_clocks + extra_clocks {
        let at = (clock / tick_clocks) as usize;
        let tick = clock % tick_clocks == 0 && at < positions.len();
        let position = if tick { positions[at] } else { 0x5a5a };
        let shown = generator.step(&Inputs {
            enable: true,
            tick,
            position,
            ..Inputs::default()
        });
        let step = drive.reads(shown);
        assert_eq!(drive.steps, i128::from(shown.count), "clock {clock}");
        assert!(!shown.too_fast && !shown.owed_exceeded, "clock {clock}");
        if step != 0 {
            steps.push((clock, step));
        }
    }
    (steps, drive.steps)
}

#[test]
fn every_edge_is_at_its_ideal_time_within_a_clock() {
    for mode in [StepMode::StepDirection, StepMode::UpDown, StepMode::Quadrature] {
        let config = config(997, 8, mode);
        // The first step waits for the direction. Then upwards only, at every speed up to the largest, so that nothing
        // has to wait.
        let mut positions = vec![37_i32, 37 + 256, 37 + 256];
        let mut position = 37 + 256;
        for tick in 0..400_u32 {
            let share = u64::from(tick.wrapping_mul(2_654_435_761));
            position += ((share * u64::from(config.largest_difference())) >> 32) as i32;
            positions.push(position);
        }
        let (steps, _) = run(&config, &positions, 2000);
        let mut seen = steps.into_iter().skip(1);
        for (at, pair) in positions.windows(2).enumerate().skip(2) {
            let [from, to] = [pair[0], pair[1]].map(i128::from);
            let mut ideal = ideal_steps(&config, pair[0].into(), pair[1].into());
            for step in rounded(from, 8)..rounded(to, 8) {
                // The line comes to step + 1/2 after (step + 1/2 − from) · T / (to − from) clocks of this tick.
                let (dividend, divisor) = (((2 * step + 1) * 256 - 2 * from) * 997, 2 * (to - from));
                let stated = ideal.next().unwrap();
                assert!(stated.up);
                assert_eq!(
                    i128::from(stated.dividend) * divisor,
                    dividend * i128::from(stated.divisor)
                );
                let (clock, sign) = seen.next().unwrap();
                let since = i128::from(clock) - (at as i128 + 1) * 997 - i128::from(LATENCY_CLOCKS);
                assert_eq!(sign, 1);
                let late = since * divisor - dividend;
                assert!(
                    (0..divisor).contains(&late),
                    "{mode:?}, tick {at}: {late} of {divisor} of a clock"
                );
                assert_eq!(since, i128::from(stated.demanded_clocks()));
            }
            assert_eq!(ideal.next(), None, "{mode:?}, tick {at}");
        }
    }
}

#[test]
fn two_million_steps_per_second_at_50_mhz() {
    let times = StepTimes {
        pulse_clocks: 12,
        space_clocks: 13,
        direction_setup_clocks: 250,
        direction_hold_clocks: 25,
    };
    for mode in [StepMode::StepDirection, StepMode::UpDown, StepMode::Quadrature] {
        let config = StepGeneratorConfig::new(5000, 8, mode, times, 100).unwrap();
        assert_eq!(config.largest_difference(), 200 * 256);
        // From rest to the largest rate at once, 200 steps per tick for 40 ticks. The first direction may have to be set.
        let positions: Vec<i32> = [0, 256, 256]
            .into_iter()
            .chain((1..=40).map(|at| 256 + at * 200 * 256))
            .collect();
        let (steps, read) = run(&config, &positions, 6000);
        assert_eq!(read, 1 + 40 * 200);
        assert!(steps.iter().all(|(_, sign)| *sign == 1));
        let fast: Vec<u64> = steps[1..].iter().map(|(clock, _)| *clock).collect();
        assert!(fast.windows(2).all(|pair| pair[1] - pair[0] == 25), "{mode:?}");
        assert_eq!(fast[fast.len() - 1] - fast[0], (fast.len() as u64 - 1) * 25);
    }
}

#[test]
fn a_line_downwards_passes_each_middle_at_the_stated_time() {
    let config = config(997, 8, StepMode::StepDirection);
    for (from, to) in [(640_i64, -640_i64), (129, 128), (128, 127), (-1000, -30_000), (5, 5)] {
        let stated: Vec<_> = ideal_steps(&config, from, to).collect();
        let middles: Vec<i128> = (rounded(to.into(), 8)..rounded(from.into(), 8)).rev().collect();
        assert_eq!(stated.len(), middles.len(), "{from} to {to}");
        for (step, middle) in stated.iter().zip(middles) {
            // The line falls below middle + 1/2.
            let [from, to] = [from, to].map(i128::from);
            let (dividend, divisor) = ((2 * from - (2 * middle + 1) * 256) * 997, 2 * (from - to));
            assert!(!step.up);
            assert_eq!(i128::from(step.dividend) * divisor, dividend * i128::from(step.divisor));
            assert_eq!(i128::from(step.demanded_clocks()), dividend.div_euclid(divisor) + 1);
        }
    }
}

#[test]
fn nothing_is_lost_in_a_long_walk() {
    let config = config(401, 6, StepMode::StepDirection);
    let largest = i64::from(config.largest_difference());
    let (mut random, mut position, mut positions) = (1_u64, 11_i64, vec![11]);
    for _ in 0..3000 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        position += (random >> 33) as i64 % (largest + 1) * if random >> 62 & 1 == 0 { 1 } else { -1 };
        positions.push(position as i32);
    }
    let (_, steps) = run(&config, &positions, 4000);
    assert_eq!(steps, rounded(position.into(), 6) - rounded(11, 6));
}

#[test]
fn configurations_that_cannot_be_built_are_named() {
    let with = |times| StepGeneratorConfig::new(1000, 8, StepMode::StepDirection, times, 10);
    let pulse = with(StepTimes {
        pulse_clocks: 0,
        ..TIMES
    });
    assert!(matches!(
        pulse,
        Err(StepGeneratorConfigError::Clocks {
            name: "pulse",
            clocks: 0,
            least: 1
        })
    ));
    let built = |ticks, bits, owed| StepGeneratorConfig::new(ticks, bits, StepMode::UpDown, TIMES, owed);
    assert_eq!(built(0, 8, 1), Err(StepGeneratorConfigError::TickClocks(0)));
    assert_eq!(built(1000, 17, 1), Err(StepGeneratorConfigError::FractionBits(17)));
    assert_eq!(built(1000, 8, 0), Err(StepGeneratorConfigError::OwedLimit(0)));
    assert!(matches!(built(6, 0, 1), Err(StepGeneratorConfigError::NoRate { .. })));
    assert!(matches!(
        built(131_071, 16, 1),
        Err(StepGeneratorConfigError::Units { .. })
    ));
    let times = |pulse_s| StepTimesInSeconds {
        pulse_s,
        space_s: 2.5e-6,
        direction_setup_s: 5e-6,
        direction_hold_s: 1.01e-8,
    };
    let rounded_up = StepTimes::from_seconds(times(2.5e-6), 50e6).unwrap();
    assert_eq!(
        (
            rounded_up.pulse_clocks,
            rounded_up.direction_setup_clocks,
            rounded_up.direction_hold_clocks
        ),
        (125, 250, 1)
    );
    assert!(matches!(
        StepTimes::from_seconds(times(-1.0), 50e6),
        Err(StepGeneratorConfigError::Seconds { name: "pulse_s", .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn prop_steps_end_at_the_rounded_position(first: i16, moves in prop::collection::vec(-200_i32..=200, 1..40)) {
        for mode in [StepMode::StepDirection, StepMode::UpDown, StepMode::Quadrature] {
            let config = config(100, 4, mode);
            let mut positions = vec![i32::from(first)];
            positions.extend(moves.iter().scan(i32::from(first), |at, by| { *at += by; Some(*at) }));
            let last = i128::from(positions[positions.len() - 1]);
            let (_, steps) = run(&config, &positions, 2000);
            prop_assert_eq!(steps, rounded(last, 4) - rounded(first.into(), 4));
        }
    }
}
