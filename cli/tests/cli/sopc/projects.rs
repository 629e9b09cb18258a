//! Projects: pins and timing of every port of the top level.

use super::{BOARDS, check_project, check_system, findings, lint, package, replace, verilog_ports, xy_stage};
use crate::cli::support::{example, generate, scratch};
use predicates::str::contains;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Checks pins and timing of a project: `folder` is below `sopc/quartus`, `ends` are the registers at which false paths end.
pub(super) fn places_and_constrains(
    output: &Path,
    (folder, name): (&str, &str),
    (quartus, clock_pin, device): (&str, &str, &str),
    ends: &[&str],
) {
    let project = output.join("sopc/quartus").join(folder);
    let ports = verilog_ports(&project.join(format!("{name}.v")));
    let (settings, content) = check_project(quartus, &project.join(format!("{name}.qsf")), &ports);
    assert!(content, "{:#?}", findings(&settings));
    let pins: BTreeMap<&str, &str> = settings
        .iter()
        .filter(|record| record[0] == "pin")
        .map(|record| (record[1].as_str(), record[2].as_str()))
        .collect();
    assert_eq!(
        pins.keys().copied().collect::<Vec<_>>(),
        ports.keys().map(String::as_str).collect::<Vec<_>>()
    );
    assert_eq!(pins["clock_50"], clock_pin);
    let global = |name: &str| {
        settings
            .iter()
            .find(|record| record[0] == "global" && record[1] == name)
            .unwrap()[2..]
            .join(" ")
    };
    assert_eq!(global("DEVICE"), device);
    assert_eq!(global("TOP_LEVEL_ENTITY"), name);
    assert_eq!(
        global("RESERVE_ALL_UNUSED_PINS_WEAK_PULLUP"),
        "AS INPUT TRI-STATED WITH WEAK PULL-UP"
    );
    // A broken wire must not read as healthy.
    for line in ["emergency_stop_n", "x_fault_n", "x_limit_plus_n", "y_drive_ready"] {
        let off = ["assignment", line, "WEAK_PULL_UP_RESISTOR", "OFF"];
        assert!(settings.iter().any(|record| record[..] == off), "{line}");
    }

    let (timing, content) = check_project(quartus, &project.join(format!("{name}.sdc")), &ports);
    assert!(content, "{:#?}", findings(&timing));
    assert!(
        timing
            .iter()
            .any(|record| record[..] == ["clock", "clock_50", "20.000"])
    );
    for port in ports.keys().filter(|port| *port != "clock_50") {
        let delays = timing
            .iter()
            .filter(|record| record[0] == "delay" && record[1] == *port);
        assert_eq!(delays.count(), 2, "{port}");
    }
    // False paths end only at first flip-flops and fault latches; registers of these names are in the RTL.
    let found: BTreeSet<String> = timing
        .iter()
        .filter(|record| record[0] == "false_path")
        .map(|record| record[2..].join(" "))
        .collect();
    assert_eq!(found.iter().map(String::as_str).collect::<Vec<_>>(), ends);
    let rtl = |module: &str| fs::read_to_string(output.join(format!("rtl/{module}.v"))).unwrap();
    assert!(rtl("posicast_synchroniser").contains("reg synchroniser_first;"));
    assert!(rtl("posicast_fault_latch").contains("output reg  armed"));
}

#[test]
fn cli_a_project_places_and_constrains_every_port() {
    let (_folder, output) = xy_stage();
    let ends = [
        "*altera_std_synchronizer:*|din_s1",
        "*synchroniser_first *|pin_register_q",
        "*|armed",
    ];
    for (board, quartus, clock_pin, device) in BOARDS {
        let name = format!("xy_stage_{board}");
        places_and_constrains(&output, (board, &name), (quartus, clock_pin, device), &ends);
    }
}

/// The example with a serial line.
fn linked() -> String {
    fs::read_to_string(example("xy-stage.toml")).unwrap() + "[link]\nbaud = 3_000_000\n"
}

