//! Modes with the motor held, from a drive's command and the motor's own encoder, against two masses on a screw.

use posicast_identify::DriveLog;
use posicast_identify::position::PositionRemark;
use posicast_identify::position::motor::{self, FoundAtMotor};
use posicast_identify::synthetic::Noise;
use posicast_identify::synthetic::pseudo_random;
use posicast_machine::plant::drive_train::{
    Amplifier, Contact, DriveTrain, DriveTrainPlant, Friction, Stribeck, TrainState, Winding, quantised,
};

const TICK_S: f64 = 1e-4;
const LEAD: f64 = 0.005 / std::f64::consts::TAU;

/// X of the XY stage (golden/xy_stage.json, `drive`).
fn train(amplifier: Amplifier) -> DriveTrain {
    DriveTrain {
        torque_constant: 0.378,
        motor_inertia: 9.038_814_408_823_444e-6,
        load_mass: 50.0,
        lead_per_radian: LEAD,
        stiffness: 33.9357e6,
        damping: 1.3e4,
        ..DriveTrain::rigid(amplifier)
    }
}

const TORQUE: Amplifier = Amplifier::TunedCurrent {
    bandwidth_rad_s: std::f64::consts::TAU * 1000.0,
};

/// Its friction, which sticks.
fn sticky(train: DriveTrain) -> DriveTrain {
    DriveTrain {
        load_friction: Friction {
            stribeck: Stribeck {
                coulomb: 40.0,
                breakaway: 60.0,
                velocity: 0.005,
                viscous: 200.0,
            },
            rest_velocity: 1e-6,
        },
        contact: Contact::StickSlip,
        ..train
    }
}

/// A loop on the motor's position that is shaken while the axis moves at `speed` m/s: `ticks` rows of current and position in m, the encoder
/// in steps of `count` m.
fn shaken(train: DriveTrain, ticks: usize, count: f64, speed: f64, noise: &mut Noise) -> DriveLog {
    let (proportional, derivative) = (4e3, 30.0);
    let slides = TrainState {
        velocity: speed,
        speed: speed / LEAD,
        ..TrainState::default()
    };
    let mut plant = DriveTrainPlant::new(train, TICK_S).starting(slides);
    let friction = train.load_friction.stribeck;
    let steady = (friction.coulomb * speed.signum() + friction.viscous * speed) / train.force_constant();
    let mut log = DriveLog {
        sample_s: TICK_S,
        drive: Vec::new(),
        position: Vec::new(),
        missing: Vec::new(),
    };
    let mut before = -speed * TICK_S;
    for (tick, bit) in pseudo_random(ticks, 8).into_iter().enumerate() {
        let x = quantised(LEAD * plant.state().angle + 0.1 * count * noise.draw(), count);
        let reference = speed * tick as f64 * TICK_S + 200e-6 * bit;
        let current = steady + proportional * (reference - x) - derivative * ((x - before) / TICK_S - speed);
        before = x;
        let current = current.clamp(-2.7, 2.7);
        log.drive.push(current);
        log.position.push(x);
        plant.hold(current);
    }
    log
}

fn check(found: &FoundAtMotor, train: &DriveTrain, frequency: f64, damping: f64) {
    let mut truth = train.held_mode();
    // Friction of the table damps it too.
    truth.damping *= 1.0 + train.load_friction.stribeck.viscous / train.damping;
    let [only] = found.held.modes[..] else {
        panic!("{:#?} {:?} {:?}", found.held.modes, found.free, found.held.remarks)
    };
    let off = (
        only.mode.frequency_hz / truth.frequency_hz - 1.0,
        only.mode.damping / truth.damping - 1.0,
    );
    assert!(
        off.0.abs() < frequency && off.1.abs() < damping,
        "{off:?} {only:#?} {:?} {}",
        found.free,
        found.delay
    );
}

fn identify(log: &DriveLog) -> FoundAtMotor {
    motor::identify(log).unwrap()
}

