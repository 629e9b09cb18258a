//! Modes that were measured with the motor held, or free.

use crate::machine_file::files::{SMALL, breaks, right, wrong};

const DAMPING: &str = "damping = 0.1\n";

fn with(keys: &str) -> String {
    SMALL.replace(DAMPING, &format!("{DAMPING}{keys}"))
}

#[test]
fn a_free_mode_is_converted_and_a_held_one_is_not() {
    let masses = "motor_mass = 2.0\nload_mass = 6.0\n";
    let free = right(&with(&format!("measured = \"free\"\n{masses}"))).axes[0].modes[0].clone();
    assert_eq!((free.mode.frequency_hz, free.mode.damping), (20.0, 0.05));
    let given = free.free.unwrap();
    assert_eq!((given.frequency_hz, given.damping), (40.0, 0.1));
    for keys in [
        "",
        "measured = \"motor_held\"\n",
        &format!("measured = \"motor_held\"\n{masses}"),
    ] {
        let held = right(&with(keys)).axes[0].modes[0].clone();
        assert_eq!((held.mode.frequency_hz, held.free), (40.0, None), "{keys}");
    }
}

#[test]
fn a_free_mode_without_masses_is_refused_where_it_decides_the_shaper() {
    let expected = "m.toml:15: axis.mode.measured of axis x, mode 1: found measured = \"free\" without motor_mass and load_mass; \
                    allowed: \"free\" with motor_mass and load_mass, which convert the mode to that of a held motor; else \
                    \"motor_held\"";
    breaks(DAMPING, &format!("{DAMPING}measured = \"free\"\n"), expected);
    let error = wrong(&with("measured = \"free\"\nload_mass = 1\n"));
    assert!(error.to_string().contains("without motor_mass; "), "{error}");
    assert!(error.problems()[0].remedy.contains("docs/modes.md"), "{error}");
    let none = with("measured = \"free\"\n").replace("\"zvd\"", "\"none\"");
    assert_eq!(right(&none).axes[0].modes[0].mode.frequency_hz, 40.0);
}

#[test]
fn masses_say_what_they_are_for() {
    let expected = "m.toml:15: axis.mode.motor_mass of axis x, mode 1: found a mass without `measured`; allowed: masses with measured = \
                    \"free\", which they convert; without `measured` the mode is taken as it is";
    breaks(DAMPING, &format!("{DAMPING}motor_mass = 1\nload_mass = 1\n"), expected);
}

#[test]
fn half_the_sample_rate_is_compared_with_the_held_mode() {
    let masses = "measured = \"free\"\nmotor_mass = 1\nload_mass = 3\n";
    right(&with(masses).replace("40.0", "8000"));
    let error = wrong(&with(masses).replace("40.0", "12000"));
    assert!(
        error
            .to_string()
            .contains("found 12000, with the motor held 6000 Hz; allowed: below 5000 Hz"),
        "{error}"
    );
}
