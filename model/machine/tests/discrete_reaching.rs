//! Sliding mode from tick to tick, compared with the golden recursion of the reaching law,
//! `s[n+1] = s[n] − T (ε sgn s[n] + k s[n])`.
//!
//! On a mass whose error goes on by its rate of the tick before, `e[n+1] = e[n] + T e′[n]` and
//! `e′[n+1] = e′[n] − T a[n]`, the recursion is exact: the term `c e′` of the law cancels the slope of the line.

use posicast_blocks::sliding_mode::{Law, Saturation, SettingRow, Settings, TickController, TickMotion};
use posicast_machine::control::{FloatController, Gains, Tracking};
use serde_json::Value;

/// Slope of the line in 1/s.
const SLOPE: f64 = 150.0;
/// Current in mA per count/T², so that the command has many bits.
const PER_ACCELERATION: f64 = 1000.0;
/// Length of a count in m: coarse enough that an acceleration of 200 m/s² at 1 kHz is within its word.
const COUNT_M: f64 = 4e-6;
/// Steepness of the layer that stands for the sign, per count/T.
const SIGN: f64 = 255.0;

/// A case of the golden file.
struct Case {
    tick_s: f64,
    epsilon: f64,
    rate: f64,
    start: f64,
    first: Vec<f64>,
    limit: f64,
}

fn cases() -> Vec<Case> {
    let golden: Value = serde_json::from_str(include_str!("golden/drive.json")).unwrap();
    let cases = golden["smc_discrete"].as_array().unwrap();
    let case = |case: &Value| {
        let of = |key: &str| case[key].as_f64().unwrap();
        let first = case["first8"].as_array().unwrap();
        Case {
            tick_s: of("T"),
            epsilon: of("eps"),
            rate: of("k"),
            start: of("s0"),
            first: first.iter().map(|s| s.as_f64().unwrap()).collect(),
            limit: of("limit"),
        }
    };
    cases.iter().map(case).collect()
}

impl Case {
    fn gains(&self, count_m: f64) -> Gains {
        Gains::default().with(&[
            (SettingRow::Surface, SLOPE * self.tick_s),
            (SettingRow::Damping, SLOPE * self.tick_s),
            (SettingRow::Reaching, self.rate * self.tick_s),
            (SettingRow::Switching, self.epsilon * self.tick_s.powi(2) / count_m),
            (SettingRow::Boundary, SIGN),
            (SettingRow::Feedback, PER_ACCELERATION),
            (SettingRow::Limit, 500_000.0),
        ])
    }

    /// The first values of s, and then the last one, in m/s.
    fn run(&self, count_m: f64, mut command: impl FnMut(f64, f64) -> f64) -> (Vec<f64>, f64) {
        let per_count = count_m / self.tick_s;
        // From rest beside the line, so that the term c e′ is small at first.
        let (mut error, mut rate) = (self.start / SLOPE / count_m, 0.0);
        let mut found = Vec::new();
        let ticks = (12.0 / (self.rate * self.tick_s)) as usize;
        for _ in 0..ticks {
            let acceleration = command(error, rate) / PER_ACCELERATION;
            (error, rate) = (error + rate, rate - acceleration);
            found.push((rate + SLOPE * self.tick_s * error) * per_count);
        }
        let last = found[ticks - 1];
        found.truncate(self.first.len());
        (found, last)
    }

    fn assert_is(&self, (found, last): &(Vec<f64>, f64), tolerance: f64) {
        for (found, expected) in found.iter().zip(&self.first) {
            assert!(
                (found - expected).abs() < tolerance,
                "T = {}: {found} in place of {expected}",
                self.tick_s
            );
        }
        assert!(
            (last.abs() - self.limit).abs() < tolerance,
            "T = {}: {last} in place of {}",
            self.tick_s,
            self.limit
        );
    }
}

/// The hardware's command, and the flags of words that were too small.
fn bit_exact(settings: &Settings, flags: &mut u8) -> impl FnMut(f64, f64) -> f64 {
    let mut controller = TickController::default();
    move |error, rate| {
        let motion = TickMotion {
            position_reference: (error * 256.0).round() as i32,
            velocity_reference: (rate * 65_536.0).round() as i32,
            ..TickMotion::default()
        };
        let shown = controller.control(Law::SlidingMode, false, &motion, settings);
        *flags |= shown.saturated_high | shown.saturated_low;
        f64::from(shown.command) / 4096.0
    }
}

#[test]
fn golden_the_float_law_reaches_the_line_as_computed_elsewhere() {
    for case in cases() {
        let gains = case.gains(COUNT_M);
        let mut controller = FloatController::default();
        let found = case.run(COUNT_M, |error, error_rate| {
            let motion = Tracking {
                error,
                error_rate,
                ..Tracking::default()
            };
            controller.control(Law::SlidingMode, &gains, &motion).command
        });
        case.assert_is(&found, 1e-5);
    }
}

#[test]
fn golden_the_hardware_reaches_the_line_as_computed_elsewhere() {
    let cases = cases();
    assert_eq!(cases.len(), 4);
    for case in cases {
        let (settings, mut flags) = (case.gains(COUNT_M).quantise().unwrap(), 0);
        let found = case.run(COUNT_M, bit_exact(&settings, &mut flags));
        case.assert_is(&found, 1e-4);
        assert_eq!(flags, 0, "T = {}: no word saturates", case.tick_s);
    }
}

/// At 1 kHz and counts of 1 µm the law asks for 200 counts/T² at first, and its word holds 128: s falls by 0.128 m/s in
/// place of 0.2, and the flag says why.
#[test]
fn golden_counts_that_are_too_fine_saturate_the_feedback_and_say_so() {
    let case = &cases()[0];
    let (settings, mut flags) = (case.gains(1e-6).quantise().unwrap(), 0);
    let (found, _) = case.run(1e-6, bit_exact(&settings, &mut flags));
    assert!((found[0] - (case.start - 0.128)).abs() < 1e-4, "{}", found[0]);
    assert_eq!(flags, Saturation::Feedback.bit());
}