#[test]
fn a_torque_drive_log_gives_the_mode_with_the_motor_held() {
    let train = train(TORQUE);
    let found = identify(&shaken(train, 1024, 1e-9, 0.0, &mut Noise::new(0)));
    check(&found, &train, 0.003, 0.02);
    assert!(found.is_force);
    let free = train.free_mode();
    assert!(
        (found.free[0].frequency_hz / free.frequency_hz - 1.0).abs() < 0.02,
        "{:?}",
        found.free
    );
    let [PositionRemark::MotorFree { .. }, PositionRemark::TurnsRound] = found.held.remarks[..] else {
        panic!("{:?}", found.held.remarks)
    };
    for ticks in [512, 2048] {
        let found = identify(&shaken(train, ticks, 1e-6, 0.0, &mut Noise::new(1)));
        check(&found, &train, 0.01, 0.15);
    }
}

#[test]
fn sticking_friction_does_not_hide_the_mode_of_a_moving_axis() {
    let train = sticky(train(TORQUE));
    for ticks in [512, 1024] {
        let found = identify(&shaken(train, ticks, 1e-6, 0.1, &mut Noise::new(2)));
        check(&found, &train, 0.01, 0.15);
    }
}

#[test]
fn stated_intervals_hold_the_truth_at_the_motor() {
    let train = train(TORQUE);
    let truth = train.held_mode();
    let (mut frequencies, mut dampings) = (0, 0);
    const LOGS: u64 = 20;
    for seed in 0..LOGS {
        let found = identify(&shaken(train, 512, 1e-6, 0.05, &mut Noise::new(seed)));
        let [only] = found.held.modes[..] else {
            panic!("{seed}: {found:?}")
        };
        frequencies += usize::from(only.frequency_interval_hz().holds(truth.frequency_hz));
        dampings += usize::from(only.damping_interval().holds(truth.damping));
    }
    assert!(frequencies >= 17 && dampings >= 17, "{frequencies} {dampings}");
}

/// The thesis's drive, whose velocity loop leaves a mode of 128.3 Hz beside the held one of 131.1 Hz.
#[test]
fn a_velocity_drive_log_gives_the_mode_with_the_motor_held() {
    let winding = Winding {
        inductance_h: 0.05,
        resistance_ohm: 1.0,
        back_emf: 0.18,
    };
    let train = train(Amplifier::Velocity {
        winding,
        current_gain: 2.0,
        velocity_gain: 30.0,
    });
    let mut plant = DriveTrainPlant::new(train, TICK_S);
    let mut log = DriveLog {
        sample_s: TICK_S,
        drive: Vec::new(),
        position: Vec::new(),
        missing: Vec::new(),
    };
    for bit in pseudo_random(4096, 12) {
        log.position.push(quantised(plant.state().angle, 1e-4));
        log.drive.push(10.0 * bit);
        plant.hold(10.0 * bit);
    }
    let found = identify(&log);
    assert!(!found.is_force);
    check(&found, &train, 0.01, 0.15);
}

#[test]
fn remarks_name_rigid_motor_stiff_drive_and_idle_drive() {
    let mut source = Noise::new(5);
    let drive = pseudo_random(1000, 10);
    let mut velocity = 0.0;
    let mut position = 0.0;
    let mut moved = |force: f64, drag: f64| {
        velocity = drag * velocity + force;
        position += velocity;
        position + 0.02 * source.draw()
    };
    // Behind a force the velocity stays, behind a velocity nothing does.
    let log = |position: Vec<f64>, drive: &[f64]| DriveLog {
        sample_s: 1e-3,
        drive: drive.to_vec(),
        position,
        missing: Vec::new(),
    };
    let rigid = log(drive.iter().map(|u| moved(0.01 * u, 1.0)).collect(), &drive);
    let stiff = log(drive.iter().map(|u| moved(0.1 * u, 0.0)).collect(), &drive);
    let still = log(rigid.position.clone(), &[1.0; 1000]);
    for (log, expected) in [
        (rigid, PositionRemark::RigidMotor),
        (stiff, PositionRemark::StiffDrive),
        (still, PositionRemark::NoDrive),
    ] {
        let found = identify(&log);
        assert_eq!(
            (&found.held.modes[..], &found.held.remarks[..]),
            (&[][..], &[expected][..])
        );
    }
}
