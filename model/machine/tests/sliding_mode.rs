//! The controller: golden vectors, floating against fixed point, clocks against ticks, and closed loops on a mass
//! with friction.

use posicast_blocks::sliding_mode::{
    CONTROL_CLOCKS, Gain, Inputs, Law, Outputs, SettingRow, Settings, SlidingMode, TickController, TickMotion,
};
use posicast_machine::control::{FloatController, Gains, Tracking};
use proptest::prelude::*;
use serde_json::Value;

/// Returns the golden coefficients in mA.
fn golden_gains(coefficients: &Value, clamp_ma: f64) -> Gains {
    let of = |key: &str| coefficients[key].as_f64().unwrap();
    let per_acceleration = of("gain_mA_per_count_per_T2");
    Gains::default().with(&[
        (SettingRow::Surface, of("cT")),
        (SettingRow::Boundary, 1.0 / of("phiT_counts")),
        (SettingRow::Damping, of("cT")),
        (SettingRow::Reaching, of("kT")),
        (SettingRow::Switching, of("epsT2_counts")),
        (SettingRow::Feedback, per_acceleration),
        (SettingRow::Acceleration, per_acceleration),
        (SettingRow::Viscous, of("visc_mA_per_count_per_T")),
        (SettingRow::Limit, clamp_ma),
    ])
}

#[test]
fn golden_vectors_within_a_milliampere() {
    let text = include_str!("golden/sliding_mode.json");
    let golden: Value = serde_json::from_str(text).unwrap();
    let golden = &golden["smc_fixed_vectors"];
    let settings = golden_gains(&golden["coeffs"], golden["clamp_mA"].as_f64().unwrap())
        .quantise()
        .unwrap();
    let vectors = golden["vectors"].as_array().unwrap();
    assert_eq!(vectors.len(), 8);
    for vector in vectors {
        let of = |key: &str| vector[key].as_i64().unwrap();
        let acceleration = of("r_n") - 2 * of("r_nm1") + of("r_nm2");
        let motion = TickMotion {
            position_reference: (of("r_n") << 8) as i32,
            velocity_reference: ((of("r_n") - of("r_nm1")) << 16) as i32,
            // One vector jumps by 500 counts, which a word does not hold: it is clamped like any other.
            acceleration_reference: (acceleration << 24).clamp(i32::MIN.into(), i32::MAX.into()) as i32,
            position: of("x_n") as i32,
            velocity: ((of("x_n") - of("x_nm1")) << 16) as i32,
        };
        let shown = TickController::default().control(Law::SlidingMode, false, &motion, &settings);
        let (sliding, command) = (f64::from(shown.sliding) / 65_536.0, f64::from(shown.command) / 4096.0);
        assert!(
            (sliding - vector["s_counts_per_T"].as_f64().unwrap()).abs() < 1e-3,
            "{vector}: {sliding}"
        );
        assert!(
            (command - vector["u_mA"].as_f64().unwrap()).abs() < 1.0,
            "{vector}: {command}"
        );
    }
}

fn law() -> impl Strategy<Value = Law> {
    prop_oneof![Just(Law::SlidingMode), Just(Law::Pd), Just(Law::Pid)]
}

/// Returns gains of any sign over four decades, such that no word but the command saturates.
fn moderate_gains() -> impl Strategy<Value = Gains> {
    let signed = |size: f64| {
        (prop::bool::ANY, -4.0..0.0f64).prop_map(move |(negative, power)| {
            let value = size * 10f64.powf(power);
            if negative { -value } else { value }
        })
    };
    let laws = [
        signed(0.5),
        signed(2.0),
        signed(1.0),
        signed(1.0),
        signed(10.0),
        signed(1.0),
    ];
    let linear = [signed(1.0), signed(1.0), signed(0.01)];
    let command = [signed(50.0), signed(20_000.0), signed(5.0), signed(5.0), signed(100.0)];
    (laws, linear, command, 1.0..400_000.0f64).prop_map(|(laws, linear, command, limit)| {
        let [surface, boundary, damping, reaching, switching, fade] = laws;
        let [derivative, proportional, integral] = linear;
        let [feedback, acceleration, velocity, viscous, coulomb] = command;
        Gains::default().with(&[
            (SettingRow::Surface, surface),
            (SettingRow::Boundary, boundary),
            (SettingRow::Damping, damping),
            (SettingRow::Reaching, reaching),
            (SettingRow::Switching, switching),
            (SettingRow::Fade, fade),
            (SettingRow::Derivative, derivative),
            (SettingRow::Proportional, proportional),
            (SettingRow::Integral, integral),
            (SettingRow::Feedback, feedback),
            (SettingRow::Acceleration, acceleration),
            (SettingRow::Velocity, velocity),
            (SettingRow::Viscous, viscous),
            (SettingRow::Coulomb, coulomb),
            (SettingRow::Limit, limit),
            (SettingRow::Duty, 0.1),
        ])
    })
}

