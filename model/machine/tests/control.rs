//! Gains from a machine file, their warnings, and loops closed over a mass with friction by the fixed-point controller.

use posicast_blocks::sliding_mode::{Law, SettingRow, TickController, TickMotion};
use posicast_machine::control::{ControlError, ControlWarning, Derived, gains, loop_lag_s};
use posicast_machine::machine_file::{self, Drive, Machine};
use std::f64::consts::TAU;

const TORQUE: &str = "mode = \"torque\"\nequivalent_mass = 64.274\nforce_constant = 475.01\ncurrent_limit_a = 2.73\n\
    full_scale_a = 3.0\nbandwidth_hz = 1000.0\nviscous = 200.0\ncoulomb = 40.0\n";
const VELOCITY: &str = "mode = \"velocity\"\nfull_scale_velocity = 0.5\nbandwidth_hz = 200.0\n";
const SLIDING: &str = "kind = \"sliding-mode\"\nc = 150.0\nk = 50.0\nepsilon = 4.0\nboundary = 0.05\n";
const T: f64 = 1e-4;
const COUNT: f64 = 1e-6;

/// The XY stage's axis X with another drive and controller. With a torque drive, the loop contains the mode of motor
/// against table.
fn machine(drive: &str, controller: &str) -> Machine {
    let (frequency_hz, damping) = if drive.contains("torque") {
        (283.665, 0.329)
    } else {
        (131.1, 0.158)
    };
    let text = format!(
        "name = \"one\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n[[axis]]\nname = \"x\"\n\
         counts_per_unit = 1_000_000\n[[axis.mode]]\nfrequency_hz = {frequency_hz}\ndamping = {damping}\n[axis.shaper]\nkind = \"zvd\"\n\
         [axis.encoder]\n[axis.pwm]\nmode = \"half-bridge\"\nfrequency_hz = 20_000\n[axis.drive]\n{drive}\n\
         [axis.controller]\n{controller}\n[axis.limits]\nvelocity = 0.25\nacceleration = 8.0\n"
    );
    machine_file::parse("one.toml", &text).unwrap_or_else(|error| panic!("{error:?}"))
}

fn derive(drive: &str, controller: &str) -> Result<Derived, ControlError> {
    let machine = machine(drive, controller);
    let axis = &machine.axes[0];
    let lag_s = loop_lag_s(axis.drive.as_ref().unwrap(), 50e-6);
    gains(axis, machine.clock, lag_s)
}

#[test]
fn golden_the_gains_of_the_notes() {
    let derived = derive(TORQUE, SLIDING).unwrap();
    let of = |row| derived.gains.get(row);
    // The feedback's scale is a power of two and cancels.
    let scale = of(SettingRow::Acceleration) / of(SettingRow::Feedback);
    assert_eq!(scale.log2().fract(), 0.0);
    let expected = [
        (SettingRow::Surface, 0.015),
        (SettingRow::Boundary, 0.2),
        (SettingRow::Damping, 0.015 * scale),
        (SettingRow::Reaching, 0.005 * scale),
        (SettingRow::Switching, 0.04 * scale),
        (SettingRow::Acceleration, 13531.0172),
        (SettingRow::Viscous, 4.21044823),
        (SettingRow::Coulomb, 84.2087),
        (SettingRow::Limit, 2730.0),
        (SettingRow::Duty, 2500.0 / 3000.0),
    ];
    for (row, value) in expected {
        assert!((of(row) / value - 1.0).abs() < 1e-4, "{row:?}: {} {value}", of(row));
    }
    assert_eq!(derived.law, Law::SlidingMode);
    // This is d/(c (k + epsilon/phi)) of the notes, with the table's Coulomb friction.
    assert!((derived.steady_error - 40.0 / 64.274 / (150.0 * 130.0)).abs() < 1e-12);
    assert_eq!(derived.warnings, []);
}

