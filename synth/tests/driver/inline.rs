//! The C driver of an inline shaper: compiled strictly, and run against the model with a controller at its pins.

use crate::driver::bridge::{self, Asked};
use crate::driver::support::{STRICT, beside, run};
use posicast_blocks::component::Component;
use posicast_closed_loop::inline_bench::InlineBench;
use posicast_closed_loop::linked_bench::Registered;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_synth::driver::{FOLDER, inline_files};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Clocks that pass when the program pauses.
const PAUSE_CLOCKS: u64 = 20_000;

fn machine() -> Machine {
    let text = include_str!("../../../examples/inline.toml");
    machine_file::parse("inline.toml", &format!("{text}[link]\nbaud = 3_000_000\n")).unwrap()
}

fn component(machine: &Machine) -> Component {
    let design = design_machine(machine).unwrap();
    let hardware = Hardware::of(machine, &design).unwrap();
    hardware.inline().unwrap().unwrap().component.clone().unwrap()
}

/// The driver in a folder.
fn driver(component: &Component) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for file in inline_files("router", &["x", "y", "z"], component.map()) {
        let path = folder.path().join(&file.path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &file.text).unwrap();
    }
    let path = folder.path().join(FOLDER);
    (folder, path)
}

/// The program of the test, with the driver.
fn program(driver: &Path) -> PathBuf {
    let program = driver.join("program");
    run(Command::new("gcc")
        .args(STRICT)
        .args([
            "-O1",
            "-fsanitize=undefined",
            "-fno-sanitize-recover=all",
            "-DPOSICAST_ACCESS_FUNCTIONS",
        ])
        .arg("-I")
        .arg(driver.join("inc"))
        .arg(beside("inline.c"))
        .arg(driver.join("src/posicast_inline.c"))
        .arg("-o")
        .arg(&program));
    program
}

#[test]
fn the_driver_of_an_inline_shaper_needs_no_library_and_its_headers_compile_alone() {
    let (_folder, driver) = driver(&component(&machine()));
    let inc = driver.join("inc");
    let compile = |compiler: &str, options: &[&str], file: PathBuf| {
        run(Command::new(compiler)
            .args(options)
            .arg("-I")
            .arg(&inc)
            .arg("-c")
            .arg(file)
            .arg("-o")
            .arg(driver.join("object.o")));
    };
    let strict = |more: &[&'static str]| [&STRICT[..], more].concat();
    let source = || driver.join("src/posicast_inline.c");
    compile("gcc", &strict(&["-O2", "-ffreestanding"]), source());
    let riscv = ["-O2", "-ffreestanding", "-march=rv32im", "-mabi=ilp32"];
    compile("riscv64-unknown-elf-gcc", &strict(&riscv), source());
    for header in std::fs::read_dir(&inc).unwrap() {
        let header = header.unwrap().path();
        compile("gcc", &strict(&["-x", "c"]), header.clone());
        compile(
            "g++",
            &["-std=c++11", "-Wall", "-Wextra", "-Werror", "-x", "c++"],
            header,
        );
    }
}

#[test]
fn a_program_reads_counts_ends_the_shaping_and_loads_tables() {
    let component = component(&machine());
    let (_folder, driver) = driver(&component);
    let mut bench = InlineBench::new(&component, 1).unwrap();
    // The axes begin at a tick.
    bench.clocks(20_000).unwrap();
    let said = bridge::talk(&program(&driver), &[], &mut |asked| {
        match asked {
            Asked::Read(word) => {
                let data = bench.read_at(word).unwrap();
                bench.clocks(100).unwrap();
                return Some(data);
            }
            Asked::Write(word, data) => bench.write_at(word, data).unwrap(),
            Asked::Pause => bench.clocks(PAUSE_CLOCKS).unwrap(),
            Asked::Line("x_down", steps) => bench.steps("x", -(steps as i64)).unwrap(),
            Asked::Line(_, steps) => bench.steps("x", steps as i64).unwrap(),
        }
        None
    });
    let of = |names: &[&str]| names.iter().map(|name| said[*name]).collect::<Vec<_>>();
    assert_eq!(of(&["opened", "axes", "read"]), [0, 3, 0], "{said:?}");
    assert_eq!(of(&["input", "given", "owed", "causes"]), [100, 100, 0, 0], "{said:?}");
    // The results of posicast_result.h.
    let [bad_argument, wrong_state] = [3, 4];
    assert_eq!(
        of(&["no_axis", "wrong", "in_use"]),
        [bad_argument, bad_argument, wrong_state],
        "{said:?}"
    );
    assert_eq!(of(&["bypass", "bypassed", "shape"]), [0, 1, 0], "{said:?}");
    assert_eq!(
        of(&["load", "read_tap", "delay", "coefficient"]),
        [0, 0, 60, 1 << 15],
        "{said:?}"
    );
    assert_eq!(
        of(&["machine", "input_after", "given_after"]),
        [0, -50, -50],
        "{said:?}"
    );
}

/// What the driver says of constants, one of them changed.
fn opened(component: &Component, program: &Path, changed: (&str, u32)) -> BTreeMap<String, i64> {
    bridge::talk(program, &["constants"], &mut |asked| match asked {
        Asked::Read(word) => {
            let register = component.map().registers().iter().find(|of| of.offset == word).unwrap();
            Some(if register.name == changed.0 {
                changed.1
            } else {
                register.reset()
            })
        }
        _ => None,
    })
}

#[test]
fn another_inline_shaper_is_refused() {
    let component = component(&machine());
    let (_folder, driver) = driver(&component);
    let program = program(&driver);
    let [not_found, version, other] = [1, 2, 12];
    for (changed, result) in [
        (("magic", 0), not_found),
        (("version", 2 << 16), version),
        (("axes", 2), other),
        (("machine_crc", 0), other),
        (("version", 1 << 16 | 7), 0),
    ] {
        assert_eq!(opened(&component, &program, changed)["opened"], result, "{changed:?}");
    }
}
