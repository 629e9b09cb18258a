//! The drive with its screw: that of the XY stage compared with independently computed numbers, and the effects of
//! friction and limits with formulas.

use posicast_machine::plant::drive_train::{
    Amplifier, Contact, DriveTrain, DriveTrainPlant, Friction, Stribeck, TrainState, Winding,
};
use serde_json::Value;

fn golden() -> Value {
    serde_json::from_str(include_str!("golden/drive.json")).unwrap()
}

/// Returns the X axis without friction.
fn stage(amplifier: Amplifier) -> DriveTrain {
    let params = &golden()["drive"]["params"];
    let value = |key: &str| params[key].as_f64().unwrap();
    DriveTrain {
        torque_constant: value("Kt"),
        motor_inertia: value("J"),
        load_mass: value("m"),
        lead_per_radian: value("Pm"),
        stiffness: value("K"),
        damping: value("B"),
        ..DriveTrain::rigid(amplifier)
    }
}

const WINDING: Winding = Winding {
    inductance_h: 0.05,
    resistance_ohm: 1.0,
    back_emf: 0.18,
};
const CURRENT: Amplifier = Amplifier::ProportionalCurrent {
    winding: WINDING,
    current_gain: 2.0,
};
const VELOCITY: Amplifier = Amplifier::Velocity {
    winding: WINDING,
    current_gain: 2.0,
    velocity_gain: 30.0,
};
const TUNED: Amplifier = Amplifier::TunedCurrent {
    bandwidth_rad_s: 6283.185307179586,
};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Checks each entry to a relative tolerance; an entry that is zero, to that part of the largest of its row.
#[track_caller]
fn close(found: &[f64], expected: &[f64], part: f64) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    for (found, expected) in found.iter().zip(expected) {
        let allowed = part * if *expected == 0.0 { largest } else { expected.abs() };
        assert!((found - expected).abs() <= allowed, "{found:e} instead of {expected:e}");
    }
}

#[test]
fn golden_matrices_of_the_loops() {
    let drive = &golden()["drive"];
    for (name, amplifier) in [
        ("velocity loop of eq 2-18, two-mass", VELOCITY),
        ("open velocity loop (torque/current mode), two-mass", CURRENT),
    ] {
        let (matrix, _) = stage(amplifier).matrices();
        for (row, expected) in matrix.row_iter().zip(drive[name]["matrix"].as_array().unwrap()) {
            close(row.transpose().as_slice(), &numbers(expected), 1e-14);
        }
    }
    let rigid = stage(VELOCITY).rigid_matrix();
    let expected = &drive["velocity loop of eq 2-18, rigid J_total"]["matrix"];
    for (row, expected) in rigid.row_iter().zip(expected.as_array().unwrap()) {
        close(row.transpose().as_slice(), &numbers(expected), 1e-14);
    }
}

#[test]
fn golden_poles_of_the_loops() {
    let drive = &golden()["drive"];
    for (name, amplifier) in [
        ("velocity loop of eq 2-18, two-mass", VELOCITY),
        ("open velocity loop (torque/current mode), two-mass", CURRENT),
    ] {
        let modes = stage(amplifier).modes();
        // The first pole of the list is at 0.
        let expected = &drive[name]["f_zeta"].as_array().unwrap()[1..];
        assert_eq!(modes.len(), expected.len(), "{name}");
        for (mode, expected) in modes.iter().zip(expected) {
            close(&[mode.frequency_hz, mode.damping], &numbers(expected), 1e-9);
        }
    }
    let rigid = stage(VELOCITY).rigid_mode().unwrap();
    let expected = &drive["velocity loop of eq 2-18, rigid J_total"]["f_zeta"][0];
    close(&[rigid.frequency_hz, rigid.damping], &numbers(expected), 1e-10);
}

#[test]
fn golden_a_step_of_the_velocity_loop() {
    let golden = &golden()["drive"]["velocity_step_1rad_s_at_1to20ms__[w_motor, w_load_equiv, i]"];
    let train = stage(VELOCITY);
    let mut plant = DriveTrainPlant::new(train, 1e-3);
    for expected in golden.as_array().unwrap() {
        plant.hold(1.0);
        let state = plant.state();
        let found = [state.speed, state.velocity / train.lead_per_radian, state.current_a];
        for (found, expected) in found.iter().zip(numbers(expected)) {
            assert!((found - expected).abs() < 1e-10, "{found} instead of {expected}");
        }
    }
}

