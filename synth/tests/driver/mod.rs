//! The C driver: compiled by gcc and for a RISC-V, its integers compared with the model's, and run against the
//! stage's Verilog.

mod absolute;
mod bridge;
mod error_table;
mod family;
mod frames;
mod identify;
mod inline;
mod integers;
mod path;
mod steps;
pub(crate) mod support;
mod udp;

use bridge::{Bridge, INDEX_AT};
use posicast_blocks::component::Component;
use posicast_blocks::sliding_mode::{Gain, SettingRow};
use posicast_machine::machine_file::{self, Machine};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;
use support::{Driver, STRICT, beside, machine, run, stage, traced_machine};

fn compile(command: &mut Command, driver: &Driver, files: &[PathBuf]) {
    for file in files {
        let object = driver.path().join("object.o");
        run(Command::new(command.get_program())
            .args(command.get_args())
            .arg("-I")
            .arg(driver.path().join("inc"))
            .arg("-c")
            .arg(file)
            .arg("-o")
            .arg(object));
    }
}

#[test]
fn the_core_needs_no_library_and_no_operating_system() {
    let driver = Driver::of(traced_machine());
    compile(
        Command::new("gcc").args(STRICT).args(["-O2", "-ffreestanding"]),
        &driver,
        &driver.core(),
    );
    // This is the instruction set of a Nios V, and the closest available to a Nios II.
    let riscv = ["-O2", "-ffreestanding", "-march=rv32im", "-mabi=ilp32"];
    compile(
        Command::new("riscv64-unknown-elf-gcc").args(STRICT).args(riscv),
        &driver,
        &driver.core(),
    );
}

#[test]
fn headers_compile_alone_in_c_and_in_cpp() {
    let driver = Driver::of(traced_machine());
    for entry in std::fs::read_dir(driver.path().join("inc")).unwrap() {
        let header = entry.unwrap().path();
        let cpp = ["-std=c++11", "-Wall", "-Wextra", "-Werror"];
        let header = [header];
        compile(Command::new("gcc").args(STRICT).args(["-x", "c"]), &driver, &header);
        compile(Command::new("g++").args(cpp).args(["-x", "c++"]), &driver, &header);
    }
}

#[test]
fn the_variant_for_linux_builds_and_refuses_other_files_than_devices() {
    let driver = Driver::write();
    let linux = driver.path().join("linux");
    run(Command::new("make").arg("-C").arg(&linux));
    let program = driver.path().join("open.c");
    std::fs::write(
        &program,
        "#include <errno.h>\n#include \"posicast_uio.h\"\nint main(void)\n{\n    posicast_uio device;\n    \
         return posicast_uio_open(&device, \"/dev/does-not-exist\") == -1 && errno == ENOENT ? 0 : 1;\n}\n",
    )
    .unwrap();
    let built = driver.path().join("open");
    let mut gcc = Command::new("gcc");
    gcc.args(STRICT)
        .arg("-I")
        .arg(driver.path().join("inc"))
        .arg("-I")
        .arg(&linux);
    run(gcc.arg(&program).arg(linux.join("libposicast.a")).arg("-o").arg(&built));
    run(&mut Command::new(built));
}

#[test]
fn the_overlay_is_one() {
    let driver = Driver::write();
    let overlay = driver.path().join("linux/xy_stage.dtso");
    run(Command::new("dtc")
        .args(["-@", "-I", "dts", "-O", "dtb", "-o", "/dev/null"])
        .arg(overlay));
}

/// The program without an operating system builds as its Makefile says.
#[test]
fn the_bare_metal_program_builds() {
    let driver = Driver::of(traced_machine());
    let folder = driver.path().join("bare_metal");
    run(Command::new("make").arg("-C").arg(&folder));
    assert!(folder.join("xy_stage.elf").is_file());
    compile(
        Command::new("gcc").args(STRICT).arg("-ffreestanding"),
        &driver,
        &[folder.join("main.c")],
    );
}