/// The stage with its serial line, without a system: the top level fits the Verilog of the package.
#[test]
fn cli_a_project_without_a_processor_is_complete() {
    let (_folder, output) = package(&linked());
    for (board, quartus, clock_pin, device) in BOARDS {
        let (project, name) = (format!("{board}_link"), format!("xy_stage_link_{board}"));
        let ends = ["*synchroniser_first *|pin_register_q", "*|armed"];
        places_and_constrains(&output, (&project, &name), (quartus, clock_pin, device), &ends);
        // What the README copies beside it: the list, and what it names.
        let project = output.join("sopc/quartus").join(project);
        let settings = fs::read_to_string(project.join(format!("{name}.qsf"))).unwrap();
        assert!(settings.contains("QIP_FILE xy_stage.qip\n"), "{settings}");
        let list = fs::read_to_string(output.join("xy_stage.qip")).unwrap();
        let names = list.lines().filter_map(|line| line.split('"').nth(1));
        let mut files: Vec<PathBuf> = names.map(|name| output.join(name)).collect();
        assert!(
            files.iter().any(|file| file.ends_with("rtl/xy_stage_link.v")),
            "{files:?}"
        );
        files.push(project.join(format!("{name}.v")));
        lint(&name, &files);
        // The line is on the header, whatever line the board has.
        let readme = fs::read_to_string(output.join("README.md")).unwrap();
        let pins = &readme[readme.find(&format!("the copied `{name}.qsf`")).unwrap()..];
        assert!(pins.contains("| `uart_rxd` | in | GPIO_0[0] |"), "{pins}");
    }
}

#[test]
fn cli_lines_end_in_registers_that_the_timing_excludes_and_in_no_others() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    // With a trace, an encoder generator is between the pins and the pulse counter.
    let with_trace = text.replacen("[axis.limits]", "[axis.trace]\nsamples = 256\n\n[axis.limits]", 1);
    assert_ne!(with_trace, text);
    check_lines(&with_trace, ("de1", "xy_stage_de1"), "xy_stage_stage");
}

#[test]
fn long_cli_lines_of_a_stage_with_a_serial_line_end_in_registers_that_the_timing_excludes() {
    check_lines(&linked(), ("de1_link", "xy_stage_link_de1"), "xy_stage_link");
}

/// Compares the false paths of a project with what the lines of its stage, the module `top`, reach in the netlist.
fn check_lines(machine: &str, (project, name): (&str, &str), top: &str) {
    let (_folder, output) = package(machine);
    let project = output.join("sopc/quartus").join(project);
    let ports = verilog_ports(&project.join(format!("{name}.v")));
    let (timing, _) = check_project("13.0", &project.join(format!("{name}.sdc")), &ports);
    let excluded = |line: &str, register: &str| {
        timing.iter().any(|record| {
            let ends = record[2..]
                .iter()
                .any(|end| register.ends_with(end.trim_matches(['*', '|'])));
            // The top level names the line of the stage as the board does.
            let port = if line == "uart_rx" { "uart_rxd" } else { line };
            record[0] == "false_path" && record[1] == port && ends
        })
    };
    let inside = ["clk", "rst", "pll_locked"];
    let stage = verilog_ports(&output.join(format!("rtl/{top}.v")));
    let is_line =
        |name: &str, direction: &str| direction == "Input" && !inside.contains(&name) && !name.starts_with("avs_");
    let lines: Vec<&String> = stage
        .iter()
        .filter(|(name, (direction, _))| is_line(name, direction))
        .map(|(name, _)| name)
        .collect();
    let of_host = usize::from(stage.contains_key("uart_rx"));
    assert_eq!(lines.len(), 1 + 2 * 9 + of_host);
    for (line, register) in reached(&output, top, &lines) {
        assert!(
            excluded(&line, &register),
            "{line} reaches {register}, which the .sdc does not exclude"
        );
    }
}

