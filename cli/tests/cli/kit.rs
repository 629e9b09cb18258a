//! The integration kit of machines that have only shapers.

use super::support::{example, generate};
use std::path::Path;
use std::process::{Command, Output};

fn generated(machine: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    generate(&example(machine), &folder.path().join("out"));
    folder
}

/// Runs the command line that the kit's README shows.
fn bench(folder: &Path, name: &str) -> Output {
    let line = format!(
        "iverilog -g2012 -o bench.vvp -f filelist.f kit/{name}_strobe.v kit/{name}_example.v kit/{name}_bench.v && vvp bench.vvp"
    );
    let readme = std::fs::read_to_string(folder.join("kit/README.md")).unwrap();
    for part in line.split(" && ") {
        assert!(readme.contains(part), "kit/README.md does not say `{part}`");
    }
    Command::new("sh")
        .args(["-c", &line])
        .current_dir(folder)
        .output()
        .unwrap()
}

fn lint(folder: &Path, name: &str) {
    let files = [format!("kit/{name}_strobe.v"), format!("kit/{name}_example.v")];
    let mut verilator = Command::new("verilator");
    verilator.args([
        "--lint-only",
        "-Wall",
        "-f",
        "filelist.f",
        "--top-module",
        &format!("{name}_example"),
    ]);
    let output = verilator.args(files).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn cli_the_kits_example_is_clean_and_its_bench_passes() {
    for (machine, name) in [
        ("robot-joint.toml", "robot_joint"),
        ("custom-shaper.toml", "pick_and_place"),
        ("varying-load.toml", "boom"),
    ] {
        let folder = generated(machine);
        let out = folder.path().join("out");
        lint(&out, name);
        let output = bench(&out, name);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && said.ends_with("PASS\n"), "{said}");
    }
}

#[test]
fn cli_the_kits_bench_detects_a_damaged_table() {
    let folder = generated("robot-joint.toml");
    let out = folder.path().join("out");
    let rom = out.join("rtl/robot_joint_elbow_machine_taps.v");
    let text = std::fs::read_to_string(&rom).unwrap();
    // The coefficient is at the low end of the word.
    let (before, after) = text.split_once("] = 26'h").expect("a word of the table");
    let digits = after.find(|c: char| !c.is_ascii_hexdigit()).unwrap();
    let word = u64::from_str_radix(&after[..digits], 16).unwrap() ^ 1;
    std::fs::write(&rom, format!("{before}] = 26'h{word:x}{}", &after[digits..])).unwrap();
    let output = bench(&out, "robot_joint");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        !output.status.success() && said.contains("FAILED: axis elbow"),
        "{said}"
    );
}

#[test]
fn cli_the_template_fits_the_top_module() {
    let folder = generated("robot-joint.toml");
    let out = folder.path().join("out");
    let template = std::fs::read_to_string(out.join("kit/robot_joint_template.v")).unwrap();
    let own = format!(
        "module own (input wire clk, input wire rst, input wire strobe, input wire signed [31:0] elbow_command,\n\
         output wire signed [31:0] elbow_shaped);\n{template}endmodule\n"
    );
    std::fs::write(out.join("own.v"), own).unwrap();
    let position = "Command of axis elbow: its position in counts, with 8 fraction bits";
    assert!(template.contains(position), "{template}");
    // Some tools for Verilog cannot read other characters.
    assert!(template.is_ascii(), "{template}");
    let mut verilator = Command::new("verilator");
    verilator.args(["--lint-only", "-Wall", "-Wno-DECLFILENAME", "-Wno-PINCONNECTEMPTY"]);
    verilator.args(["-f", "filelist.f", "own.v", "--top-module", "own"]);
    let output = verilator.current_dir(&out).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Runs `make` of the kit with these settings and with the Python packages' programs on the path.
fn make(out: &Path, settings: &[&str]) -> Output {
    let packaged = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin");
    let path = std::env::var("PATH").unwrap();
    let mut make = Command::new("make");
    make.args(["-C", "kit/lattice"])
        .args(settings)
        .env("PATH", format!("{}:{path}", packaged.display()))
        .current_dir(out);
    make.output().unwrap()
}

#[test]
fn long_cli_the_kits_example_is_placed_by_nextpnr() {
    let folder = generated("robot-joint.toml");
    let out = folder.path().join("out");
    let output = make(&out, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(out.join("kit/lattice/robot_joint.config").is_file());
}

#[test]
fn cli_the_kits_makefile_says_which_tool_is_missing_and_how_to_get_it() {
    let folder = generated("robot-joint.toml");
    let out = folder.path().join("out");
    for (setting, missing) in [("YOSYS=", "yosys"), ("NEXTPNR=", "nextpnr-ecp5")] {
        let output = make(&out, &[setting]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let expected = format!("{missing} is not installed: `pip install yowasp-{missing}` has it");
        assert!(!output.status.success() && said.contains(&expected), "{said}");
    }
    // What needs no tool works without.
    assert!(make(&out, &["NEXTPNR=", "YOSYS=", "clean"]).status.success());
}

#[test]
fn long_cli_the_kits_pll_makes_the_clock_of_the_machine_as_nextpnr_derives_it() {
    let folder = generated("robot-joint.toml");
    let out = folder.path().join("out");
    // 12 MHz need both dividers of the feedback.
    for oscillator_hz in ["12000000", "25000000"] {
        let output = make(&out, &[&format!("OSCILLATOR_HZ={oscillator_hz}")]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        let derived = "Derived frequency constraint of 50.0 MHz for net clk";
        assert!(said.contains(derived), "{said}");
        assert!(
            out.join(format!("kit/lattice/robot_joint_{oscillator_hz}.config"))
                .is_file()
        );
    }
    let output = make(&out, &["OSCILLATOR_HZ=7000000"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !output.status.success() && said.contains("has_no_dividers_for_this_oscillator"),
        "{said}"
    );
}