#[test]
fn golden_zero_order_holds() {
    for (name, time_s) in [("2e-05", 20e-6), ("0.0001", 100e-6)] {
        let golden = &golden()["drive"][format!("zoh_two_mass_current_command_T={name}")];
        let (matrix, input) = stage(CURRENT).held_matrices(time_s);
        for (row, expected) in matrix.row_iter().zip(golden["Ad"].as_array().unwrap()) {
            close(row.transpose().as_slice(), &numbers(expected), 1e-10);
        }
        // Its smallest entries are good to 1e-8 only, relative to the largest: the same series in rational arithmetic
        // gives our values.
        close(input.as_slice(), &numbers(&golden["Bd"]), 2e-8);
    }
    let (_, input) = stage(CURRENT).held_matrices(100e-6);
    let rational = [
        0.003_987_046_790_239_683,
        2.718_465_651_519_169_7e-07,
        0.008_084_146_339_153_91,
        1.479_501_751_419_627_2e-12,
        5.953_049_105_362_322e-08,
    ];
    close(input.as_slice(), &rational, 1e-12);
}

#[test]
fn golden_figures_of_the_notes() {
    let train = stage(TUNED);
    assert!((train.equivalent_mass() - 64.274).abs() < 1e-3);
    assert!((train.force_constant() - 475.01).abs() < 5e-3);
    assert!((train.held_mode().frequency_hz - 131.117).abs() < 2e-3);
    assert!((train.free_mode().frequency_hz - 278.2).abs() < 0.05);
}

#[test]
fn masses_that_nothing_holds_have_no_mode_of_that() {
    let modes = stage(TUNED).modes();
    assert_eq!(modes.len(), 1, "{modes:?}");
    let free = stage(TUNED).free_mode();
    close(
        &[modes[0].frequency_hz, modes[0].damping],
        &[free.frequency_hz, free.damping],
        1e-9,
    );
}

#[test]
fn steps_come_to_the_exact_motion() {
    // This friction is too small to matter, so that the steps are those of Runge and Kutta.
    let almost_none = Friction {
        stribeck: Stribeck {
            coulomb: 1e-30,
            breakaway: 1e-30,
            ..Stribeck::NONE
        },
        rest_velocity: 1.0,
    };
    let exact = stage(TUNED);
    let stepped = DriveTrain {
        load_friction: almost_none,
        ..exact
    };
    let [mut exact, mut stepped] = [exact, stepped].map(|train| DriveTrainPlant::new(train, 1e-4));
    for tick in 0..1_000 {
        let command = if tick % 200 < 100 { 1.0 } else { -1.0 };
        exact.hold(command);
        stepped.hold(command);
    }
    let [exact, stepped] = [exact, stepped].map(|plant| plant.state());
    assert!((exact.position - stepped.position).abs() < 1e-9 * exact.position.abs());
    assert!((exact.velocity - stepped.velocity).abs() < 1e-7 * 0.2);
}

#[test]
fn limits_cut_current_and_voltage() {
    // 3 A are limited to 1 A: the masses gain what that gives them.
    let limited = DriveTrain {
        current_limit_a: 1.0,
        ..stage(TUNED)
    };
    let [mut cut, mut whole] = [(limited, 3.0), (stage(TUNED), 1.0)].map(|(train, command)| {
        let mut plant = DriveTrainPlant::new(train, 1e-4);
        (0..500).for_each(|_| plant.hold(command));
        plant.state()
    });
    assert!((cut.velocity / whole.velocity - 1.0).abs() < 1e-7, "{cut:?} {whole:?}");
    // A motor held by a heavy load has the current that the voltage drives through its resistance.
    let heavy = DriveTrain {
        voltage_limit_v: 10.0,
        motor_inertia: 1e6,
        ..stage(CURRENT)
    };
    let mut plant = DriveTrainPlant::new(heavy, 1e-3);
    (0..2_000).for_each(|_| plant.hold(100.0));
    cut = plant.state();
    assert!((cut.current_a - 10.0).abs() < 1e-5, "{cut:?}");
    // Within the limit the loop has its own droop: 2/3 of the command.
    plant = DriveTrainPlant::new(heavy, 1e-3);
    (0..2_000).for_each(|_| plant.hold(1.5));
    whole = plant.state();
    assert!((whole.current_a - 1.0).abs() < 1e-5, "{whole:?}");
}