/// Returns motion with e up to 20 counts and velocities that differ by up to 10 counts/T.
fn moderate_motion() -> impl Strategy<Value = TickMotion> {
    let small = 20i32 << 16;
    (
        -5000..5000i32,
        -20 * 256..20 * 256i32,
        -small..small,
        -small / 4..small / 4,
        -(1 << 23)..1 << 23,
    )
        .prop_map(
            |(position, error, velocity, error_rate, acceleration_reference)| TickMotion {
                position_reference: position * 256 + error,
                velocity_reference: velocity + error_rate,
                acceleration_reference,
                position,
                velocity,
            },
        )
}

fn tracking(motion: &TickMotion) -> Tracking {
    let count = |value: i32| f64::from(value) / 65_536.0;
    Tracking {
        error: f64::from(motion.position_reference - motion.position * 256) / 256.0,
        error_rate: count(motion.velocity_reference) - count(motion.velocity),
        velocity_reference: count(motion.velocity_reference),
        acceleration_reference: f64::from(motion.acceleration_reference) / 16_777_216.0,
        velocity: count(motion.velocity),
    }
}

/// Returns the bound of the datasheet: how far the fixed-point command may be from the floating-point one, in command
/// units. `gains` are wanted, the hardware has `actual`; `integral` is ∫e in counts·T.
fn command_bound(gains: &Gains, actual: &Gains, motion: &Tracking, law: Law, integral: f64) -> f64 {
    // The error of a product is the rounding of its gain times the operand, plus the rounding of the operand times
    // the gain.
    let product = |row: SettingRow, operand: f64, lost: f64| {
        (gains.get(row) - actual.get(row)).abs() * (operand.abs() + lost) + gains.get(row).abs() * lost
    };
    let Tracking { error, error_rate, .. } = *motion;
    let sliding = error_rate.abs() + gains.get(SettingRow::Surface).abs() * error.abs();
    let sliding_lost = product(SettingRow::Surface, error, 0.0) + 0.5 / 65_536.0;
    let fraction_lost = |row, operand, lost| product(row, operand, lost) + 1.5 / 33_554_432.0;
    let third = 3.0 * 0.5 / 16_777_216.0;
    let (feedback, feedback_lost) = match law {
        Law::SlidingMode => (
            gains.get(SettingRow::Damping).abs() * error_rate.abs()
                + gains.get(SettingRow::Reaching).abs() * sliding
                + gains.get(SettingRow::Switching).abs(),
            product(SettingRow::Damping, error_rate, 0.0)
                + product(SettingRow::Reaching, sliding, sliding_lost)
                + product(
                    SettingRow::Switching,
                    1.0,
                    fraction_lost(SettingRow::Boundary, sliding, sliding_lost),
                )
                + third,
        ),
        _ => (
            gains.get(SettingRow::Derivative).abs() * error_rate.abs()
                + gains.get(SettingRow::Proportional).abs() * error.abs()
                + gains.get(SettingRow::Integral).abs() * integral.abs(),
            product(SettingRow::Derivative, error_rate, 0.0)
                + product(SettingRow::Proportional, error, 0.0)
                + product(SettingRow::Integral, integral, 0.0)
                + third,
        ),
    };
    product(SettingRow::Feedback, feedback, feedback_lost)
        + product(SettingRow::Acceleration, motion.acceleration_reference, 0.0)
        + product(SettingRow::Velocity, motion.velocity_reference, 0.0)
        + product(SettingRow::Viscous, motion.velocity, 0.0)
        + product(
            SettingRow::Coulomb,
            1.0,
            fraction_lost(SettingRow::Fade, motion.velocity_reference, 0.0),
        )
        + 6.0 * 0.5 / 4096.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn prop_fixed_point_stays_within_its_bound_of_the_float_law(
        law in law(),
        gains in moderate_gains(),
        motions in prop::collection::vec(moderate_motion(), 1..6),
    ) {
        let settings = gains.quantise().unwrap();
        let actual = Gains::of_settings(&settings);
        let (mut fixed, mut float) = (TickController::default(), FloatController::default());
        let mut integral = 0.0f64;
        for motion in motions {
            let seen = tracking(&motion);
            let shown = fixed.control(law, false, &motion, &settings);
            let wanted = float.control(law, &gains, &seen);
            let command = f64::from(shown.command) / 4096.0;
            let bound = command_bound(&gains, &actual, &seen, law, integral);
            prop_assert!((command - wanted.command).abs() <= bound, "{command} {wanted:?} {bound}");
            prop_assert_eq!((shown.saturated_high | shown.saturated_low) & !(1 << 5), 0);
            // Right at the limit the two may freeze the integral differently.
            let limited = i8::from(shown.limited_high) - i8::from(shown.limited_low);
            if limited != wanted.limited {
                break;
            }
            integral += seen.error.abs();
        }
    }

    #[test]
    fn prop_a_pass_is_a_tick(
        words in prop::collection::vec(any::<[i32; 5]>(), 1..5),
        shifts in any::<[u8; 5]>(),
        memory in any::<[u32; 16]>(),
        laws in any::<[u8; 5]>(),
        modulo: bool,
    ) {
        let settings = Settings(memory);
        let (mut clocked, mut fast) = (SlidingMode::new(), TickController::default());
        for (tick, word) in words.iter().enumerate() {
            let sized = |at: usize| word[at] >> (shifts[at] % 32);
            let motion = TickMotion {
                position_reference: sized(0),
                velocity_reference: sized(1),
                acceleration_reference: sized(2),
                position: sized(3),
                velocity: sized(4),
            };
            let mut inputs = Inputs { start: true, law: laws[tick], modulo, ..motion.into() };
            let mut clocks = 0;
            let shown = loop {
                let address = clocked.outputs().setting_address;
                let shown = clocked.step(&inputs);
                if shown.valid && clocks > 0 {
                    break shown;
                }
                clocks += 1;
                inputs = Inputs { start: false, setting: settings.word(usize::from(address)), ..inputs };
            };
            prop_assert_eq!(clocks, CONTROL_CLOCKS);
            // The flag of a limited duty shows one clock after it.
            let Outputs { saturated_high, saturated_low, .. } = clocked.outputs();
            let shown = Outputs { saturated_high, saturated_low, ..shown };
            let expected = fast.control(Law::from_bits(laws[tick]), modulo, &motion, &settings);
            // The law is held until the next start, and with it the address of step 0, which is 0.
            prop_assert_eq!(shown, expected);
        }
    }

    #[test]
    fn prop_e_is_the_nearest_difference(reference: i32, position: i32) {
        let motion = TickMotion { position_reference: reference, position, ..TickMotion::default() };
        let error = |modulo| {
            let mut controller = TickController::default();
            i64::from(controller.control(Law::Pd, modulo, &motion, &Settings::default()).error) >> 8
        };
        let clamp = |difference: i64| difference.clamp(-(1 << 23), (1 << 23) - 1);
        let turn = 1i64 << 32;
        let plain = i64::from(reference) - (i64::from(position) << 8);
        let wrapped = (plain + turn / 2).rem_euclid(turn) - turn / 2;
        prop_assert_eq!(error(true), clamp(wrapped));
        let turn = 1i64 << 40;
        prop_assert_eq!(error(false), clamp((plain + turn / 2).rem_euclid(turn) - turn / 2));
    }
}

