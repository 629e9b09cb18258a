//! `[axis.mechanics]`: a mode from the data sheets of a screw. The figures are those of the notes on the XY stage,
//! sections 4 and 7.

use crate::machine_file::files::{SMALL, right, wrong};

/// Axis X of the XY stage; the damping is that of its identified mode.
const SCREW: &str = "[axis.mechanics]
lead_m = 0.005
screw_diameter_m = 0.012
screw_length_m = 0.340
loaded_length_m = 0.350
coupling_diameter_m = 0.008
coupling_length_m = 0.025
nut_stiffness = 200e6
bearing_stiffness = 133.4873e6
motor_inertia = 3.64e-6
table_mass = 50
motor_held_damping = 0.157799066
";
const TORQUE: &str = "[axis.pwm]
mode = \"locked-antiphase\"
frequency_hz = 20_000
[axis.drive]
mode = \"torque\"
equivalent_mass = 64.274
force_constant = 475.01
current_limit_a = 2.73
full_scale_a = 3.0
";

/// Returns the small file with other tables instead of its mode.
fn with(tables: &str) -> String {
    let (head, _) = SMALL.split_once("[[axis.mode]]").unwrap();
    format!("{head}{tables}")
}

#[test]
fn golden_the_mode_of_the_xy_stage_follows_from_its_data() {
    let machine = right(&with(SCREW));
    let axis = &machine.axes[0];
    // The notes' 34.2066 N/µm follow from a stiffness that is printed as 36.44; it is 36.4412.
    assert!((axis.mechanics.unwrap().stiffness() / 1e6 - 34.2076).abs() < 1e-4);
    assert_eq!(axis.modes.len(), 1);
    let held = axis.modes[0].mode;
    // The expected value is √(34.2076e6 N/m / 50 kg) / 2π.
    assert!((held.frequency_hz - 131.6426).abs() < 2e-4, "{held:?}");
    assert!((held.damping - 0.157799066).abs() < 1e-12);
    // With 14.274 kg of motor and screw at the table, both grow by √(1 + 50/14.274).
    let machine = right(&with(&format!("{SCREW}{TORQUE}")));
    let free = machine.axes[0].modes[0].mode;
    let ratio = (1.0 + 50.0 / 14.2737f64).sqrt();
    assert!((free.frequency_hz / held.frequency_hz - ratio).abs() < 1e-4, "{free:?}");
    assert!((free.damping / held.damping - ratio).abs() < 1e-4, "{free:?}");
    let velocity = TORQUE.split("mode = \"torque\"").next().unwrap().to_owned();
    let velocity = format!("{SCREW}{velocity}mode = \"velocity\"\nfull_scale_velocity = 0.5\n");
    assert_eq!(right(&with(&velocity)).axes[0].modes[0].mode, held);
}

#[test]
fn what_is_left_out_is_rigid() {
    let short = SCREW.lines().filter(|line| {
        !["coupling_", "nut_", "bearing_", "loaded_"]
            .iter()
            .any(|key| line.starts_with(key))
    });
    let short: String = short.map(|line| format!("{line}\n")).collect();
    let screw = right(&with(&short)).axes[0].mechanics.unwrap();
    assert!(screw.coupling_stiffness.is_infinite() && screw.loaded_length_m == 0.340);
    assert_eq!(screw.stiffness(), screw.screw_stiffness());
    let given = format!("{short}coupling_stiffness = 1302.88\n");
    let screw = right(&with(&given)).axes[0].mechanics.unwrap();
    assert_eq!(screw.coupling_stiffness, 1302.88);
}

#[test]
fn mechanics_stand_in_the_place_of_modes() {
    let both = format!("{SCREW}[[axis.mode]]\nfrequency_hz = 40.0\ndamping = 0.1\n");
    let error = wrong(&with(&both));
    assert_eq!(error.problems().len(), 1, "{error}");
    assert!(
        error
            .to_string()
            .contains("axis.mechanics of axis x: found [axis.mechanics] beside [[axis.mode]]; allowed: one of the two"),
        "{error}"
    );
}

#[test]
fn mechanics_that_cannot_be_are_refused_by_their_key() {
    let replaced = |from: &str, to: &str| {
        let text = SCREW.replace(from, to);
        assert_ne!(text, SCREW);
        let error = wrong(&with(&text));
        assert_eq!(error.problems().len(), 1, "{error}");
        error.to_string()
    };
    for (from, to, expected) in [
        ("lead_m = 0.005", "", "axis.mechanics.lead_m"),
        ("lead_m = 0.005", "lead_m = 5e-6", "axis.mechanics.lead_m"),
        ("table_mass = 50", "table_mass = 0", "axis.mechanics.table_mass"),
        (
            "_damping = 0.157799066",
            "_damping = 1.0",
            "axis.mechanics.motor_held_damping",
        ),
        (
            "coupling_length_m = 0.025\n",
            "",
            "coupling_diameter_m without coupling_length_m",
        ),
        (
            "coupling_length_m = 0.025",
            "coupling_length_m = 0.025\ncoupling_stiffness = 1300",
            "both coupling_diameter_m and coupling_stiffness",
        ),
        (
            "table_mass = 50",
            "table_mass = 0.001",
            "below 5000 Hz, half of clock.sample_hz",
        ),
    ] {
        let error = replaced(from, to);
        assert!(error.contains(expected), "{error}");
    }
    // This mode rings with the motor held and not with it free.
    let text = SCREW.replace("0.157799066", "0.6");
    right(&with(&text));
    let error = wrong(&with(&format!("{text}{TORQUE}")));
    assert!(
        error.to_string().contains("motor free, as behind a torque drive, 1.2"),
        "{error}"
    );
    let rotary = with(SCREW).replace("name = \"x\"", "name = \"x\"\nunit = \"rad\"");
    let error = wrong(&rotary);
    assert!(
        error.to_string().contains("[axis.mechanics] with unit = \"rad\""),
        "{error}"
    );
}

#[test]
fn friction_that_sticks_needs_a_drive_that_feels_it() {
    let with_drive = |keys: &str, drive: &str| with(&format!("{SCREW}{keys}{TORQUE}{drive}"));
    let drive = "bandwidth_hz = 1000.0\ncoulomb = 40.0\n";
    let machine = right(&with_drive("breakaway = 60\n", drive));
    let stiction = machine.axes[0].mechanics.unwrap().stiction.unwrap();
    assert_eq!((stiction.breakaway, stiction.stribeck_velocity), (60.0, 0.005));
    for (keys, drive, expected) in [
        (
            "stribeck_velocity = 0.01\n",
            drive,
            "stribeck_velocity without breakaway",
        ),
        ("breakaway = 30\n", drive, "at least drive.coulomb = 40 N"),
        (
            "breakaway = 60\n",
            "coulomb = 40.0\n",
            "without a torque drive that has a bandwidth",
        ),
    ] {
        let error = wrong(&with_drive(keys, drive));
        assert_eq!(error.problems().len(), 1, "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
}
