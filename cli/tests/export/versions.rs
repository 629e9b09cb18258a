//! What is written depends on the version of the firmware, which the output names.

use super::readers;
use super::{export, mode, printer, refused, residual};
use crate::cli::support::scratch;

/// The case of a printer under RepRapFirmware 3.6, derived by hand: H are single amplitudes of mzv, T counts from the first impulse.
#[test]
fn cli_reprapfirmware_3_6_takes_amplitudes_and_delays_from_the_first_impulse() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"mzv\"", &mode(52.4, 0.06))]));
    let newest = export(&machine, &["--to", "reprapfirmware"]);
    let line = "M593 P\"custom\" H0.3354817:0.4117903 T0.0071694:0.0143388\n";
    assert!(
        newest.contains(line) && newest.contains("for RepRapFirmware 3.6 and later"),
        "{newest}"
    );
    let older = export(&machine, &["--to", "reprapfirmware", "--firmware-version", "3.5.4"]);
    let old_line = "M593 P\"custom\" H0.3354817:0.7472720 T0.0071694:0.0071694\n";
    assert!(
        older.contains(old_line) && older.contains("for RepRapFirmware 3.5.4"),
        "{older}"
    );
    // Read by the other version, either makes the printer ring.
    assert!(residual(&readers::reprapfirmware(&newest, true), 52.4, 0.06) < 1e-4);
    let swapped = newest
        .replace("0.4117903", "0.7472720")
        .replace("0.0143388", "0.0071695");
    assert!(residual(&readers::reprapfirmware(&swapped, true), 52.4, 0.06) > 0.4);
}

#[test]
fn cli_two_impulses_of_reprapfirmware_3_6_need_no_times() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"zv\"", &mode(52.4, 0.06))]));
    let text = export(&machine, &["--to", "reprapfirmware"]);
    assert!(
        !text.lines().any(|line| line.starts_with("M593") && line.contains(" T")),
        "{text}"
    );
    let older = export(&machine, &["--to", "reprapfirmware", "--firmware-version", "3.5"]);
    assert!(older.contains(" T0.00"), "{older}");
    let (_folder, low) = scratch(&printer(&[("x", "kind = \"zv\"", &mode(3.0, 0.06))]));
    assert!(refused(&low, &["--to", "reprapfirmware"]).contains("three impulses"));
    let (_folder, none) = scratch(&printer(&[("x", "kind = \"none\"", "")]));
    assert!(export(&none, &["--to", "reprapfirmware"]).contains("\nM593 P\"none\"\n"));
}

#[test]
fn cli_klippers_z_axis_and_tolerances_need_new_versions() {
    let (_folder, z) = scratch(&printer(&[("z", "kind = \"zv\"", &mode(30.0, 0.1))]));
    let text = export(&z, &["--to", "klipper"]);
    assert!(
        text.contains("shaper_freq_z: 30.0\n") && text.contains("April 2026"),
        "{text}"
    );
    for older in ["0.12", "v0.13.0", "v0.13.0-325-gabcdef", "2025-10-03"] {
        let said = refused(&z, &["--to", "klipper", "--firmware-version", older]);
        assert!(said.contains("shapes the axes x and y"), "{older}: {said}");
    }
    let (_folder, ei) = scratch(&printer(&[("x", "kind = \"ei\"\ntolerance = 0.1", &mode(52.4, 0.06))]));
    let text = export(&ei, &["--to", "klipper"]);
    assert!(text.contains("shaper_type_x: ei(v_tol=0.1)\n"), "{text}");
    let said = refused(&ei, &["--to", "klipper", "--firmware-version", "2026-03-31"]);
    assert!(
        said.contains("tolerance of 0.05") && said.contains("v0.13.0-633"),
        "{said}"
    );
    let (_folder, hump) = scratch(&printer(&[("x", "kind = \"three-hump-ei\"", &mode(52.4, 0.06))]));
    let warned = export(&hump, &["--to", "klipper", "--firmware-version", "2026-03-30"]);
    assert!(
        warned.contains("3hump_ei is right from Klipper v0.13.0-594"),
        "{warned}"
    );
    assert!(!export(&hump, &["--to", "klipper"]).contains("right from"));
}

#[test]
fn cli_a_damping_ratio_beyond_the_versions_limit_is_refused_or_written_as_impulses() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"three-hump-ei\"", &mode(40.0, 0.25))]));
    let said = refused(&machine, &["--to", "klipper"]);
    assert!(said.contains("up to 0.2") && said.contains("choose zv"), "{said}");
    assert!(export(&machine, &["--to", "klipper", "--firmware-version", "0.13.0"]).contains("3hump_ei"));
    let (_folder, zv) = scratch(&printer(&[("x", "kind = \"zv\"", &mode(40.0, 0.3))]));
    let text = export(&zv, &["--to", "klipper", "--firmware-version", "advanced-features"]);
    assert!(text.contains("shaper_type_x: custom\n"), "{text}");
}

#[test]
fn cli_marlin_has_a_z_axis_since_2_1_3_and_its_fixed_time_motion_two_versions() {
    let (_folder, z) = scratch(&printer(&[("z", "kind = \"zv\"", &mode(30.0, 0.1))]));
    assert!(export(&z, &["--to", "marlin"]).contains("\nM593 Z F"));
    assert!(refused(&z, &["--to", "marlin", "--firmware-version", "2.1.2.5"]).contains("x and y"));
    let (_folder, y) = scratch(&printer(&[("y", "kind = \"ei\"", &mode(50.0, 0.1))]));
    assert!(export(&y, &["--to", "marlin-ft"]).contains("\nM493 Y C5 A50.0000 I0.100000 Q0.05\n"));
    let older = export(&y, &["--to", "marlin-ft", "--firmware-version", "1"]);
    assert!(older.contains("\nM493 Y5 B50.0000 J0.100000 R0.05\n"), "{older}");
}

#[test]
fn cli_a_version_that_does_not_exist_is_refused_with_those_that_do() {
    let (_folder, machine) = scratch(&printer(&[("x", "kind = \"zv\"", &mode(50.0, 0.1))]));
    for (format, version, known) in [
        ("klipper", "0.13.x", "2026-03-31"),
        ("klipper", "0.8", "0.9"),
        ("kalico", "1st", "bleeding-edge"),
        ("marlin", "1.1.9", "2.1.2"),
        ("marlin-ft", "3", "M493 V"),
        ("reprapfirmware", "3.3", "3.4 and later"),
    ] {
        let said = refused(&machine, &["--to", format, "--firmware-version", version]);
        assert!(said.contains("--firmware-version") && said.contains(known), "{said}");
    }
    let said = refused(&machine, &["--to", "csv", "--firmware-version", "1"]);
    assert!(said.contains("leave out --firmware-version"), "{said}");
    assert!(refused(&machine, &["--to", "c", "--closest"]).contains("leave out --closest"));
}