/// Each axis moves there and back, and is off at the end.
#[test]
fn lockstep_the_bare_metal_program_moves_every_axis() {
    let driver = Driver::write();
    let mut bridge = Bridge::new(&driver, "bare_metal.c", false);
    let farthest = [Cell::new(0), Cell::new(0)];
    let said = bridge.talk_beside(&[], |bench| {
        for (axis, farthest) in farthest.iter().enumerate() {
            farthest.set(bench.plant(axis).count().max(farthest.get()));
        }
    });
    assert_eq!(
        (said["ended"], said["causes_x"], said["causes_y"]),
        (0, 0, 0),
        "{said:?}"
    );
    assert_eq!((said["command_x"], said["command_y"]), (0, 0), "{said:?}");
    for (axis, farthest) in farthest.iter().enumerate() {
        let at = bridge.bench.plant(axis).count();
        assert!(
            at.abs() <= 1 && (99..=101).contains(&farthest.get()),
            "{at}, {farthest:?}"
        );
    }
}

/// `alt_sys_init` and an interrupt, with headers that replace those of the HAL.
#[test]
fn the_hal_finds_the_stage_and_takes_its_interrupt() {
    let driver = Driver::write();
    let hal = driver.path().join("HAL");
    let includes = [hal.join("inc"), beside("hal")].map(|folder| format!("-I{}", folder.display()));
    let files = [hal.join("src/posicast_stage_hal.c"), beside("hal/system.c")];
    let program = driver.program("hal", &["-DPOSICAST_HAL", &includes[0], &includes[1]], &files);
    run(&mut Command::new(program));
}

/// `_sw.tcl` in a Tcl that knows its two commands: every file that it names exists, and every C file is named.
#[test]
fn the_bsp_finds_every_file() {
    let driver = Driver::of(traced_machine());
    let script = driver.path().join("check.tcl");
    std::fs::write(
        &script,
        "proc create_driver {name} {}\nproc set_sw_property {name value} {puts \"$name $value\"}\n\
         proc add_sw_property {name value} {puts \"$name $value\"}\nsource xy_stage_stage_sw.tcl\n",
    )
    .unwrap();
    let said = run(Command::new("tclsh").arg("check.tcl").current_dir(driver.path()));
    let of = |kind: &str| -> Vec<PathBuf> {
        let lines = said.lines().filter_map(|line| line.strip_prefix(kind));
        lines.map(|name| driver.path().join(name.trim())).collect()
    };
    for file in [of("c_source "), of("include_source "), of("include_directory ")].concat() {
        assert!(file.exists(), "{}", file.display());
    }
    assert!(driver.core().iter().all(|file| of("c_source ").contains(file)));
    assert!(said.contains("hw_class_name xy_stage_stage\n"), "{said}");
}

#[test]
fn a_program_moves_the_model_of_the_stage_and_handles_a_fault() {
    a_program_moves_the_stage_and_handles_a_fault(false);
}

/// The processor's test has the Verilog beside the model too, with another program.
#[test]
fn long_lockstep_a_program_moves_the_stage_and_handles_a_fault() {
    a_program_moves_the_stage_and_handles_a_fault(true);
}

fn a_program_moves_the_stage_and_handles_a_fault(with_verilog: bool) {
    let driver = Driver::write();
    let mut bridge = Bridge::new(&driver, "scenario.c", with_verilog);
    let said = bridge.talk(&[]);
    // The moves are 40 and -25 counts from 0: the command agrees to the last bit, the motor to its count.
    assert_eq!(
        (said["command_x"], said["command_y"]),
        (40 * 256, -25 * 256),
        "{said:?}"
    );
    assert!((said["x"] - 40).abs() <= 1 && (said["y"] + 25).abs() <= 1, "{said:?}");
    // It is held in RUN at the far end, and returns to the last bit.
    assert_eq!((said["held_at"], said["held_state"]), (60 * 256, 3), "{said:?}");
    assert_eq!((said["resumed_to"], said["held_causes"]), (40 * 256, 0), "{said:?}");
    assert_eq!(said["after_fault_x"], 90 * 256);
    let at = bridge.bench.plant(0).count();
    assert!((at - 90).abs() <= 1, "{at}");
    // The PWM tripped, and the group stopped.
    assert_eq!(
        (said["causes_x"], said["causes_y"], said["causes_after"]),
        (1 << 1, 1 << 14, 0)
    );
    assert_eq!((said["named"], said["interrupt"]), (1, 1));
    assert_eq!(bridge.bench.mismatches(), (0, None));
}