#[test]
fn each_condition_of_the_notes_warns() {
    let warnings = |controller: &str| derive(TORQUE, controller).unwrap().warnings;
    let sliding = |c: f64, k: f64, epsilon: f64, boundary: f64| {
        warnings(&format!(
            "kind = \"sliding-mode\"\nc = {c}\nk = {k}\nepsilon = {epsilon}\nboundary = {boundary}"
        ))
    };
    let has = |warnings: &[ControlWarning], wanted: fn(&ControlWarning) -> bool| warnings.iter().any(wanted);
    assert!(has(&sliding(150.0, 50.0, 0.15, 0.05), |w| matches!(
        w,
        ControlWarning::WeakSwitching { .. }
    )));
    assert!(has(&sliding(150.0, 50.0, 150.0, 1.0), |w| matches!(
        w,
        ControlWarning::SwitchingSaturates { .. }
    )));
    // This boundary layer is crossed within a tick.
    let narrow = SLIDING.replace("0.05", "4e-4");
    let error = derive(TORQUE, &narrow).unwrap_err();
    assert!(matches!(error, ControlError::Unstable { .. }), "{error}");
    assert_eq!(error.key(), "axis.controller.c");
    assert!(has(
        &derive(VELOCITY, &SLIDING.replace("k = 50.0", "k = 400.0"))
            .unwrap()
            .warnings,
        |w| matches!(w, ControlWarning::GainTimesLag { found, .. } if *found > 0.5)
    ));
    let pid = "kind = \"pid\"\nproportional = 1000.0\nderivative = 100.0\nintegral = 2e5";
    assert!(matches!(derive(TORQUE, pid), Err(ControlError::Unstable { .. })));
    assert!(has(&sliding(400.0, 200.0, 4.0, 0.05), |w| matches!(
        w,
        ControlWarning::ThinMargin { .. }
    )));
    let slow = TORQUE.replace("2.73", "1.1");
    let found = derive(&slow, SLIDING).unwrap().warnings;
    assert!(
        has(&found, |w| matches!(w, ControlWarning::Acceleration { .. })),
        "{found:?}"
    );
    let short = VELOCITY.replace("0.5", "0.2");
    let found = derive(&short, "kind = \"pd\"").unwrap().warnings;
    assert!(
        has(&found, |w| matches!(w, ControlWarning::Velocity { .. })),
        "{found:?}"
    );
}

#[test]
fn defaults_keep_the_gain_check() {
    for drive in [TORQUE, VELOCITY] {
        for kind in ["pd", "pid"] {
            let derived = derive(drive, &format!("kind = \"{kind}\"")).unwrap();
            assert_eq!(derived.warnings, [], "{drive} {kind}");
        }
    }
}

#[test]
fn what_is_missing_is_named() {
    let open = VELOCITY.replace("bandwidth_hz = 200.0\n", "");
    assert!(matches!(derive(&open, SLIDING), Err(ControlError::Bandwidth { .. })));
    let machine = machine(TORQUE, SLIDING);
    for lag_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            gains(&machine.axes[0], machine.clock, lag_s),
            Err(ControlError::Lag(_))
        ));
    }
    let mut axis = machine.axes[0].clone();
    axis.drive = None;
    let error = gains(&axis, machine.clock, 1e-4).unwrap_err();
    assert!(error.to_string().contains("[axis.drive]"), "{error}");
    // Gains beyond any word must give an error, not a panic.
    let mut axis = machine.axes[0].clone();
    axis.counts_per_unit = 1e-12;
    assert!(matches!(
        gains(&axis, machine.clock, 1e-4),
        Err(ControlError::Gain { .. })
    ));
    axis.counts_per_unit = 1e12;
    for lag_s in [1e-300, 1e300] {
        let _ = gains(&axis, machine.clock, lag_s);
    }
}

#[test]
fn the_number_to_blame_for_a_gain_is_named() {
    let key = |drive: &str, controller: &str| derive(drive, controller).unwrap_err().key();
    let tiny = |text: &str, key: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("{key} ="))).unwrap();
        text.replace(line, &format!("{key} = 1e-300"))
    };
    for name in ["c", "boundary"] {
        assert_eq!(key(TORQUE, &tiny(SLIDING, name)), format!("axis.controller.{name}"));
    }
    for name in [
        "equivalent_mass",
        "force_constant",
        "bandwidth_hz",
        "viscous",
        "coulomb",
        "current_limit_a",
    ] {
        let controller = if name == "bandwidth_hz" {
            "kind = \"pd\""
        } else {
            SLIDING
        };
        assert_eq!(key(&tiny(TORQUE, name), controller), format!("axis.drive.{name}"));
    }
    assert_eq!(
        key(&tiny(VELOCITY, "full_scale_velocity"), "kind = \"pd\""),
        "axis.drive.full_scale_velocity"
    );
    assert_eq!(
        key(&tiny(VELOCITY, "bandwidth_hz"), "kind = \"pd\""),
        "axis.drive.bandwidth_hz"
    );
    let lost = derive(TORQUE, "kind = \"pd\"\nproportional = 1e-300").unwrap_err();
    assert!(
        matches!(
            lost,
            ControlError::Lost {
                row: SettingRow::Proportional,
                ..
            }
        ),
        "{lost}"
    );
    let text = lost.to_string();
    assert!(
        text.contains("axis.controller.proportional = 1e-300: raise it"),
        "{text}"
    );
    assert!(text.len() < 250, "{text}");
}

/// A mass with viscous and Coulomb friction behind a drive of first order.
struct Mass {
    drive: Drive,
    torque: bool,
    position: f64,
    velocity: f64,
    /// State of the drive: current in A, or velocity in m/s.
    state: f64,
}