fn guided(contact: Contact, rest_velocity: f64) -> DriveTrain {
    DriveTrain {
        load_friction: Friction {
            stribeck: Stribeck {
                coulomb: 40.0,
                breakaway: 60.0,
                velocity: 0.005,
                viscous: 200.0,
            },
            rest_velocity,
        },
        contact,
        ..stage(TUNED)
    }
}

#[test]
fn stick_slip_holds_below_the_breakaway_force_and_smooth_friction_creeps() {
    let hold = |contact, force: f64| {
        let train = guided(contact, 1e-4);
        let mut plant = DriveTrainPlant::new(train, 1e-4);
        // The force rises slowly: a jump would make the motor overshoot.
        (0..20_000).for_each(|tick| plant.hold(force / train.force_constant() * (f64::from(tick) / 10_000.0).min(1.0)));
        plant.state()
    };
    let held = hold(Contact::StickSlip, 59.0);
    assert_eq!((held.position, held.velocity), (0.0, 0.0));
    // The motor has turned until the screw holds it.
    assert!((held.angle * stage(TUNED).lead_per_radian - 59.0 / 33_935_700.0).abs() < 1e-12);
    let away = hold(Contact::StickSlip, 61.0);
    assert!(away.velocity > 0.03, "{away:?}");
    // tanh(v/1e-4) = 1/2 at this speed, for which dry friction is still 60 N.
    let creeping = hold(Contact::Smooth, 30.0);
    assert!((creeping.velocity - 0.549e-4).abs() < 0.01e-4, "{creeping:?}");
}

#[test]
fn a_slow_motor_pulls_the_table_in_jerks() {
    // With a soft screw, at 1 mm/s, the table sticks until the spring has 60 N, slides, and sticks again.
    let slow = DriveTrain {
        stiffness: 1e5,
        damping: 0.0,
        motor_inertia: 1e3,
        ..guided(Contact::StickSlip, 1e-6)
    };
    let speed = 1e-3 / slow.lead_per_radian;
    let mut plant = DriveTrainPlant::new(slow, 1e-4).starting(TrainState {
        speed,
        ..TrainState::default()
    });
    let (mut leaves, mut was_at_rest) = (vec![], true);
    for tick in 0..30_000 {
        plant.hold(0.0);
        let state = plant.state();
        let at_rest = state.velocity == 0.0;
        if was_at_rest && !at_rest {
            let force = slow.stiffness * (slow.lead_per_radian * state.angle - state.position);
            leaves.push((f64::from(tick) * 1e-4, force));
        }
        was_at_rest = at_rest;
    }
    // 60 N at 1e5 N/m and 1 mm/s take 0.6 s.
    assert!((leaves[0].0 - 0.6).abs() < 1e-3, "{leaves:?}");
    assert!(leaves.len() > 3, "{leaves:?}");
    assert!(leaves.iter().all(|(_, force)| (force - 60.0).abs() < 0.1), "{leaves:?}");
}

#[test]
fn friction_takes_out_what_it_should() {
    // Coasting from 0.1 m/s under Coulomb friction alone ends after v²/2a of the whole mass.
    for contact in [Contact::Smooth, Contact::StickSlip] {
        let coulomb = Stribeck {
            coulomb: 40.0,
            breakaway: 40.0,
            ..Stribeck::NONE
        };
        let train = DriveTrain {
            load_friction: Friction {
                stribeck: coulomb,
                rest_velocity: 1e-5,
            },
            contact,
            ..stage(TUNED)
        };
        let mut plant = DriveTrainPlant::new(train, 1e-3).starting(TrainState {
            speed: 0.1 / train.lead_per_radian,
            velocity: 0.1,
            ..TrainState::default()
        });
        (0..1_000).for_each(|_| plant.hold(0.0));
        let expected = 0.1f64.powi(2) / 2.0 * train.equivalent_mass() / 40.0;
        let found = plant.state().position;
        assert!(
            (found / expected - 1.0).abs() < 1e-3,
            "{contact:?}: {found} instead of {expected}"
        );
    }
}

#[test]
fn the_step_is_short_beside_friction_and_poles() {
    assert_eq!(DriveTrainPlant::new(stage(TUNED), 1e-4).step_s(), 1e-4 / 5.0);
    // The expected value is 2 · 1e-6 · 50 / 60 s.
    let steep = guided(Contact::Smooth, 1e-6);
    assert!((steep.longest_step_s() - 2e-6 * 50.0 / 60.0).abs() < 1e-18);
}