/// Streams a circle with a point per millisecond, three points ahead; once the program is late, and once it does not
/// return.
#[test]
fn a_stream_is_worth_its_bus() {
    let driver = Driver::write();
    let mut bridge = Bridge::new(&driver, "stream.c", false);
    let said = bridge.talk(&[]);
    // At most 16 accesses per axis and millisecond are allowed; there are 4 writes and 2 reads.
    assert_eq!(said["most_accesses"], 2 * 6 + 1, "{said:?}");
    // Both axes are late by the same time, which is what was not ahead; then they are on the path to its end, to the
    // last bit.
    assert!(
        (5..=20).contains(&said["late_x"]) && said["late_x"] == said["late_y"],
        "{said:?}"
    );
    assert_eq!(
        (said["turned_to_x"], said["turned_to_y"], said["turn_causes"]),
        (0, 0, 0),
        "{said:?}"
    );
    assert_eq!(said["went_on_to_x"], 256, "{said:?}");
    // Points that come too early are refused when the FIFO is full. A point that one axis cannot reach is written for
    // no axis.
    assert_eq!((said["written_early"], said["level_after_far"]), (63, 0), "{said:?}");
    // The axis extrapolates 25 ticks at 0.18 counts each and stops within a count; the cause is that of the segments.
    assert_eq!(
        (said["missing_causes"] & 1 << 12, said["named"], said["causes_after"]),
        (1 << 12, 1, 0),
        "{said:?}"
    );
    assert!((4 * 256..6 * 256).contains(&said["beyond"]), "{said:?}");
}

#[test]
fn tables_are_loaded_and_the_pwm_tests_itself() {
    let driver = Driver::write();
    let mut bridge = Bridge::new(&driver, "scenario.c", false);
    let said = bridge.talk(&["tables"]);
    // Locked antiphase, 2500 clocks, dead time 25, duty -101: as in the tests of the stage.
    assert_eq!((said["high"], said["low"]), (1199 - 25, 2500 - (1199 - 25) - 50));
    assert_eq!((said["machine_taps"], said["bank"], said["settle"]), (1, 1, 126));
    let back = ["read_empty", "read_back", "read_machine", "read_count"].map(|what| said[what]);
    assert_eq!(back, [1, 1, 1, 2], "{said:?}");
    assert_eq!((said["x"], said["causes"]), (400 * 256, 0));
    assert!(said["off"] <= 1, "{said:?}");
    let at = bridge.bench.plant(0).count();
    assert!((at - 400).abs() <= 1, "{at}");
}

#[test]
fn settings_change_between_two_ticks() {
    let driver = Driver::write();
    let mut bridge = Bridge::new(&driver, "scenario.c", false);
    let said = bridge.talk(&["settings"]);
    assert!(said["without_command"].abs() <= 1, "{said:?}");
    assert!((said["with_command"] - 20).abs() <= 1, "{said:?}");
    assert_eq!((said["causes"], said["unchanged"]), (0, 0x1_ffff), "{said:?}");
    let back = ["read_back", "read_machine", "read_unwritten"].map(|what| said[what]);
    assert_eq!(back, [1, 1, 0], "{said:?}");
    let value = Gain::from_word(said["gain"] as u32).value(SettingRow::Proportional);
    let wanted = Gain::nearest(1.5 * value, SettingRow::Proportional).unwrap();
    assert_eq!(Gain::from_word(said["gain_3_2"] as u32), wanted);
}

