//! The simulated axis as motor and table with static friction, as `breakaway` in `[axis.mechanics]` requests it.

use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plant::axis::{AxisPlant, DrivePins, PlantOptions};

const FORWARD: DrivePins = DrivePins {
    a_high: true,
    a_low: false,
    b_high: false,
    b_low: true,
    drive_enable: true,
    brake_release: true,
};
const BACK: DrivePins = DrivePins {
    a_high: false,
    a_low: true,
    b_high: true,
    b_low: false,
    ..FORWARD
};

/// Axis X of the XY stage with a torque drive; `keys` go into `[axis.mechanics]`.
fn machine(keys: &str, friction: &str) -> Machine {
    let text = format!(
        "name = \"m\"
[clock]
frequency_hz = 50_000_000
sample_hz = 10_000
[[axis]]
name = \"x\"
counts_per_unit = 1_000_000
[axis.shaper]
kind = \"zvd\"
[axis.mechanics]
lead_m = 0.005
screw_diameter_m = 0.012
screw_length_m = 0.34
motor_inertia = 3.64e-6
table_mass = 50.0
motor_held_damping = 0.1578
{keys}
[axis.pwm]
mode = \"locked-antiphase\"
frequency_hz = 20_000
[axis.drive]
mode = \"torque\"
equivalent_mass = 64.273697757
force_constant = 475.01
current_limit_a = 3.0
full_scale_a = 3.0
bandwidth_hz = 1000.0
{friction}
"
    );
    machine_file::parse("m.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

fn plant(machine: &Machine) -> AxisPlant {
    AxisPlant::new(&machine.axes[0], &machine.clock, &PlantOptions::default()).unwrap()
}

/// Plays periods of the PWM at a mean command.
fn drive(plant: &mut AxisPlant, share: f64, periods: u32) {
    let forward = ((1.0 + share) / 2.0 * 2_500.0).round() as u64;
    for _ in 0..periods {
        plant.clocks(FORWARD, forward);
        plant.clocks(BACK, 2_500 - forward);
    }
}

#[test]
fn without_friction_it_is_the_mode_of_both_masses() {
    let machines = [machine("breakaway = 0", ""), machine("", "")];
    let mut plants = machines.each_ref().map(plant);
    for (share, periods) in [(0.5, 200), (-0.8, 100), (0.1, 400)] {
        let [two, one] = plants.each_mut().map(|plant| {
            drive(plant, share, periods);
            plant.motion()
        });
        assert!((two.load - one.load).abs() < 1e-5 * one.load.abs(), "{two:?} {one:?}");
        assert!((two.drive - one.drive).abs() < 1e-6, "{two:?} {one:?}");
    }
}

#[test]
fn it_stays_below_the_breakaway_force_and_leaves_above() {
    let friction = "coulomb = 40.0\nviscous = 200.0";
    // 50 N of 1425 N, applied slowly.
    for (newton, moves) in [(50.0, false), (70.0, true)] {
        let mut plant = plant(&machine("breakaway = 60", friction));
        for part in 1..=100 {
            drive(&mut plant, newton / 1425.03 * f64::from(part) / 100.0, 40);
        }
        let load = plant.motion().load;
        assert_eq!(load != 0.0, moves, "{newton} N: {load}");
        assert_eq!(plant.count() > 10, moves);
    }
}

#[test]
fn off_it_coasts_and_the_brake_holds_it() {
    let mut plant = plant(&machine("breakaway = 60", "coulomb = 40.0"));
    drive(&mut plant, 0.5, 400);
    let moving = plant.motion();
    assert!(moving.velocity > 0.1, "{moving:?}");
    let off = DrivePins {
        drive_enable: false,
        ..DrivePins::default()
    };
    plant.clocks(
        DrivePins {
            brake_release: true,
            ..off
        },
        100_000,
    );
    let coasting = plant.motion();
    assert_eq!(coasting.drive, 0.0);
    assert!(coasting.load > moving.load);
    plant.clocks(off, 50_000);
    let held = plant.motion();
    assert_eq!(held.velocity, 0.0);
    plant.clocks(off, 50_000);
    assert_eq!(plant.motion().load, held.load);
}