impl Mass {
    /// Advances by a tick with a command in A or m/s.
    fn tick(&mut self, command: f64) {
        const STEPS: u32 = 50;
        let step = T / f64::from(STEPS);
        let pole = TAU * self.drive.bandwidth_hz.unwrap();
        for _ in 0..STEPS {
            self.state += step * pole * (command - self.state);
            if self.torque {
                let friction = 200.0 * self.velocity + 40.0 * (self.velocity / 1e-3).tanh();
                self.velocity += step * (475.01 * self.state - friction) / 64.274;
            } else {
                self.velocity = self.state;
            }
            self.position += step * self.velocity;
        }
    }
}

/// Runs the loop. Returns the largest |e| in m in the second half, and the largest change of the command from tick to
/// tick there.
fn follow(
    drive: &str,
    controller: &str,
    law: impl Fn(usize) -> Law,
    ticks: usize,
    reference: impl Fn(f64) -> [f64; 3],
) -> (f64, f64) {
    let machine = machine(drive, controller);
    let derived = derive(drive, controller).unwrap();
    let mut plant = Mass {
        drive: machine.axes[0].drive.unwrap(),
        torque: drive == TORQUE,
        position: reference(0.0)[0],
        velocity: 0.0,
        state: 0.0,
    };
    let mut controller = TickController::default();
    let (mut worst, mut jump, mut before) = (0.0f64, 0.0f64, 0.0f64);
    for tick in 0..ticks {
        let [r, dr, ddr] = reference(tick as f64 * T);
        let motion = TickMotion {
            position_reference: (r / COUNT * 256.0).round() as i32,
            velocity_reference: (dr * T / COUNT * 65_536.0).round() as i32,
            acceleration_reference: (ddr * T * T / COUNT * 16_777_216.0).round() as i32,
            position: (plant.position / COUNT).round() as i32,
            velocity: (plant.velocity * T / COUNT * 65_536.0).round() as i32,
        };
        let shown = controller.control(law(tick), false, &motion, &derived.settings);
        let command = f64::from(shown.command) / 4096.0 / 1000.0;
        if tick >= ticks / 2 {
            worst = worst.max((r - plant.position).abs());
            jump = jump.max((command - before).abs());
        }
        before = command;
        plant.tick(command);
    }
    (worst, jump)
}

/// Returns the sine of the notes: 10 mm at 2 Hz.
fn sine(time_s: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * 2.0 * time_s).sin_cos();
    let rate = TAU * 2.0;
    [0.01 * sin, 0.01 * rate * cos, -0.01 * rate * rate * sin]
}

/// Returns a step of 2 mm, for which the command is at its limit.
fn jump(time_s: f64) -> [f64; 3] {
    [if time_s > 0.0 { 2e-3 } else { 0.0 }, 0.0, 0.0]
}

#[test]
fn every_law_follows_a_sine_with_a_torque_drive() {
    for (controller, law, allowed) in [
        (SLIDING, Law::SlidingMode, 1e-6),
        ("kind = \"pd\"", Law::Pd, 0.6e-6),
        ("kind = \"pid\"", Law::Pid, 0.5e-6),
    ] {
        let (worst, _) = follow(TORQUE, controller, |_| law, 10_000, sine);
        assert!(worst < allowed, "{law:?}: {worst}");
    }
}

#[test]
fn every_law_follows_a_sine_with_a_velocity_drive() {
    let gentle = "kind = \"sliding-mode\"\nc = 100.0\nk = 50.0\nepsilon = 4.0\nboundary = 0.05\n";
    for (controller, law, allowed) in [
        (gentle, Law::SlidingMode, 12e-6),
        ("kind = \"pd\"", Law::Pd, 8e-6),
        ("kind = \"pid\"", Law::Pid, 1e-6),
    ] {
        let (worst, _) = follow(VELOCITY, controller, |_| law, 10_000, sine);
        assert!(worst < allowed, "{law:?}: {worst}");
    }
}

#[test]
fn a_jump_that_saturates_the_command_settles() {
    for (controller, law, allowed) in [
        (SLIDING, Law::SlidingMode, 1e-6),
        ("kind = \"pd\"", Law::Pd, 1e-6),
        ("kind = \"pid\"", Law::Pid, 1e-6),
    ] {
        let (worst, _) = follow(TORQUE, controller, |_| law, 6_000, jump);
        assert!(worst < allowed, "{law:?}: {worst}");
    }
}

#[test]
fn a_change_of_law_does_not_kick() {
    let pid = "kind = \"pid\"";
    let steady = follow(TORQUE, pid, |_| Law::Pid, 10_000, sine).1;
    let changing = |tick: usize| match tick / 700 % 3 {
        0 => Law::Pid,
        1 => Law::Pd,
        _ => Law::SlidingMode,
    };
    let (worst, kick) = follow(TORQUE, pid, changing, 10_000, sine);
    assert!(kick < 1.3 * steady, "{kick} A, without changes {steady} A");
    assert!(worst < 1e-6, "{worst}");
}