/// The home switch is pressed from 30 counts on; the index comes before it.
#[test]
fn an_axis_is_homed_and_looked_at() {
    let driver = Driver::of(traced_machine());
    let mut bridge = Bridge::new(&driver, "bring_up.c", false);
    let said = bridge.talk_beside(&[], |bench| {
        let is_pressed = bench.plant(0).count() >= 30;
        bench.set("x_home", is_pressed.into()).unwrap();
    });
    // The index agrees to the count, the switch within the speed of the search.
    assert_eq!(
        (said["origin_by_index"], said["index_setup"]),
        (INDEX_AT - 1000, 0),
        "{said:?}"
    );
    assert!((said["origin_by_switch"] - 30).abs() <= 1, "{said:?}");
    assert_eq!(said["origin_moves"], 0, "{said:?}");
    assert_eq!((said["homed_before"], said["homed_after"]), (0, 1), "{said:?}");
    assert_eq!(
        (said["limit_minus"], said["limit_plus"]),
        (800 << 8, 1200 << 8),
        "{said:?}"
    );
    // There are 64 rows of four signals, and a square of 3 counts, which the axis follows.
    assert_eq!((said["rows"], said["trigger_row"]), (64, 0), "{said:?}");
    assert_eq!((said["most"], said["least"]), (3 << 8, -(3 << 8)), "{said:?}");
    assert!(said["moved"] >= 4, "{said:?}");
    assert_eq!(said["causes"], 0);
}

/// The constants of a stage, one of them perhaps of another stage, and what the driver of `machine` says of them.
fn opened(machine: Machine, changed: Option<(&str, u32)>) -> BTreeMap<String, i64> {
    let driver = Driver::of(machine);
    let component = Component::stage(&stage(&driver.machine).config).unwrap();
    let program = driver.program("refused", &["-DPOSICAST_ACCESS_FUNCTIONS"], &[beside("refused.c")]);
    bridge::talk(&program, &[], &mut |asked| match asked {
        bridge::Asked::Read(word) => {
            let register = component.map().registers().iter().find(|of| of.offset == word).unwrap();
            let changed = changed.filter(|(name, _)| register.name == *name);
            Some(changed.map_or(register.reset(), |(_, word)| word))
        }
        _ => None,
    })
}

#[test]
fn a_stage_of_another_machine_file_is_refused_with_both_values() {
    let text = include_str!("../../../examples/xy-stage.toml").to_owned() + "[link]\nbaud = 3_000_000\n";
    let linked = || machine_file::parse("xy-stage.toml", &text).unwrap();
    let crc = linked().link.unwrap().machine_crc;
    // The results of posicast_result.h, and the constants of the example.
    let [not_found, version, other] = [1, 2, 12];
    for (name, found, refused, wanted) in [
        ("magic", 0, not_found, u32::from_le_bytes(*b"STGE")),
        ("version", 3 << 16, version, 2 << 16 | 2),
        ("version", 2 << 16 | 1, version, 2 << 16 | 2),
        ("machine_crc", !crc, other, crc),
        ("axes", 4, other, 2),
        ("tick_clocks", 2500, other, 5000),
    ] {
        let said = opened(linked(), Some((name, found)));
        assert_eq!(
            (said["opened"], said["found"], said["wanted"]),
            (refused, i64::from(found), i64::from(wanted)),
            "{name}: {said:?}"
        );
        assert_eq!(said[&name.to_uppercase()], 1, "{said:?}");
    }
    for (machine, changed) in [
        (linked(), None),
        // A larger minor version has registers that this driver does not use.
        (linked(), Some(("version", 2 << 16 | 3))),
        // Without [link], there is no checksum to compare.
        (machine(), Some(("machine_crc", 0))),
    ] {
        let said = opened(machine, changed);
        assert_eq!((said["opened"], said["nothing"]), (0, 1), "{said:?}");
    }
}

#[test]
fn the_driver_does_not_hang_where_nothing_answers() {
    let driver = Driver::write();
    let program = driver.program("absent", &["-DPOSICAST_ACCESS_FUNCTIONS"], &[beside("scenario.c")]);
    bridge::talk(&program, &["absent"], &mut |_| Some(0));
    // This program reads only constants: the clock stands still.
    let machine = machine();
    let component = Component::stage(&stage(&machine).config).unwrap();
    bridge::talk(&program, &["dead"], &mut |asked| match asked {
        bridge::Asked::Read(word) => {
            let found = component
                .map()
                .registers()
                .iter()
                .find(|register| register.offset == word);
            Some(found.map_or(0, |register| register.reset()))
        }
        _ => None,
    });
}
