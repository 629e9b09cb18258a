//! `posicast generate --hal`: what LinuxCNC gets.

use super::support::{example, posicast};
use posicast_blocks::shaper_tables::ShaperTables;
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::analysis::tap_impulses;
use posicast_shaper::mode::Mode;
use std::path::Path;

fn generated(machine: &Path, folder: &Path) {
    let mut generate = posicast();
    generate.arg("generate").arg(machine).args(["--hal", "-o"]).arg(folder);
    generate.assert().success();
}

fn has(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(text.lines().any(|found| found == *line), "`{line}` is not in\n{text}");
    }
}

#[test]
fn cli_hal_writes_the_machine_in_linuxcnc_s_units() {
    let folder = tempfile::tempdir().unwrap();
    generated(&example("xy-stage.toml"), folder.path());
    let read = |name: &str| std::fs::read_to_string(folder.path().join("hal").join(name)).unwrap();
    // The machine file's 0.25 m/s, 8 m/s² and ±0.1 m; 1,000,000 counts per m.
    let ini = read("xy_stage.ini");
    has(
        &ini,
        &[
            "COORDINATES = X Y",
            "JOINTS = 2",
            "SERVO_PERIOD = 1000000",
            "HALFILE = xy_stage.hal",
        ],
    );
    has(
        &ini,
        &[
            "MAX_VELOCITY = 250",
            "MAX_ACCELERATION = 8000",
            "MIN_LIMIT = -100",
            "MAX_LIMIT = 100",
        ],
    );
    has(
        &ini,
        &["HOME_USE_INDEX = YES", "HOME_LATCH_VEL = 5", "[JOINT_1]", "[AXIS_Y]"],
    );
    let header = read("posicast_hal_machine.h");
    has(
        &header,
        &[
            "    1000.0, /* x, per mm */",
            "    {-25600000, 25600000},",
            "#define POSICAST_HAL_SERVO_NS 1000000u",
        ],
    );
    has(
        &read("xy_stage.hal"),
        &[
            "net y-pos-cmd joint.1.motor-pos-cmd => posicast.1.pos-cmd",
            "addf posicast.write         servo-thread",
        ],
    );

    // The tables are those of the servo rate: they suppress the modes of the file there.
    let tables = ShaperTables::parse(&read("xy_stage.shapers.toml")).unwrap();
    assert_eq!(tables.sample_hz, 1000.0);
    for (axis, (frequency, damping)) in tables
        .axes
        .iter()
        .zip([(131.117015808451, 0.157799065776), (93.2897800884888, 0.153542487341)])
    {
        assert_eq!((axis.lsb_per_unit, axis.tables.len()), (256e3, 2));
        let (_, shapers) = axis.shaper().unwrap();
        let mode = Mode {
            frequency_hz: frequency,
            damping,
        };
        let residual = |table| residual_vibration(&tap_impulses(table, 1000.0), &mode);
        assert!(residual(&shapers[0]) < 1e-3, "{}: {}", axis.name, residual(&shapers[0]));
        assert!((residual(&shapers[1]) - 1.0).abs() < 1e-9);
    }
}

/// G38 moves to the touch: `[capture]` is LinuxCNC's probe, and a machine without one leaves that pin alone.
#[test]
fn cli_hal_wires_the_touch_probe_of_a_stage_that_captures() {
    let folder = tempfile::tempdir().unwrap();
    for (machine, name, has_probe) in [
        ("line-scan.toml", "line_scan", false),
        ("measuring-arm.toml", "measuring_arm", true),
    ] {
        let package = folder.path().join(name);
        generated(&example(machine), &package);
        let hal = std::fs::read_to_string(package.join("hal").join(format!("{name}.hal"))).unwrap();
        let wire = "net probe posicast.probe-input => motion.probe-input";
        assert_eq!(hal.lines().any(|line| line == wire), has_probe, "{hal}");
    }
}

#[test]
fn cli_hal_without_a_stage_writes_the_tables_alone() {
    let folder = tempfile::tempdir().unwrap();
    generated(&example("custom-shaper.toml"), folder.path());
    let files = std::fs::read_dir(folder.path().join("hal")).unwrap();
    let names: Vec<_> = files.map(|file| file.unwrap().file_name()).collect();
    assert_eq!(names, ["pick_and_place.shapers.toml"]);
}

#[test]
fn cli_hal_refuses_a_rate_that_does_not_suit_the_stage() {
    let folder = tempfile::tempdir().unwrap();
    for (rate, said) in [
        ("3000", "whole multiple of it, 2 to 256 times"),
        ("10000", "whole multiple of it, 2 to 256 times"),
        ("0", "allowed: above 0"),
        ("nan", "allowed: above 0"),
    ] {
        let mut generate = posicast();
        generate
            .arg("generate")
            .arg(example("xy-stage.toml"))
            .args(["--hal", "--servo-hz", rate, "-o"])
            .arg(folder.path());
        generate.assert().code(2).stderr(predicates::str::contains(said));
    }
    assert!(
        std::fs::read_dir(folder.path()).unwrap().next().is_none(),
        "nothing is written"
    );
}