#[test]
fn at_rest_on_the_reference_nothing_is_commanded() {
    // sgn(0) = 0: neither the boundary layer nor the Coulomb term, however steep, gives a command.
    let mut settings = Settings::default();
    for row in SettingRow::ALL {
        settings.set_gain(row, Gain::nearest(f64::from(row.exponent() + 16).exp2(), row).unwrap());
    }
    settings.set_limit(u32::MAX);
    let motion = TickMotion {
        position_reference: -77 << 8,
        position: -77,
        ..TickMotion::default()
    };
    let shown = TickController::default().control(Law::SlidingMode, false, &motion, &settings);
    assert_eq!((shown.command, shown.duty, shown.sliding), (0, 0, 0));
}

#[test]
fn the_integral_freezes_against_the_limit_and_survives_a_change_of_law() {
    let gains = Gains::default().with(&[
        (SettingRow::Integral, 0.01),
        (SettingRow::Feedback, 1.0),
        (SettingRow::Limit, 1.0),
    ]);
    let settings = gains.quantise().unwrap();
    let mut controller = TickController::default();
    let mut tick = |law, error: i32| {
        let motion = TickMotion {
            position_reference: error << 8,
            ..TickMotion::default()
        };
        f64::from(controller.control(law, false, &motion, &settings).command) / 4096.0
    };
    // 10 counts per tick add 0.1 each; the limit is exceeded at the 11th sum and frozen there.
    let wound: Vec<f64> = (0..100).map(|_| tick(Law::Pid, 10)).collect();
    assert!((wound[5] - 0.5).abs() < 2e-3, "{wound:?}");
    assert_eq!(wound[99], 1.0);
    // Another law does not change the integral.
    for _ in 0..50 {
        assert_eq!(tick(Law::Pd, -10), 0.0);
        tick(Law::SlidingMode, 500);
    }
    // It leaves the limit at once, not after 90 ticks.
    let back: Vec<f64> = (0..4).map(|_| tick(Law::Pid, -10)).collect();
    assert!(back[0] == 1.0 && (back[3] - 0.8).abs() < 3e-3, "{back:?}");
}