/// The registers that input lines of a module reach first in the netlist, each with its line. Every line reaches one.
pub(super) fn reached(output: &Path, top: &str, lines: &[&String]) -> Vec<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    // These cells end the search for what a line reaches in the netlist.
    let kinds = ["dff", "sdff", "adff", "dffe", "sdffe", "adffe", "sdffce"];
    let stop: String = kinds.map(|kind| format!(":-${kind}[Q]")).concat();
    let mut script = format!("hierarchy -top {top}; proc; flatten; opt_clean; ");
    for line in lines {
        let list = folder.path().join(line);
        script += &format!(
            "tee -q -o {} select -list i:{line} %co*{stop} t:$*dff* %i %co1:+[Q] w:* %i; ",
            list.display()
        );
    }
    let mut yosys = Command::new("yosys");
    let list = fs::read_to_string(output.join("filelist.f")).unwrap();
    let files = list.lines().filter(|line| line.ends_with(".v"));
    yosys
        .args(["-q", "-p", &script])
        .args(files.map(|file| output.join(file)));
    let run = yosys.output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let of_line = |line: &&String| {
        let registers = fs::read_to_string(folder.path().join(line)).unwrap();
        assert!(!registers.is_empty(), "{line} reaches nothing");
        let pairs = registers.lines().map(|register| ((*line).clone(), register.to_owned()));
        pairs.collect::<Vec<_>>()
    };
    lines.iter().flat_map(of_line).collect()
}

#[test]
fn cli_a_project_that_is_wrong_is_found() {
    let (_folder, output) = xy_stage();
    let project = output.join("sopc/quartus/de1");
    let ports = verilog_ports(&project.join("xy_stage_de1.v"));
    let breaks = [
        ("qsf", "PIN_L1 -to clock_50", "PIN_A13 -to clock_50"),
        ("qsf", "-to x_home", "-to x_hom"),
        ("qsf", "-name SDC_FILE", "-name SDC_ENTITY_FILE"),
        (
            "sdc",
            "create_clock -name clock_50 -period",
            "create_clock -name clock_50 -perod",
        ),
        (
            "sdc",
            "set_output_delay -clock clock_50 -max",
            "set_output_delay -clock clock -max",
        ),
        ("sdc", "[get_ports {uart_txd ", "[get_ports {uart_rxd "),
        ("sdc", "# Delays of drivers", "derive_clock_uncertainty\n#"),
    ];
    for (extension, from, to) in breaks {
        let file = project.join(format!("xy_stage_de1.{extension}"));
        let text = fs::read_to_string(&file).unwrap();
        replace(&file, from, to);
        let (_, content) = check_project("13.0", &file, &ports);
        assert!(!content, "{from} -> {to} was not found");
        fs::write(&file, text).unwrap();
    }
}

#[test]
fn cli_four_axes_with_scales_find_their_pins() {
    let text = fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (head, axes) = text.split_at(text.find("[[axis]]").unwrap());
    let axis = &axes[..axes[1..].find("[[axis]]").unwrap()];
    let with_scale = axis.replace(
        "[axis.pwm]",
        "[axis.scale]\ncounts_per_unit = 10_000_000\nuse = \"monitor\"\n\n[axis.pwm]",
    );
    let named = ["x", "y", "z", "w"].map(|name| with_scale.replacen("name = \"x\"", &format!("name = \"{name}\""), 1));
    let (folder, file) = scratch(&format!(
        "{head}{}[link]\nline = \"spi\"\nsck_hz = 1_000_000\n",
        named.join("\n")
    ));
    let output = folder.path().join("out");
    // Without a processor, the line needs one pin more than the headers have.
    generate(&file, &output).stderr(contains(
        "link: no project without a processor: de1: the stage has 73 lines",
    ));
    assert!(!output.join("sopc/quartus/de1_link").exists());
    assert!(
        !fs::read_to_string(output.join("README.md"))
            .unwrap()
            .contains("BOARD_link")
    );
    for (board, quartus, ..) in BOARDS {
        let project = output.join("sopc/quartus").join(board);
        let ports = verilog_ports(&project.join(format!("xy_stage_{board}.v")));
        // Clock, button, serial line and emergency stop; per axis 11 inputs and 6 outputs.
        assert_eq!(ports.len(), 5 + 4 * 17);
        let (records, content) = check_project(quartus, &project.join(format!("xy_stage_{board}.qsf")), &ports);
        assert!(content, "{:#?}", findings(&records));
        let (records, content) = check_system(quartus, &output.join(format!("sopc/xy_stage_{board}_system.tcl")));
        assert!(content, "{:#?}", findings(&records));
    }
}
